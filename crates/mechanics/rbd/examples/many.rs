//! Inverse dynamics of 100 000 states on all cores, and which of them failed.

use featherbench_rbd::dynamics::BatchError;
use featherbench_rbd::{Error, Robot};

fn main() -> Result<(), Error> {
    let robot = Robot::generated("humanoid")?;
    let count = 100_000;
    let q = robot.random_batch(count, 1);
    let (mut v, a, mut tau) = (vec![0.1; count * robot.nv()], vec![0.0; count * robot.nv()], vec![0.0; count * robot.nv()]);
    v[17 * robot.nv()] = f64::NAN; // one bad state does no harm to others
    match robot.batch().on_all_cores().inverse_dynamics(&q, &v, &a, None, &mut tau) {
        Err(BatchError::Failed { failures, states }) => println!("{} of {states} states failed: {}", failures.len(), failures[0]),
        other => other?,
    }
    let valid = tau.chunks_exact(robot.nv()).filter(|tau| tau.iter().all(|x| x.is_finite())).count();
    println!("{valid} states have joint forces");
    Ok(())
}
