//! Writes every problem of `systems` as a file: `cargo run -p featherbench-contact --example contact_systems -- datasets/contact`.

use featherbench_contact::{file, systems};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("name the folder to write into")?;
    for problem in systems::all()? {
        file::write(&problem, Path::new(&folder).join(format!("{}.json", problem.name())))?;
    }
    Ok(())
}
