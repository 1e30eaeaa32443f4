//! Writes the generated seeds of a target into a folder: `cargo run --example seeds -- TARGET FOLDER`.

use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, target, folder] = &arguments[..] else { return Err(std::io::Error::other("give a target and a folder")) };
    for (k, seed) in featherbench_fuzz::made_seeds(target).into_iter().enumerate() {
        std::fs::write(PathBuf::from(folder).join(format!("made-{k}")), seed)?;
    }
    Ok(())
}
