//! Path -> Sink: an output that appears whole or not at all: a file, a device, or standard output.
//!
//! A *sink* takes a product until it is whole. [`publish`] makes all products of a run outputs, or none;
//! a sink that is dropped before leaves no file and changes none.
//!
//! - A file is written beside its final place, as a [`Part`], and renamed. Links are followed first,
//!   so that a link stays a link.
//! - Standard output, devices and pipes cannot be replaced. Their product waits in a temporary
//!   file without a name and is copied in the end: the other end of a pipe never sees half of it.
//! - Of hundreds of files, as `preview --all` writes, each is closed once it is whole, since a system
//!   allows only some hundred open files.
//!
//! All text leaves the program through [`print`], [`json`] and [`super::say`], where characters are
//! escaped that a terminal would obey.

pub(crate) use super::failure::is_stdout;

use super::failure::{Output, writing};
use super::part::{Batch, Part, folder_of, sweep};
use super::publish::{End, Product, publish, publish_at_last};
use anyhow::{Context as _, Result};
use serde::Serialize;
use slicer::text;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes that are written at once.
const BUFFER: usize = 1 << 18;

/// A value as JSON for people and programs, with a line break at its end. `to` is where it goes,
/// for the message.
///
/// # Errors
/// [`Output`] if it cannot be written as JSON.
pub(super) fn json(value: &impl Serialize, to: &Path) -> Result<String> {
    let written = serde_json::to_string_pretty(value);
    written.map(|json| text::harmless(&json).into_owned() + "\n").with_context(|| writing(to))
}

/// As [`json`], on one line.
///
/// # Errors
/// As [`json`].
pub(super) fn json_line(value: &impl Serialize, to: &Path) -> Result<String> {
    let written = serde_json::to_string(value);
    written.map(|json| text::harmless(&json).into_owned() + "\n").with_context(|| writing(to))
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
    Beside(BufWriter<Part>, PathBuf),
}

impl Sink {
    /// Opens `name`: `-` is standard output, an existing device or pipe is written to, anything else
    /// becomes a file; all of it when it is published. What killed runs left beside it is removed.
    ///
    /// # Errors
    /// [`Output`] if it cannot be opened for writing.
    pub(crate) fn open(name: &Path) -> Result<Self> {
        Self::open_by(name, |path| {
            sweep(folder_of(path));
            Part::beside(path)
        })
    }

    /// As [`Self::open`], for the file with this number of a batch.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub(crate) fn open_in(batch: &Batch, number: usize, name: &Path) -> Result<Self> {
        Self::open_by(name, |path| batch.part(number, path))
    }

    fn open_by(name: &Path, part: impl FnOnce(&Path) -> io::Result<Part>) -> Result<Self> {
        let target = if is_stdout(name) { unnamed(End::Stdout) } else { open_target(name, part) };
        let action = "cannot open for writing";
        let target = target.with_context(|| Output { file: name.to_owned(), action })?;
        Ok(Self { name: name.to_owned(), target })
    }

    /// Reads what was written so far, from its beginning. Nothing may be written afterwards.
    ///
    /// # Errors
    /// What writing the rest gives.
    pub(crate) fn read_back(&mut self) -> io::Result<impl BufRead> {
        self.flush()?;
        let file = match &mut self.target {
            Target::Unnamed(out, _) => out.get_mut(),
            Target::Beside(out, _) => out.get_mut().file(),
        };
        file.rewind()?;
        Ok(BufReader::with_capacity(BUFFER, file))
    }

    /// Ends writing, for [`publish`].
    ///
    /// # Errors
    /// [`Output`] if the rest cannot be written.
    pub(crate) fn whole(self) -> Result<Product> {
        let name = self.name;
        let whole = match self.target {
            Target::Unnamed(out, end) => {
                let file = out.into_inner().map_err(io::IntoInnerError::into_error);
                file.map(|file| Product::copy(name.clone(), file, end))
            }
            Target::Beside(out, path) => {
                let part = out.into_inner().map_err(io::IntoInnerError::into_error);
                part.map(|part| Product::part(name.clone(), part, path))
            }
        };
        whole.with_context(|| writing(&name))
    }

    /// As [`Self::whole`], and closes the file.
    ///
    /// # Errors
    /// [`Output`] if the rest cannot be written, or it goes to no file.
    pub(crate) fn close(self) -> Result<Product> {
        let name = self.name.clone();
        self.whole()?.close().with_context(|| writing(&name))
    }

    /// Makes what was written the output.
    ///
    /// # Errors
    /// [`Output`] if the rest cannot be written or the file not be put in place.
    pub(crate) fn commit(self) -> Result<()> {
        publish(vec![self.whole()?])
    }

    /// As [`Self::commit`], for the report of a failure.
    ///
    /// # Errors
    /// As [`Self::commit`].
    pub(crate) fn commit_at_last(self) -> Result<()> {
        publish_at_last(self.whole()?)
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Unnamed(out, _) => out.write(bytes),
            Target::Beside(out, _) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Unnamed(out, _) => out.flush(),
            Target::Beside(out, _) => out.flush(),
        }
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.target {
            Target::Unnamed(out, _) => out.seek(to),
            Target::Beside(out, _) => out.seek(to),
        }
    }
}

/// A batch of files beside `name`.
///
/// # Errors
/// [`Output`] if no file can be made there.
pub(crate) fn batch(name: &Path) -> Result<Batch> {
    let action = "cannot open for writing";
    let folder = folder_of(name);
    let made = existing(folder).and_then(|()| Batch::new(folder));
    made.with_context(|| Output { file: name.to_owned(), action })
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
    let text = text::harmless(text);
    let done = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    done.with_context(|| writing(Path::new("-")))
}

fn open_target(name: &Path, part: impl FnOnce(&Path) -> io::Result<Part>) -> io::Result<Target> {
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
        Ok(_) => beside(fs::canonicalize(name)?, part),
        Err(_) => beside(end_of_links(name)?, part),
    }
}

fn unnamed(end: End) -> io::Result<Target> {
    let file = tempfile::tempfile().map_err(|source| {
        let folder = text::name(std::env::temp_dir());
        io::Error::new(source.kind(), format!("no temporary file in {folder}: {source}"))
    })?;
    Ok(Target::Unnamed(BufWriter::new(file), end))
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

fn beside(path: PathBuf, part: impl FnOnce(&Path) -> io::Result<Part>) -> io::Result<Target> {
    let is_folder = path.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    if path.file_name().is_none() || is_folder {
        return Err(reason("this names no file; add a file name"));
    }
    existing(folder_of(&path))?;
    Ok(Target::Beside(BufWriter::new(part(&path)?), path))
}

fn existing(folder: &Path) -> io::Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    Err(reason(&format!("there is no directory {}; create it", text::name(folder))))
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
