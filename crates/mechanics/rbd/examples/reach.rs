//! Inverse kinematics: the hand of an arm of seven joints goes where it can, by damped least squares over the Jacobian.

use featherbench_rbd::spatial::Motion;
use featherbench_rbd::{Error, Robot};

fn main() -> Result<(), Error> {
    let robot = Robot::generated("chain:n=7,layout=spatial")?;
    let hand = robot.frame(robot.bodies()[6])?;
    let target = robot.placement(&robot.random(1), hand.name())?;
    let (mut q, mut workspace) = (robot.random(2), robot.workspace());
    for round in 0..200 {
        let placed = workspace.placements(&q)?.placement(&hand)?;
        let error = target.translation - placed.translation;
        println!("{round:>3}: {:.3e} m", error.norm());
        if error.norm() < 1e-10 {
            break;
        }
        // q̇ = λ-damped Jᵀ (J Jᵀ + λ²)⁻¹ error, of the position alone
        let columns: Vec<Motion<f64>> = workspace.jacobian(&q, &hand)?.to_vec();
        let mut normal = [[0.0; 3]; 3];
        for column in &columns {
            let j = column.lin.to_array();
            for (row, x) in normal.iter_mut().zip(j) {
                row.iter_mut().zip(j).for_each(|(entry, y)| *entry += x * y);
            }
        }
        let damping = 1e-6 + error.norm() * error.norm();
        (0..3).for_each(|k| normal[k][k] += 0.01 * damping);
        let y = solve3(normal, error.to_array());
        let step: Vec<f64> = columns.iter().map(|column| column.lin.to_array().iter().zip(y).map(|(j, y)| j * y).sum()).collect();
        q = robot.integrate(&q, &step)?;
    }
    Ok(())
}

/// The solution of three equations by Cramer's rule.
fn solve3(m: [[f64; 3]; 3], b: [f64; 3]) -> [f64; 3] {
    let det = |m: [[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    [0, 1, 2].map(|k| {
        let mut replaced = m;
        (0..3).for_each(|i| replaced[i][k] = b[i]);
        det(replaced) / det(m)
    })
}
