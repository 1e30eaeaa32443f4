//! One state in the coordinates of Pinocchio, MuJoCo and Drake.

use featherbench_rbd::{Convention, Error, Robot};

fn main() -> Result<(), Error> {
    let robot = Robot::generated("chain:n=1,base=free")?;
    let (q, v) = (robot.random(1), vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);
    println!("ours       q {q:.3?}\n           v {v:.3?}");
    for convention in [Convention::Pinocchio, Convention::MuJoCo, Convention::Drake] {
        let (their_q, their_v) = (robot.configuration_to(convention, &q)?, robot.velocity_to(convention, &q, &v)?);
        println!("{:<10} q {their_q:.3?}\n           v {their_v:.3?}", convention.to_string());
    }
    Ok(())
}
