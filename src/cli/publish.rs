//! Products -> outputs: all of a run's products are put in place together, or none is.
//!
//! What may fail comes first:
//!
//! 1. All products are whole: see [`Sink::whole`](super::output::Sink::whole).
//! 2. Files that are to replace others get their temporary names.
//! 3. Devices and pipes are written to, then standard output. What they got cannot be taken back.
//! 4. Files are renamed, one after the other. Of a file that one of several replaces a second name is
//!    kept until all are in place: if one fails, those before it are had back.
//!
//! A signal waits until the files are renamed, so that it finds none or all of them.

use super::failure::writing;
use super::interrupt;
use super::part::{Name, Part, second_name};
use anyhow::{Context as _, Result};
use std::fs::{self, File};
use std::io::{self, Seek as _};
use std::path::PathBuf;

/// A whole product that is no output yet.
#[derive(Debug)]
pub(super) struct Product {
    /// As the user named it.
    name: PathBuf,
    what: What,
}

#[derive(Debug)]
enum What {
    /// To be copied.
    Copy(File, End),
    /// A file that is open still, and its final place.
    Part(Part, PathBuf),
    /// A file that is closed, and its final place.
    Closed(Name, PathBuf),
}

impl Product {
    pub(super) fn copy(name: PathBuf, file: File, end: End) -> Self {
        Self { name, what: What::Copy(file, end) }
    }

    pub(super) fn part(name: PathBuf, part: Part, path: PathBuf) -> Self {
        Self { name, what: What::Part(part, path) }
    }

    /// Closes a file.
    ///
    /// # Errors
    /// What the system gives; it is no file.
    pub(super) fn close(self) -> io::Result<Self> {
        let what = match self.what {
            What::Copy(..) => {
                return Err(io::Error::other("it is no file; choose another name"));
            }
            What::Part(part, path) => match part.close()? {
                Some(name) => What::Closed(name, path),
                None => return Err(io::Error::other("it has no name")),
            },
            closed @ What::Closed(..) => closed,
        };
        Ok(Self { name: self.name, what })
    }
}

/// Where a product is copied to that becomes no file.
#[derive(Debug)]
pub(super) enum End {
    /// A device or pipe.
    Open(File),
    Stdout,
}

/// What brings back what was there before a file was put in place.
enum Undo {
    /// The file that was replaced.
    Old(Name, PathBuf),
    /// There was none.
    Nothing(PathBuf),
}

/// Makes all of them outputs, or none.
///
/// # Errors
/// [`Output`](super::failure::Output), with the product that cannot be put in place.
pub(super) fn publish(products: Vec<Product>) -> Result<()> {
    let several = products.len() > 1;
    let files = prepared(products)?;
    interrupt::undisturbed(|| rename_all(files, several))
}

/// As [`publish`], for the report of a failure, which a signal may be waiting for.
///
/// # Errors
/// As [`publish`].
pub(super) fn publish_at_last(product: Product) -> Result<()> {
    rename_all(prepared(vec![product])?, false)
}

/// Does all that may fail; gives the files that are left to be renamed.
fn prepared(mut products: Vec<Product>) -> Result<Vec<Product>> {
    let several = products.len() > 1;
    for product in &mut products {
        if let What::Part(part, path) = &mut product.what
            && (several || path.exists())
        {
            part.give_name().with_context(|| writing(&product.name))?;
        }
    }
    let mut files = Vec::with_capacity(products.len());
    let mut stdout = Vec::new();
    for product in products {
        match product.what {
            What::Copy(file, End::Stdout) => stdout.push((product.name, file)),
            What::Copy(file, End::Open(device)) => {
                copy(file, device).with_context(|| writing(&product.name))?;
            }
            _ => files.push(product),
        }
    }
    for (name, file) in stdout {
        // Who stops reading, such as `head`, has had enough: that is no failure.
        match copy(file, io::stdout().lock()) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {}
            done => done.with_context(|| writing(&name))?,
        }
    }
    Ok(files)
}

/// Copies a whole product to its end.
fn copy(mut file: File, mut end: impl io::Write) -> io::Result<()> {
    file.rewind()?;
    io::copy(&mut file, &mut end).and_then(|_| end.flush())
}

fn rename_all(files: Vec<Product>, several: bool) -> Result<()> {
    let mut done: Vec<Undo> = Vec::new();
    for product in files {
        let name = product.name.clone();
        let undo = if several { undo(&product) } else { Ok(None) };
        let renamed = undo.and_then(|undo| rename(product.what).map(|()| undo));
        match renamed {
            Ok(undo) => done.extend(undo),
            Err(error) => {
                take_back(done);
                return Err(error).with_context(|| writing(&name));
            }
        }
    }
    Ok(())
}

fn undo(product: &Product) -> io::Result<Option<Undo>> {
    let (What::Part(_, path) | What::Closed(_, path)) = &product.what else { return Ok(None) };
    Ok(Some(if fs::symlink_metadata(path).is_ok() {
        Undo::Old(second_name(path)?, path.clone())
    } else {
        Undo::Nothing(path.clone())
    }))
}

fn rename(what: What) -> io::Result<()> {
    match what {
        What::Part(part, path) => part.publish(&path),
        What::Closed(name, path) => name.rename(&path),
        What::Copy(..) => Ok(()),
    }
}

/// What can be brought back is; the first failure is the one that is told.
fn take_back(done: Vec<Undo>) {
    for undo in done.into_iter().rev() {
        let _ = match undo {
            Undo::Old(name, path) => name.rename(&path),
            Undo::Nothing(path) => fs::remove_file(path),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::super::output::Sink;
    use super::*;
    use std::io::Write as _;
    use std::path::Path;

    fn sink(path: &Path, text: &str) -> Sink {
        let mut sink = Sink::open(path).unwrap();
        sink.write_all(text.as_bytes()).unwrap();
        sink
    }

    fn state(folder: &Path) -> Vec<(String, Option<String>)> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut all: Vec<_> = entries
            .map(|path| {
                let name = path.file_name().unwrap().to_string_lossy().into_owned();
                (name, fs::read_to_string(path).ok())
            })
            .collect();
        all.sort();
        all
    }

    #[test]
    fn if_one_cannot_be_put_in_place_none_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("old"), "old").unwrap();
        for closed in [false, true] {
            let sinks = ["old", "new", "taken"].map(|name| sink(&path(name), "made"));
            // While the run works, a folder appears where its last product goes.
            fs::create_dir(path("taken")).unwrap();
            let before = state(folder.path());
            let before: Vec<_> =
                before.into_iter().filter(|(name, _)| !name.starts_with('.')).collect();
            let whole = |sink: Sink| if closed { sink.close() } else { sink.whole() };
            let products = sinks.into_iter().map(|sink| whole(sink).unwrap()).collect();
            let error = publish(products).unwrap_err();
            assert!(format!("{error:#}").contains("taken: cannot write"), "{error:#}");
            assert_eq!(state(folder.path()), before, "closed: {closed}");
            fs::remove_dir(path("taken")).unwrap();
        }
        let sinks = ["old", "new", "taken"].map(|name| sink(&path(name), "made"));
        publish(sinks.into_iter().map(|sink| sink.whole().unwrap()).collect()).unwrap();
        let made = ["new", "old", "taken"].map(|name| (name.to_owned(), Some("made".to_owned())));
        assert_eq!(state(folder.path()), made);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_that_is_full_leaves_the_files_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        let file = sink(&path, "new").whole().unwrap();
        let full = sink(Path::new("/dev/full"), "report").whole().unwrap();
        publish(vec![file, full]).unwrap_err();
        assert_eq!(state(folder.path()), [("a".to_owned(), Some("old".to_owned()))]);
    }
}
