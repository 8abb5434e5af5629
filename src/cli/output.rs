//! Standard output that may be closed, and files that are whole or not there.

use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::failure::Failure;

/// Writes to standard output. A reader that has closed its end (`| head`) has what it wanted: that is no failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Failure::Print { source }),
        _ => Ok(()),
    }
}

/// The name of a file or a folder to write. `-`, which elsewhere means standard output, is none.
pub(super) fn file_name(text: &str) -> Result<PathBuf, String> {
    match text {
        "-" => {
            Err("a file is wanted: this is written in place, not to standard output; ./- is a file of that name".into())
        }
        "" => Err("a name is wanted".into()),
        name => Ok(name.into()),
    }
}

/// Writes a line of JSON to standard output.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&(serde_json::to_string(value).unwrap_or_default() + "\n"))
}

/// Says something beside the output; nobody has to listen.
pub(super) fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Writes a file under a temporary name and renames it, so that no half of it is ever seen.
pub(super) fn write_file(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |source| Failure::Write { path: path.to_path_buf(), source };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut file = tempfile::Builder::new().permissions(shared()).tempfile_in(folder).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Permissions of an ordinary new file, rather than those of a secret one.
fn shared() -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    std::fs::Permissions::from_mode(0o644)
}
