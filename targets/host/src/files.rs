//! Files that are written completely or not at all.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Writes a file under another name and renames it, so that no reader sees a part of it. Creates a
/// missing folder, and removes it again where the file cannot be written.
///
/// # Errors
/// When the file cannot be written.
pub fn write_whole(path: &Path, contents: &[u8]) -> io::Result<()> {
    write_new(path, contents, true)
}

/// As [`write_whole`]; a file that is there stays as it is, unless it is to be replaced.
///
/// # Errors
/// As [`write_whole`], or a file that is there.
pub fn write_new(path: &Path, contents: &[u8], replace: bool) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let missing: Vec<PathBuf> = folder
        .ancestors()
        .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists())
        .map(Path::to_owned)
        .collect();
    std::fs::create_dir_all(folder)
        .and_then(|()| write_into(folder, path, contents, replace))
        .inspect_err(|_| {
            // Innermost first; a folder that is no longer empty stays.
            for folder in &missing {
                let _ = std::fs::remove_dir(folder);
            }
        })
}

/// Writes a file of a folder that exists.
fn write_into(folder: &Path, path: &Path, contents: &[u8], replace: bool) -> io::Result<()> {
    let mut beside = tempfile::Builder::new();
    // Results are no secrets: the usual permissions of new files.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        beside.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = beside.prefix(".hexagen-").tempfile_in(folder)?;
    file.write_all(contents)?;
    if replace {
        file.persist(path)?;
    } else {
        file.persist_noclobber(path)?;
    }
    Ok(())
}
