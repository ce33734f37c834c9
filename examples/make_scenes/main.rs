//! Makes the scenes in `scenes/`, byte for byte: `cargo run --example make_scenes [FOLDER]`.

mod files;

use std::io::Write;
use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder = PathBuf::from(env::args_os().nth(1).unwrap_or_else(|| "scenes".into()));
    for (name, bytes) in files::all() {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap_or(&folder))?;
        writeln!(io::stdout(), "{:>8} {}", bytes.len(), path.display())?;
        fs::write(path, bytes)?;
    }
    Ok(())
}
