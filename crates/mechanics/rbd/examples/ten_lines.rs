//! The guide's first program: a robot from a file, a number that Pinocchio gives too.
use featherbench_rbd::{Error, Robot};

fn main() -> Result<(), Error> {
    let robot = Robot::from_urdf("guide/arm.urdf")?;
    let (q, v, a) = ([0.3, -0.5, 0.1], [1.0, 0.5, -0.2], [0.2, 0.4, 0.6]);
    let tau = robot.inverse_dynamics(&q, &v, &a)?;
    let again = robot.forward_dynamics(&q, &v, &tau)?;
    println!("the shoulder needs {:.9} N m; forward dynamics gives back {again:.6?}", tau[0]);
    Ok(())
}
