//! The joint forces that hold a robot still. `cargo run -p featherbench-rbd --example hold [ROBOT.urdf]`

use featherbench_rbd::spatial::largest;
use featherbench_rbd::{Error, Robot};

fn main() -> Result<(), Error> {
    let robot = std::env::args().nth(1).map_or_else(|| Robot::generated("humanoid"), Robot::from_file)?;
    let (q, still) = (robot.neutral(), vec![0.0; robot.nv()]);
    let tau = robot.inverse_dynamics(&q, &still, &still)?;
    for joint in robot.joints() {
        println!("{:<24} {:?}", joint.name, &tau[joint.v.clone()]);
    }
    let left = robot.forward_dynamics(&q, &still, &tau)?;
    println!("left over: an acceleration of {:.1e}", largest(left));
    Ok(())
}
