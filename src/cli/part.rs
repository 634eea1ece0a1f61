//! Folder -> Part: an unfinished file beside its final place, of which nothing stays if the run is killed.
//!
//! - A part has *no name* where the system can do that (`O_TMPFILE`): when the program ends, however
//!   it ends, the system takes it away. It gets a name on publishing, mostly its final one at once.
//! - Elsewhere it is called `.slicer-*.part`, in the folder of the final place, so that to rename it is
//!   one step for the system. Its writer holds a *lock* on it as long as it is open.
//! - [`sweep`] removes such files whose lock nobody holds: their writer was killed. A writer locks its
//!   file and then looks whether it is still there, so that none is lost in between.
//! - A *batch* is for hundreds of files, which cannot all stay open. It holds one locked file,
//!   `.slicer-X.part`, as a sign for all of its own, which are called `.slicer-X-1.part` and so on.
//!
//! A part that is to replace a file takes over its permissions and, where the system allows it, its
//! owner and group. Names are registered with [`interrupt`], which removes the files on a signal.

use super::interrupt;
use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

const PREFIX: &str = ".slicer-";
const SUFFIX: &str = ".part";

/// How often a name is tried anew that a sweeping run took for left behind.
const TRIES: usize = 16;

/// An unfinished file.
#[derive(Debug)]
pub(super) struct Part {
    file: File,
    /// Where it lies; `None` while it has no name.
    name: Option<Name>,
    folder: PathBuf,
    /// Of the file that it replaces.
    old: Option<Box<Metadata>>,
}

/// A temporary name. The file goes away with it, unless it was renamed.
#[derive(Debug)]
pub(super) struct Name(Option<TempPath>);

impl Name {
    fn new(path: TempPath) -> Self {
        interrupt::begun(&path);
        Self(Some(path))
    }

    pub(super) fn path(&self) -> &Path {
        self.0.as_deref().unwrap_or(Path::new(""))
    }

    /// Makes it the file at `path`, in place of another that is there.
    ///
    /// # Errors
    /// What the system gives.
    pub(super) fn rename(mut self, path: &Path) -> io::Result<()> {
        let Some(temporary) = self.0.take() else { return Ok(()) };
        let from = temporary.to_path_buf();
        let done = temporary.persist(path).map_err(|error| error.error);
        interrupt::done(&from);
        done
    }
}

impl Drop for Name {
    fn drop(&mut self) {
        if let Some(path) = self.0.take() {
            let from = path.to_path_buf();
            drop(path);
            interrupt::done(&from);
        }
    }
}

impl Part {
    /// A part of what will be `path`, whose folder exists.
    ///
    /// # Errors
    /// What the system gives.
    pub(super) fn beside(path: &Path) -> io::Result<Self> {
        let folder = folder_of(path).to_owned();
        let nameless = unnamed(&folder).map(|file| (file, None));
        let (file, name) = match nameless {
            Ok(part) => part,
            Err(_) => named(&folder).map(|(file, name)| (file, Some(name)))?,
        };
        Ok(Self::replacing(file, name, folder, path))
    }

    fn replacing(file: File, name: Option<Name>, folder: PathBuf, path: &Path) -> Self {
        let old = fs::metadata(path).ok().map(Box::new);
        if let Some(old) = &old {
            take_over(&file, old);
        }
        Self { file, name, folder, old }
    }

    /// The file itself.
    pub(super) fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Gives it a temporary name, if it has none.
    ///
    /// # Errors
    /// What the system gives.
    pub(super) fn give_name(&mut self) -> io::Result<()> {
        if self.name.is_some() {
            return Ok(());
        }
        let linked = make(&self.folder, |to| link(&self.file, to));
        let name = match linked {
            Ok(path) => Name::new(path),
            // Without /proc, say. The text is written anew, into a file that has a name.
            Err(_) => {
                let (mut file, name) = named(&self.folder)?;
                self.file.rewind()?;
                io::copy(&mut self.file, &mut file)?;
                if let Some(old) = &self.old {
                    take_over(&file, old);
                }
                self.file = file;
                name
            }
        };
        self.name = Some(name);
        Ok(())
    }

    /// Makes it the file at `path`. If there is one already, that is replaced.
    ///
    /// # Errors
    /// What the system gives.
    pub(super) fn publish(mut self, path: &Path) -> io::Result<()> {
        let is_there = fs::symlink_metadata(path).is_ok();
        if self.name.is_none() && !is_there && link(&self.file, path).is_ok() {
            return Ok(());
        }
        self.give_name()?;
        self.name.take().map_or(Ok(()), |name| name.rename(path))
    }

    /// Closes it; the name stays.
    ///
    /// # Errors
    /// What the system gives.
    pub(super) fn close(mut self) -> io::Result<Option<Name>> {
        self.give_name()?;
        Ok(self.name.take())
    }
}

impl Write for Part {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Part {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Many parts in one folder, which may be closed before they are published.
#[derive(Debug)]
pub(super) struct Batch {
    folder: PathBuf,
    /// Keeps others from sweeping the batch's own files. It is never published.
    sign: Name,
    _locked: File,
}

impl Batch {
    /// # Errors
    /// What the system gives.
    pub(super) fn new(folder: &Path) -> io::Result<Self> {
        sweep(folder);
        let (locked, sign) = named(folder)?;
        Ok(Self { folder: folder.to_owned(), sign, _locked: locked })
    }

    /// The part with this number of what will be `path`. One in another folder, to which a link
    /// leads, is an ordinary part.
    ///
    /// # Errors
    /// What the system gives.
    pub(super) fn part(&self, number: usize, path: &Path) -> io::Result<Part> {
        if folder_of(path) != self.folder {
            return Part::beside(path);
        }
        let sign = self.sign.path().file_stem().unwrap_or_default().to_string_lossy();
        let name = self.folder.join(format!("{sign}-{number}{SUFFIX}"));
        let file = create(&name)?;
        let name = Name::new(TempPath::try_from_path(name)?);
        Ok(Part::replacing(file, Some(name), self.folder.clone(), path))
    }
}

/// The folder that a file lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A second name of the file at `path`, by which it can be had back; a copy of it where files have
/// only one.
///
/// # Errors
/// What the system gives.
pub(super) fn second_name(path: &Path) -> io::Result<Name> {
    let folder = folder_of(path);
    let made = make(folder, |to| fs::hard_link(path, to));
    made.or_else(|_| make(folder, |to| fs::copy(path, to).map(drop))).map(Name::new)
}

/// Removes what killed runs have left in a folder.
pub(super) fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let ours = entries.filter(|entry| is_part(&entry.file_name()));
    let files = ours.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    for entry in files {
        let path = entry.path();
        let sign = sign_of(&path).is_some_and(|sign| unlocked(&sign).is_none() && sign.exists());
        if sign {
            continue;
        }
        // The lock is held until the file is gone.
        if let Some(_lock) = unlocked(&path) {
            let _ = fs::remove_file(&path);
        }
    }
}

fn is_part(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))
}

/// The sign of the batch that a file belongs to, going by its name.
fn sign_of(path: &Path) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_str()?.strip_prefix(PREFIX)?;
    let (sign, _) = stem.split_once('-')?;
    Some(path.with_file_name(format!("{PREFIX}{sign}{SUFFIX}")))
}

/// The file at `path`, locked, if nobody else holds its lock.
fn unlocked(path: &Path) -> Option<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    // Whatever stands there by now, it is neither followed nor waited for.
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt as _;
        let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
        options.custom_flags(flags.bits().cast_signed());
    }
    let file = options.open(path).ok()?;
    file.try_lock().ok().map(|()| file)
}

/// A new locked file with a temporary name in `folder`.
fn named(folder: &Path) -> io::Result<(File, Name)> {
    let mut made = make_file(folder)?;
    for _ in 0..TRIES {
        // Where files have no locks nobody sweeps, either.
        let _ = made.0.lock();
        if made.1.path().exists() {
            break;
        }
        made = make_file(folder)?;
    }
    Ok(made)
}

fn make_file(folder: &Path) -> io::Result<(File, Name)> {
    let made = builder(|builder| builder.make_in(folder, create))?;
    let (file, path) = made.into_parts();
    Ok((file, Name::new(path)))
}

/// A temporary name in `folder` that `put` gave to a file.
fn make(folder: &Path, put: impl Fn(&Path) -> io::Result<()>) -> io::Result<TempPath> {
    Ok(builder(|builder| builder.make_in(folder, put))?.into_temp_path())
}

fn builder<T>(with: impl FnOnce(&mut tempfile::Builder<'_, '_>) -> T) -> T {
    with(tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX))
}

/// A new file with the permissions of any new one: the umask applies.
fn create(path: &Path) -> io::Result<File> {
    OpenOptions::new().read(true).write(true).create_new(true).open(path)
}

/// A new file without a name, in `folder`.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> io::Result<File> {
    use rustix::fs::{CWD, Mode, OFlags, openat};
    // By this folder it gets its name.
    if !Path::new(DESCRIPTORS).is_dir() {
        return Err(io::ErrorKind::Unsupported.into());
    }
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    let file = File::from(openat(CWD, folder, flags, Mode::from_raw_mode(0o666))?);
    // For the moment in which it has a temporary name.
    let _ = file.try_lock();
    Ok(file)
}

#[cfg(not(target_os = "linux"))]
fn unnamed(_: &Path) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// The open files of this process.
#[cfg(target_os = "linux")]
const DESCRIPTORS: &str = "/proc/self/fd";

/// Gives a file a name that there is not yet.
#[cfg(target_os = "linux")]
fn link(file: &File, to: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd as _;
    let from = format!("{DESCRIPTORS}/{}", file.as_raw_fd());
    Ok(linkat(CWD, from, CWD, to, AtFlags::SYMLINK_FOLLOW)?)
}

#[cfg(not(target_os = "linux"))]
fn link(_: &File, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Gives a file the permissions of the one that it replaces and, as far as the system lets this user,
/// its owner and group. What fails changes nothing that is printed.
#[cfg(unix)]
fn take_over(file: &File, old: &Metadata) {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    let is_other = |new: Metadata| (new.uid(), new.gid()) != (old.uid(), old.gid());
    if file.metadata().is_ok_and(is_other)
        && fchown(file, Some(old.uid()), Some(old.gid())).is_err()
    {
        let _ = fchown(file, None, Some(old.gid()));
    }
    let _ = file.set_permissions(fs::Permissions::from_mode(old.mode() & 0o777));
}

#[cfg(not(unix))]
fn take_over(_: &File, _: &Metadata) {}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn parts_with_and_without_a_name_become_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for text in ["first", "second"] {
            let (file, name) = named(folder.path()).unwrap();
            let with = Part::replacing(file, Some(name), folder.path().to_owned(), &path);
            for mut part in [with, Part::beside(&path).unwrap()] {
                part.write_all(text.as_bytes()).unwrap();
                part.publish(&path).unwrap();
                assert_eq!(fs::read_to_string(&path).unwrap(), text);
                assert_eq!(names(folder.path()), ["a"]);
                fs::write(&path, "other").unwrap();
            }
            // Closed and then renamed, as in a batch.
            let mut part = Part::beside(&path).unwrap();
            part.write_all(text.as_bytes()).unwrap();
            part.close().unwrap().unwrap().rename(&path).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
    }

    #[test]
    fn only_what_nobody_holds_is_swept() {
        let folder = tempfile::tempdir().unwrap();
        let (_held, live) = named(folder.path()).unwrap();
        let batch = Batch::new(folder.path()).unwrap();
        let part = batch.part(7, &folder.path().join("a")).unwrap().close().unwrap();
        let mut expected = names(folder.path());
        assert_eq!(expected.len(), 3);
        for left in [".slicer-gone.part", ".slicer-gone-1.part", ".slicer-gone-2.part"] {
            fs::write(folder.path().join(left), "half").unwrap();
        }
        for other in [".slicer-a.txt", "slicer-a.part", ".slicer.part"] {
            fs::write(folder.path().join(other), "").unwrap();
            expected.push(other.to_owned());
        }
        fs::create_dir(folder.path().join(".slicer-folder.part")).unwrap();
        expected.push(".slicer-folder.part".to_owned());
        sweep(folder.path());
        expected.sort();
        assert_eq!(names(folder.path()), expected);
        drop((live, part, batch));
        assert_eq!(names(folder.path()).len(), 4);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_of_the_file_that_is_replaced_are_kept() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for mode in [0o600, 0o664, 0o755] {
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            let (file, name) = named(folder.path()).unwrap();
            let with = Part::replacing(file, Some(name), folder.path().to_owned(), &path);
            for part in [with, Part::beside(&path).unwrap()] {
                part.publish(&path).unwrap();
                assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, mode);
            }
        }
    }
}
