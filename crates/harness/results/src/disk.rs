//! Reading a whole file, and writing after which there is either the old file or the new one.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::ResultsError;

/// Replaces a file in one step: after a crash or a full disk there is the old file or the new one, never a part.
///
/// The bytes go to a temporary file in the same folder, are flushed to the disk, and the file is renamed. Missing folders are made.
pub fn atomic_write(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    atomic_write_with(path, |file| file.write_all(bytes))
}

/// Writes a file whole or not at all, without waiting for the disk: for what can be made again from other files. After a power failure the
/// file may be empty or the old one.
///
/// # Errors
/// [`ResultsError::Io`], which names the file.
pub fn quick_write(path: &Path, bytes: &[u8]) -> Result<(), ResultsError> {
    replace_file(path, false, |file| file.write_all(bytes))
}

/// The same for a file that is written piece by piece, and need not be in memory as a whole.
///
/// # Errors
/// [`ResultsError::Io`], also when `write` fails: there is the old file then.
pub fn atomic_write_with(path: &Path, write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>) -> Result<(), ResultsError> {
    replace_file(path, true, write)
}

/// Writes a temporary file beside the file and renames it; `durable` waits until the disk has both.
fn replace_file(path: &Path, durable: bool, write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>) -> Result<(), ResultsError> {
    /// Distinguishes the temporary files of one process.
    static SERIAL: AtomicU64 = AtomicU64::new(0);

    let io_error = |source| ResultsError::Io { path: path.to_owned(), source };
    let name = path.file_name().ok_or_else(|| io_error(io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file")))?;
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
    let temporary = folder.join(format!(".{}.{}.{serial}.tmp", name.to_string_lossy(), std::process::id()));

    let replace = || -> io::Result<()> {
        fs::create_dir_all(&folder)?;
        let mut file = OpenOptions::new().write(true).create_new(true).open(&temporary)?;
        let mut buffer = io::BufWriter::with_capacity(1 << 16, &mut file);
        write(&mut buffer)?;
        buffer.flush()?;
        drop(buffer);
        if durable {
            file.sync_all()?;
        }
        drop(file);
        fs::rename(&temporary, path)?;
        // The renaming is permanent only once the folder is flushed. Systems that cannot flush a folder are left as they are.
        if durable && let Ok(folder) = File::open(&folder) {
            let _ = folder.sync_all();
        }
        Ok(())
    };
    replace().map_err(|source| {
        let _ = fs::remove_file(&temporary);
        io_error(source)
    })
}

/// A whole file as bytes.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, ResultsError> {
    fs::read(path).map_err(|source| ResultsError::Io { path: path.to_owned(), source })
}

/// A whole file as text.
pub(crate) fn read_text(path: &Path) -> Result<String, ResultsError> {
    fs::read_to_string(path).map_err(|source| ResultsError::Io { path: path.to_owned(), source })
}
