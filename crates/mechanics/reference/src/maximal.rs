//! Forward dynamics in maximal coordinates: every body free, every joint a constraint, all in one saddle-point system.
//!
//! Computes with these symbols, for each joint between two bodies:
//!
//! - x: accelerations (c̈, α) of all bodies;
//! - B x: relative acceleration across the joint, at the child's origin;
//! - β: the part of B x that depends neither on q̈ nor on x;
//! - S: the joint's columns; C: a basis of the space orthogonal to them; D = S (SᵀS)⁻¹;
//! - A: armature, an inertia on the joint's own rate.
//!
//! ```text
//! B x = S q̈ + β     joint: C (B x − β) = 0     q̈ = Dᵀ (B x − β)
//! ⎡ 𝓜 + Σ BᵀD A DᵀB   −(CB)ᵀ ⎤ ⎡ x ⎤   ⎡ m g, −ω × I ω + Σ BᵀD (τ + A Dᵀβ) ⎤
//! ⎣ CB                 0     ⎦ ⎣ λ ⎦ = ⎣ Cβ                                ⎦
//! ```
//!
//! Source: Newton–Euler with Lagrange multipliers, Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapter 3. There are no Jacobians
//! along paths, and no mass matrix of the tree. Frame: world. Cost: O(bodies³) by dense elimination: 20 bodies take a fifth of a second.

use crate::motion::Motion;
use crate::robot::Robot;
use crate::space::Vec3;
use crate::{Error, Matrix, Mp};
use std::array::from_fn;

/// A motion across a joint: angular, then linear at the child's origin.
type Six = [Mp; 6];

/// q̈ = FD(q, v, τ) by constraints instead of by a mass matrix.
///
/// # Errors
/// [`Error::Length`], or [`Error::Singular`] when the accelerations are not determined.
pub fn forward_dynamics(motion: &Motion, tau: &[Mp]) -> Result<Vec<Mp>, Error> {
    let robot = motion.robot;
    Robot::check("tau", tau.len(), robot.nv())?;
    let count = robot.bodies();
    let constrained: usize = robot.bodies.iter().map(|body| 6 - body.nv).sum();
    let order = 6 * count + constrained;
    let (mut matrix, mut right) = (Matrix::zero(order), vec![Mp::zero(); order]);

    // 𝓜 and the forces that act without joints.
    for (index, (body, b)) in robot.bodies.iter().zip(&motion.bodies).enumerate() {
        let gyroscopic = b.omega.cross(&b.inertia.apply(&b.omega));
        for i in 0..3 {
            matrix.set(6 * index + i, 6 * index + i, body.mass.clone());
            right[6 * index + i] = &body.mass * &robot.gravity.0[i];
            for j in 0..3 {
                matrix.set(6 * index + 3 + i, 6 * index + 3 + j, b.inertia.0[i].0[j].clone());
            }
            right[6 * index + 3 + i] = -&gyroscopic.0[i];
        }
    }

    let mut row = 6 * count;
    let mut answers: Vec<(Vec<(usize, Mp)>, Mp)> = Vec::with_capacity(robot.nv());
    for (index, body) in robot.bodies.iter().enumerate() {
        let joint = Joint::new(motion, index);
        for (dof, dual) in duals(&joint.columns).into_iter().enumerate() {
            let k = body.v + dof;
            let across = joint.pull_back(&dual);
            let armature = &robot.armature[k];
            let drift = inner(&dual, &joint.drift);
            let drive = &tau[k] + armature * &drift;
            for (i, share) in &across {
                right[*i] = &right[*i] + share * &drive;
                for (j, other) in &across {
                    matrix.set(*i, *j, matrix.get(*i, *j) + share * other * armature);
                }
            }
            answers.push((across, drift));
        }
        for normal in complement(&joint.columns, &robot.precision.integer(1)) {
            for (i, share) in joint.pull_back(&normal) {
                matrix.set(i, row, -&share);
                matrix.set(row, i, share);
            }
            right[row] = inner(&normal, &joint.drift);
            row += 1;
        }
    }
    let x = matrix.solve(&right)?;
    Ok(answers.into_iter().map(|(across, drift)| across.iter().map(|(i, share)| share * &x[*i]).sum::<Mp>() - drift).collect())
}

/// A joint's columns S, its drift β and its map B.
struct Joint {
    columns: Vec<Six>,
    drift: Six,
    /// Body, sign, and the joint's position relative to the body's centre of mass: of the child, then of the parent if there is one.
    sides: Vec<(usize, bool, Vec3<Mp>)>,
}

impl Joint {
    fn new(motion: &Motion, index: usize) -> Self {
        let (body, child) = (&motion.robot.bodies[index], &motion.bodies[index]);
        let arm = child.origin.minus(&child.com);
        // β, the effect of the rates alone. Angular: Σ ż v. Linear: Σ l̇ v, the rotation of the parent below the moving origin, and the way
        // from there to the child's centre.
        let mut angular = Vec3::zero();
        let mut linear = Vec3::zero().minus(&child.omega.cross(&child.omega.cross(&arm)));
        let mut sides = vec![(index, true, arm)];
        if let Some(parent) = body.parent {
            let carrier = &motion.bodies[parent];
            linear = linear.plus(&carrier.omega.cross(&child.velocity.minus(&carrier.com_velocity)));
            sides.push((parent, false, child.origin.minus(&carrier.com)));
        }
        let mut columns = Vec::with_capacity(body.nv);
        for k in body.v..body.v + body.nv {
            let column = &motion.columns[k];
            angular = angular.plus(&column.z_rate.times(&motion.v[k]));
            linear = linear.plus(&column.l_rate.times(&motion.v[k]));
            columns.push(joined(&column.z, &column.l));
        }
        Self { columns, drift: joined(&angular, &linear), sides }
    }

    /// Bᵀ f, as the entries that are not zero by construction. With B x = ±(α, c̈ + α × r), force f and moment n + r × f act at the centre.
    fn pull_back(&self, f: &Six) -> Vec<(usize, Mp)> {
        let moment = Vec3(from_fn(|i| f[i].clone()));
        let force = Vec3(from_fn(|i| f[3 + i].clone()));
        let mut entries = Vec::with_capacity(12);
        for (body, positive, arm) in &self.sides {
            let turned = moment.plus(&arm.cross(&force));
            let signed = |x: &Mp| if *positive { x.clone() } else { -x };
            entries.extend((0..3).map(|i| (6 * body + i, signed(&force.0[i]))));
            entries.extend((0..3).map(|i| (6 * body + 3 + i, signed(&turned.0[i]))));
        }
        entries
    }
}

fn joined(angular: &Vec3<Mp>, linear: &Vec3<Mp>) -> Six {
    from_fn(|i| if i < 3 { angular.0[i].clone() } else { linear.0[i - 3].clone() })
}

fn inner(a: &Six, b: &Six) -> Mp {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The component of a vector that is orthogonal to some vectors, which are orthogonal to each other.
fn beside(six: &Six, orthogonal: &[Six]) -> Six {
    orthogonal.iter().fold(six.clone(), |rest, basis| {
        let share = &inner(basis, &rest) / &inner(basis, basis);
        from_fn(|i| &rest[i] - &share * &basis[i])
    })
}

/// Gram–Schmidt: an orthogonal basis of the span of the columns.
fn orthogonal<'a>(columns: impl IntoIterator<Item = &'a Six>) -> Vec<Six> {
    let mut basis: Vec<Six> = Vec::new();
    for column in columns {
        basis.push(beside(column, &basis));
    }
    basis
}

/// D = S (SᵀS)⁻¹ column by column: the component orthogonal to the other columns, scaled so that its product with the column is one.
fn duals(columns: &[Six]) -> Vec<Six> {
    let dual = |k: usize| {
        let others = columns[..k].iter().chain(&columns[k + 1..]);
        let rest = beside(&columns[k], &orthogonal(others));
        let scale = inner(&rest, &columns[k]);
        from_fn(|i| &rest[i] / &scale)
    };
    (0..columns.len()).map(dual).collect()
}

/// An orthogonal basis of the space orthogonal to the columns: Gram–Schmidt on the unit vectors, the one with the largest rest first.
fn complement(columns: &[Six], one: &Mp) -> Vec<Six> {
    let mut taken: Vec<Six> = orthogonal(columns);
    while taken.len() < 6 {
        let residual = |axis: usize| beside(&from_fn(|i| if i == axis { one.clone() } else { Mp::zero() }), &taken);
        let residuals: [Six; 6] = from_fn(residual);
        let size = |six: &Six| inner(six, six);
        let [first, others @ ..] = residuals;
        taken.push(others.into_iter().fold(first, |best, six| if size(&six) > size(&best) { six } else { best }));
    }
    taken.split_off(columns.len())
}
