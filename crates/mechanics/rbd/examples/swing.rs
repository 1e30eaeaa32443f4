//! A chain of 36 links swings for ten seconds: a workspace in a loop, and the energy as a check.

use featherbench_rbd::dynamics::energy;
use featherbench_rbd::{Error, Robot};

fn main() -> Result<(), Error> {
    let robot = Robot::generated("chain:n=36")?;
    let (h, n) = (1e-3, robot.nv());
    let (mut q, mut v) = (robot.neutral(), vec![0.0; n]);
    q[0] = 0.5;
    let total = |q: &[f64], v: &[f64]| energy(robot.model(), q, v).map(|energy| energy.kinetic + energy.potential);
    let before = total(&q, &v)?;

    let mut workspace = robot.workspace();
    let (mut a, mut step, mut next, force_free) = (vec![0.0; n], vec![0.0; n], q.clone(), vec![0.0; n]);
    for _ in 0..10_000 {
        // Symplectic Euler: the velocity first, and with it the configuration.
        workspace.forward_dynamics(&q, &v, &force_free, None, &mut a)?;
        for ((v, a), step) in v.iter_mut().zip(&a).zip(&mut step) {
            *v += h * a;
            *step = h * *v;
        }
        robot.integrate_into(&q, &step, &mut next)?;
        std::mem::swap(&mut q, &mut next);
    }
    println!("energy {before:.4} J at the start, {:.4} J after 10 s", total(&q, &v)?);
    Ok(())
}
