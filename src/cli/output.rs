//! Path -> Sink: an output that appears whole or not at all: a file, a device, or standard output.
//!
//! A *sink* takes a product until it is whole. *Commit* makes it the output; a sink that is dropped
//! without commit leaves no file and changes none.
//!
//! - A file is written beside its final place under a temporary name, and renamed on commit: both
//!   are in one folder, so that this is one step for the system. Links are followed first, so
//!   that a link stays a link.
//! - Standard output, devices and pipes cannot be replaced. Their product waits in a temporary
//!   file without a name and is copied on commit: the other end of a pipe never sees half of it.
//! - Of several files, as `preview --all` writes, each is closed once it is whole, since a system
//!   allows only some hundred open files. [`commit_all`] puts all in place, or none.
//!
//! Temporary names are registered with [`interrupt`], which removes the files if the program is
//! stopped by a signal or by a fault of its own.

pub(crate) use super::failure::is_stdout;

use super::failure::Output;
use super::input::BUFFER;
use super::interrupt;
use anyhow::{Context as _, Result};
use serde::Serialize;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempPath};

/// A value as JSON for people and programs, with a line break at its end. `to` is where it goes,
/// for the message.
///
/// # Errors
/// [`Output`] if it cannot be written as JSON.
pub(super) fn json(value: &impl Serialize, to: &Path) -> Result<String> {
    let text = serde_json::to_string_pretty(value);
    text.map(|text| text + "\n").with_context(|| writing(to))
}

/// Where a product goes. It is opened before the long work, so that a wrong path costs no time.
#[derive(Debug)]
pub(crate) struct Sink {
    /// As the user named it.
    name: PathBuf,
    target: Target,
}

#[derive(Debug)]
enum Target {
    /// A file without a name, and where it is copied to.
    Unnamed(BufWriter<File>, End),
    /// A file beside its final place, and that place.
    Temporary(BufWriter<NamedTempFile>, PathBuf),
}

/// Where an unnamed file is copied to.
#[derive(Debug)]
enum End {
    Stdout,
    /// A device or pipe.
    Open(File),
}

/// A whole product beside its final place, no longer open.
#[derive(Debug)]
pub(crate) struct Closed {
    /// As the user named it.
    name: PathBuf,
    file: TempPath,
    path: PathBuf,
}

impl Sink {
    /// Opens `name`: `-` is standard output, an existing device or pipe is
    /// written to, anything else becomes a file; all of it on [`Sink::commit`].
    ///
    /// # Errors
    /// [`Output`] if it cannot be opened for writing.
    pub(crate) fn open(name: &Path) -> Result<Self> {
        let target = if is_stdout(name) { unnamed(End::Stdout) } else { open_target(name) };
        let action = "cannot open for writing";
        let target = target.with_context(|| Output { file: name.to_owned(), action })?;
        Ok(Self { name: name.to_owned(), target })
    }

    /// Ends writing, for [`commit_all`].
    ///
    /// # Errors
    /// [`Output`] if the rest cannot be written, or it goes to no file.
    pub(crate) fn close(self) -> Result<Closed> {
        let name = self.name;
        let Target::Temporary(out, path) = self.target else {
            return Err(reason("it is no file; choose another name"))
                .with_context(|| writing(&name));
        };
        let file = out.into_inner().map_err(io::IntoInnerError::into_error);
        let file = file.with_context(|| writing(&name))?.into_temp_path();
        Ok(Closed { name, file, path })
    }

    /// Reads what was written so far, from its beginning. Nothing may be written afterwards.
    ///
    /// # Errors
    /// What writing the rest gives.
    pub(crate) fn read_back(&mut self) -> io::Result<impl BufRead> {
        self.flush()?;
        let file = match &mut self.target {
            Target::Unnamed(out, _) => out.get_mut(),
            Target::Temporary(out, _) => out.get_mut().as_file_mut(),
        };
        file.rewind()?;
        Ok(BufReader::with_capacity(BUFFER, file))
    }

    /// Makes what was written the output.
    ///
    /// # Errors
    /// [`Output`] if the rest cannot be written or the file not be put in place.
    pub(crate) fn commit(self) -> Result<()> {
        let name = self.name;
        let done = match self.target {
            Target::Unnamed(out, end) => copy(out, end),
            Target::Temporary(out, path) => out
                .into_inner()
                .map_err(io::IntoInnerError::into_error)
                .and_then(|file| {
                    let temporary = file.path().to_owned();
                    let done = file.persist(path).map_err(|error| error.error);
                    interrupt::done(&temporary);
                    done
                })
                .map(drop),
        };
        done.with_context(|| writing(&name))
    }
}

/// Makes all of them outputs, or none.
///
/// # Errors
/// As [`Sink::commit`]; what was put in place by then is removed.
pub(crate) fn commit_all(products: Vec<Closed>) -> Result<()> {
    let mut done: Vec<PathBuf> = Vec::with_capacity(products.len());
    for product in products {
        let path = product.path.clone();
        if let Err(error) = product.commit() {
            for path in done {
                let _ = fs::remove_file(path);
            }
            return Err(error);
        }
        done.push(path);
    }
    Ok(())
}

impl Closed {
    fn commit(self) -> Result<()> {
        let temporary = self.file.to_path_buf();
        let done = self.file.persist(self.path).map_err(|error| error.error);
        interrupt::done(&temporary);
        done.with_context(|| writing(&self.name))
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Unnamed(out, _) => out.write(bytes),
            Target::Temporary(out, _) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Unnamed(out, _) => out.flush(),
            Target::Temporary(out, _) => out.flush(),
        }
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.target {
            Target::Unnamed(out, _) => out.seek(to),
            Target::Temporary(out, _) => out.seek(to),
        }
    }
}

/// Whether the error is that nobody reads standard output any more.
pub(crate) fn is_closed_stdout(error: &anyhow::Error) -> bool {
    let is_stdout = error.downcast_ref().is_some_and(|to: &Output| is_stdout(&to.file));
    let closed = |error: &io::Error| error.kind() == io::ErrorKind::BrokenPipe;
    is_stdout && error.root_cause().downcast_ref().is_some_and(closed)
}

/// Writes a whole text to standard output.
///
/// # Errors
/// [`Output`].
pub(crate) fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    let text = super::words::harmless(text);
    let done = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    done.with_context(|| writing(Path::new("-")))
}

/// Context of what fails while an output is written.
pub(crate) fn writing(name: &Path) -> Output {
    Output { file: name.to_owned(), action: "cannot write" }
}

fn open_target(name: &Path) -> io::Result<Target> {
    // Under /dev even a link to a regular file (/dev/stdout) is somebody's open file.
    let device = name.starts_with("/dev");
    match fs::metadata(name) {
        Ok(data) if data.is_dir() => Err(reason("it is a directory; name a file in it")),
        Ok(data) if device || !data.is_file() => {
            unnamed(End::Open(OpenOptions::new().write(true).open(name)?))
        }
        Ok(data) if data.permissions().readonly() => {
            Err(reason("the file is write-protected; remove it or choose another name"))
        }
        // The end of the links, so that a link stays a link.
        Ok(_) => beside(fs::canonicalize(name)?),
        Err(_) => beside(end_of_links(name)?),
    }
}

fn unnamed(end: End) -> io::Result<Target> {
    let file = tempfile::tempfile().map_err(|source| {
        let folder = std::env::temp_dir();
        io::Error::new(
            source.kind(),
            format!("no temporary file in {}: {source}", folder.display()),
        )
    })?;
    Ok(Target::Unnamed(BufWriter::new(file), end))
}

/// Copies a whole product to its end.
fn copy(out: BufWriter<File>, end: End) -> io::Result<()> {
    let mut file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.rewind()?;
    match end {
        End::Stdout => {
            let mut stdout = io::stdout().lock();
            io::copy(&mut file, &mut stdout).and_then(|_| stdout.flush())
        }
        End::Open(mut end) => io::copy(&mut file, &mut end).and_then(|_| end.flush()),
    }
}

/// Follows links whose end does not exist yet.
fn end_of_links(name: &Path) -> io::Result<PathBuf> {
    /// More than any system follows.
    const MOST: usize = 40;
    let mut path = name.to_owned();
    for _ in 0..MOST {
        let Ok(next) = fs::read_link(&path) else {
            return Ok(path);
        };
        path = path.parent().map_or_else(|| next.clone(), |folder| folder.join(&next));
    }
    Err(reason("the link leads to itself; remove it"))
}

fn beside(path: PathBuf) -> io::Result<Target> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let is_folder = path.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    if path.file_name().is_none() || is_folder {
        return Err(reason("this names no file; add a file name"));
    }
    if !folder.is_dir() {
        return Err(reason(&format!("there is no directory {}; create it", folder.display())));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".slicer-").suffix(".part");
    // Temporary files are private by default; the product has the permissions
    // of any new file (the umask still applies).
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(folder)?;
    interrupt::begun(file.path());
    Ok(Target::Temporary(BufWriter::new(file), path))
}

fn reason(why: &str) -> io::Error {
    io::Error::other(why.to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::failure::line;
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn nothing_stays_without_commit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gcode");
        fs::write(&path, "old").unwrap();
        let mut sink = Sink::open(&path).unwrap();
        sink.write_all(b"new").unwrap();
        drop(sink);
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.gcode"]);
    }

    #[test]
    fn commit_replaces_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gcode");
        fs::write(&path, "old").unwrap();
        let mut sink = Sink::open(&path).unwrap();
        sink.write_all(b"new").unwrap();
        sink.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(names(folder.path()), ["a.gcode"]);
    }

    #[test]
    fn directories_and_missing_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = line(&Sink::open(folder.path()).unwrap_err());
        assert!(error.ends_with("it is a directory; name a file in it"), "{error}");
        let error = line(&Sink::open(&folder.path().join("no/a.gcode")).unwrap_err());
        assert!(error.contains("there is no directory"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links_and_lead_to_the_product() {
        let folder = tempfile::tempdir().unwrap();
        let (link, file) = (folder.path().join("link"), folder.path().join("file"));
        std::os::unix::fs::symlink("file", &link).unwrap();
        for text in ["new", "newer"] {
            let mut sink = Sink::open(&link).unwrap();
            sink.write_all(text.as_bytes()).unwrap();
            sink.commit().unwrap();
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
    }

    #[cfg(unix)]
    #[test]
    fn products_have_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("a"), folder.path().join("b"));
        Sink::open(&ours).unwrap().commit().unwrap();
        fs::write(&plain, "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_written_to_when_all_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for kept in [true, false] {
            let reader = pipe.clone();
            let reader = std::thread::spawn(move || fs::read(reader).unwrap());
            let mut sink = Sink::open(&pipe).unwrap();
            sink.write_all(b"M73 P?? R??").unwrap();
            sink.seek(SeekFrom::Start(5)).unwrap();
            sink.write_all(b"10").unwrap();
            if kept {
                sink.commit().unwrap();
            } else {
                drop(sink);
            }
            let read: &[u8] = if kept { b"M73 P10 R??" } else { b"" };
            assert_eq!(reader.join().unwrap(), read);
        }
        let mut sink = Sink::open(Path::new("/dev/null")).unwrap();
        sink.write_all(b"x").unwrap();
        assert!(matches!(sink.target, Target::Unnamed(_, End::Open(_))));
        sink.commit().unwrap();
    }

    #[test]
    fn what_was_written_can_be_filled_in() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gcode");
        let mut sink = Sink::open(&path).unwrap();
        sink.write_all(b"one two").unwrap();
        sink.seek(SeekFrom::Start(4)).unwrap();
        sink.write_all(b"2").unwrap();
        sink.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "one 2wo");
    }
}
