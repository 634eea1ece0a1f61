//! Path -> Sink: a file that is there whole or not at all, a device, or standard output.

use super::interrupt;
use slicer::error::{Error, Result};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Stdout, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Where a product goes. Opened before the long work, so that a wrong path
/// costs no time. Without [`Sink::commit`] no file is left or changed.
#[derive(Debug)]
pub(crate) struct Sink {
    /// As the user named it.
    name: PathBuf,
    target: Target,
}

#[derive(Debug)]
enum Target {
    Stdout(BufWriter<Stdout>),
    /// A device or pipe, which cannot be replaced by a file.
    Direct(BufWriter<File>),
    /// A file beside the one that it will become.
    Temporary(BufWriter<NamedTempFile>, PathBuf),
}

impl Sink {
    /// Opens `name`: `-` is standard output, an existing device or pipe is
    /// written to, anything else becomes a file on [`Sink::commit`].
    ///
    /// # Errors
    /// [`Error::Output`] if it cannot be opened for writing.
    pub(crate) fn open(name: &Path) -> Result<Self> {
        let target = if is_stdout(name) {
            Ok(Target::Stdout(BufWriter::new(io::stdout())))
        } else {
            open_target(name)
        };
        let target = target.map_err(|source| failed(name, "cannot open for writing", source))?;
        Ok(Self { name: name.to_owned(), target })
    }

    /// Makes what was written the output.
    ///
    /// # Errors
    /// [`Error::Output`] if the rest cannot be written or the file not be put in place.
    pub(crate) fn commit(self) -> Result<()> {
        let name = self.name;
        let done = match self.target {
            Target::Stdout(mut out) => out.flush(),
            Target::Direct(mut out) => out.flush(),
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
        done.map_err(|source| failed(&name, "cannot write", source))
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Stdout(out) => out.write(bytes),
            Target::Direct(out) => out.write(bytes),
            Target::Temporary(out, _) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Stdout(out) => out.flush(),
            Target::Direct(out) => out.flush(),
            Target::Temporary(out, _) => out.flush(),
        }
    }
}

/// Whether this name means standard output.
pub(crate) fn is_stdout(name: &Path) -> bool {
    name.as_os_str() == "-"
}

/// Whether the failure is that nobody reads standard output any more.
pub(crate) fn is_closed_stdout(error: &Error) -> bool {
    matches!(error, Error::Output { file, source, .. }
        if is_stdout(file) && source.kind() == io::ErrorKind::BrokenPipe)
}

/// Writes a whole text to standard output.
///
/// # Errors
/// [`Error::Output`].
pub(crate) fn print(text: &str) -> Result<()> {
    let mut sink = Sink::open(Path::new("-"))?;
    sink.write_all(text.as_bytes())
        .map_err(|source| failed(Path::new("-"), "cannot write", source))?;
    sink.commit()
}

/// An output's failure, `action` being what was tried.
pub(crate) fn failed(name: &Path, action: &'static str, source: io::Error) -> Error {
    Error::Output { file: name.to_owned(), action, source }
}

fn open_target(name: &Path) -> io::Result<Target> {
    // Under /dev even a link to a regular file (/dev/stdout) is somebody's open file.
    let device = name.starts_with("/dev");
    match fs::metadata(name) {
        Ok(data) if data.is_dir() => Err(told("it is a directory; name a file in it")),
        Ok(data) if device || !data.is_file() => {
            Ok(Target::Direct(BufWriter::new(OpenOptions::new().write(true).open(name)?)))
        }
        Ok(data) if data.permissions().readonly() => {
            Err(told("the file is write-protected; remove it or choose another name"))
        }
        // The end of the links, so that a link stays one.
        Ok(_) => beside(fs::canonicalize(name)?),
        Err(_) => beside(end_of_links(name)?),
    }
}

/// Follows links that lead to no file yet.
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
    Err(told("the link leads to itself; remove it"))
}

fn beside(path: PathBuf) -> io::Result<Target> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if path.file_name().is_none() {
        return Err(told("this names no file"));
    }
    if !folder.is_dir() {
        return Err(told(&format!("there is no directory {}; create it", folder.display())));
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

fn told(why: &str) -> io::Error {
    io::Error::other(why.to_owned())
}

#[cfg(test)]
mod tests {
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
        let error = Sink::open(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with("it is a directory; name a file in it"), "{error}");
        let error = Sink::open(&folder.path().join("no/a.gcode")).unwrap_err().to_string();
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
    fn devices_are_written_to() {
        let mut sink = Sink::open(Path::new("/dev/null")).unwrap();
        sink.write_all(b"x").unwrap();
        assert!(matches!(sink.target, Target::Direct(_)));
        sink.commit().unwrap();
    }
}
