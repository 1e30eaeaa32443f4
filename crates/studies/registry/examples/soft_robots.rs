//! Writes the description files of the soft robots, `datasets/models/soft`: `cargo run -p featherbench-registry --example soft_robots`.

use featherbench_continua::examples::{cable_arm, gripper};
use featherbench_formats::neutral;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../datasets/models/soft");
    std::fs::create_dir_all(&folder)?;
    for robot in [gripper(), cable_arm()] {
        let path = folder.join(format!("{}.json", robot.name));
        neutral::write(&robot, &path)?;
        println!("{}", path.display());
    }
    Ok(())
}
