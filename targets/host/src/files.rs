//! Files that are there as a whole or not at all.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Writes a file beside its place and renames it, so that no reader sees half of it. Makes the
/// folder if it is missing; where the file cannot be written, nothing new is left.
///
/// # Errors
/// When the file cannot be written.
pub fn write_whole(path: &Path, contents: &[u8]) -> io::Result<()> {
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
        .and_then(|()| write_into(folder, path, contents))
        .inspect_err(|_| {
            // The innermost first; one that somebody else uses meanwhile is not empty and stays.
            for folder in &missing {
                let _ = std::fs::remove_dir(folder);
            }
        })
}

/// Writes a file of a folder that exists.
fn write_into(folder: &Path, path: &Path, contents: &[u8]) -> io::Result<()> {
    let mut beside = tempfile::Builder::new();
    // Results are no secrets: the usual permissions of new files.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        beside.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = beside.prefix(".hexagen-").tempfile_in(folder)?;
    file.write_all(contents)?;
    file.persist(path)?;
    Ok(())
}
