//! Files that appear under their name complete or not at all.
use std::{
    ffi::OsString,
    fs::{self, File, Metadata, OpenOptions, TryLockError},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::error::{Error, Result};

/// Bytes that are gathered before they are written.
const BUFFER: usize = 64 * 1024;
/// What the name of an unfinished output ends in.
const PARTIAL: &str = ".partial";
/// Times a lock is sought on a file that another run renames meanwhile.
const ATTEMPTS: u32 = 8;

/// Where the bytes go.
enum Sink {
    Stdout(io::Stdout),
    File(File),
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Stdout(stdout) => stdout.write(bytes),
            Self::File(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Stdout(stdout) => stdout.flush(),
            Self::File(file) => file.flush(),
        }
    }
}

/// A file that is written beside its place and not yet there.
struct Pending {
    partial: PathBuf,
    target: PathBuf,
}

/// An output that the user named. Dropped without [`Output::commit`], it leaves what was written in its partial file.
pub struct Output {
    sink: BufWriter<Sink>,
    name: Arc<str>,
    pending: Option<Pending>,
}

impl Output {
    /// Opens an output. `-` is standard output; what exists and is no regular file (a device, a pipe) is written directly; anything
    /// else is written to `path` with `.partial` at its end, which [`Output::commit`] renames. A symbolic link is followed: the file it leads
    /// to is replaced.
    ///
    /// Errors where the directory is missing, where `path` is a directory or may not be written, and where another run is
    /// writing the same output.
    pub fn create(path: &str) -> Result<Self> {
        if matches!(path, "-" | "/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1") {
            return Ok(Self::over(Sink::Stdout(io::stdout()), "standard output", None));
        }
        let failed = |source| Error::Io { file: Arc::from(path), source };
        let refused = |kind, message: &str| failed(io::Error::new(kind, message));
        let existing = existing(Path::new(path)).map_err(failed)?;
        match &existing {
            Some(metadata) if metadata.is_dir() => {
                return Err(refused(io::ErrorKind::IsADirectory, "is a directory, not a file"));
            }
            Some(metadata) if !metadata.is_file() || is_descriptor(path) => {
                // Appending matters only behind a descriptor of a regular file, which others write to as well.
                let file = OpenOptions::new().append(true).open(path).map_err(failed)?;
                return Ok(Self::over(Sink::File(file), path, None));
            }
            Some(metadata) if metadata.permissions().readonly() => {
                return Err(refused(io::ErrorKind::PermissionDenied, "may not be written: it is read-only"));
            }
            _ => {}
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| PathBuf::from(path));
        if path.ends_with('/') || target.file_name().is_none() {
            return Err(refused(io::ErrorKind::IsADirectory, "is the name of a directory, not of a file"));
        }
        check_directory(&target).map_err(failed)?;
        let partial = partial_of(&target);
        let file = lock(&partial).map_err(|source| Error::Io { file: partial.to_string_lossy().into(), source })?;
        if let Some(metadata) = existing {
            file.set_permissions(metadata.permissions()).map_err(failed)?;
        }
        Ok(Self::over(Sink::File(file), path, Some(Pending { partial, target })))
    }

    fn over(sink: Sink, name: &str, pending: Option<Pending>) -> Self {
        Self { sink: BufWriter::with_capacity(BUFFER, sink), name: Arc::from(name), pending }
    }

    /// The name in messages.
    pub fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// The file that holds what was written until [`Output::commit`]; `None` where it is written directly.
    pub fn partial_path(&self) -> Option<&Path> {
        self.pending.as_ref().map(|pending| pending.partial.as_path())
    }

    /// Names the output in an error of its writer. A reader that closed early is [`io::ErrorKind::BrokenPipe`].
    pub fn error(&self, source: io::Error) -> Error {
        Error::Io { file: self.name.clone(), source }
    }

    /// Writes what is still gathered, and puts the file under its name. Errors leave the partial file.
    pub fn commit(mut self) -> Result<()> {
        self.finish().map_err(|source| Error::Io { file: self.name.clone(), source })
    }

    /// Throws away what was not written yet, and removes the partial file: there is nothing to be had.
    ///
    /// # Errors
    /// The partial file can't be removed.
    pub fn discard(self) -> Result<()> {
        // Taken apart, so that nothing of what is gathered goes out.
        let (_sink, _gathered) = self.sink.into_parts();
        match &self.pending {
            Some(pending) => {
                fs::remove_file(&pending.partial).map_err(|source| Error::Io { file: self.name.clone(), source })
            }
            None => Ok(()),
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        self.sink.flush()?;
        let (Some(pending), Sink::File(file)) = (&self.pending, self.sink.get_ref()) else {
            return Ok(());
        };
        // Before the name: after a crash of the machine, the name must not lead to half a file.
        file.sync_all()?;
        // The lock is held on: another run that waits for it finds the partial file gone.
        fs::rename(&pending.partial, &pending.target)
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.sink.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}

/// Whether both paths lead to the same regular file; `-` is none.
pub fn same_file(one: &str, other: &str) -> bool {
    one != "-" && other != "-" && same_regular_file(Path::new(one), Path::new(other))
}

/// Whether writing to `output` would destroy `input`: they are the same file, or the input is the output's partial file.
pub fn overwrites(output: &str, input: &str) -> bool {
    if same_file(output, input) {
        return true;
    }
    let target = fs::canonicalize(output).unwrap_or_else(|_| PathBuf::from(output));
    output != "-" && input != "-" && same_regular_file(&partial_of(&target), Path::new(input))
}

fn same_regular_file(one: &Path, other: &Path) -> bool {
    let (Ok(first), Ok(second)) = (fs::metadata(one), fs::metadata(other)) else {
        return false;
    };
    first.is_file() && second.is_file() && (is_same(&first, &second) || is_same_path(one, other))
}

fn is_same_path(one: &Path, other: &Path) -> bool {
    match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

#[cfg(unix)]
pub(super) fn is_same(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Elsewhere files have no numbers to compare: paths must do.
#[cfg(not(unix))]
pub(super) fn is_same(_: &Metadata, _: &Metadata) -> bool {
    false
}

/// What is at the end of a path and its links; `None` where there is nothing.
fn existing(path: &Path) -> io::Result<Option<Metadata>> {
    match fs::metadata(path) {
        Ok(metadata) => Ok(Some(metadata)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether the path is a link in the system's own directories, such as `/dev/stderr`: what it leads to is no place to rename to.
fn is_descriptor(path: &str) -> bool {
    let own = path.starts_with("/dev/") || path.starts_with("/proc/");
    own && (path.starts_with("/dev/fd/") || fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink()))
}

/// Says that the directory is missing, which the system's "no such file" would leave open.
fn check_directory(target: &Path) -> io::Result<()> {
    let Some(directory) = target.parent().filter(|directory| !directory.as_os_str().is_empty()) else {
        return Ok(());
    };
    if existing(directory)?.is_none() {
        let message = format!("the directory {} does not exist", directory.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, message));
    }
    Ok(())
}

/// The name of a file's unfinished version, beside it.
fn partial_of(target: &Path) -> PathBuf {
    let mut name = OsString::from(target);
    name.push(PARTIAL);
    PathBuf::from(name)
}

/// Opens a partial file, locks it, and only then empties it.
fn lock(partial: &Path) -> io::Result<File> {
    for _ in 0..ATTEMPTS {
        if fs::symlink_metadata(partial).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, "is in the way: it is no regular file"));
        }
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(partial)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, "another run is writing this output"));
            }
            // A file system without locks: better without than not at all.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(error),
        }
        // Another run may have renamed the file before its lock was free: this is then its finished output.
        let still_there = match (file.metadata(), fs::metadata(partial)) {
            (Ok(opened), Ok(named)) => is_same(&opened, &named) || cfg!(not(unix)),
            _ => false,
        };
        if still_there {
            file.set_len(0)?;
            return Ok(file);
        }
    }
    Err(io::Error::new(io::ErrorKind::ResourceBusy, "other runs keep writing this output"))
}

#[cfg(test)]
mod tests;
