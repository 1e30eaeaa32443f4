//! The unit-free error of derivatives, of the Coriolis matrix and of the regressor.
//!
//! A derivative by q has a unit in each entry: that of the force or acceleration of its row over that of the dof of its column. With
//! D = diag M, the entries of D^-½ ∂ID/∂q D^-½ and of D^½ ∂FD/∂q D^-½ are all in 1/s², those by v and the scaled C in 1/s. There they may be
//! compared: the error is the largest scaled difference over the largest scaled entry of the reference.

use super::magnitudes::Magnitudes;
use super::ratio::{ratio, worst};
use crate::{Quantity, Robot, layout};
use featherbench_dynamics::{Crba, TreeSparse};
use featherbench_model::JointKind;
use featherbench_results::Measure;

/// The error of a derivative or a Coriolis matrix; see [`derivative_size`].
pub(super) fn error(robot: &Robot, quantity: Quantity, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    let difference: Vec<f64> = value.iter().zip(reference).map(|(x, due)| x - due).collect();
    derivative_size(robot, quantity, at, reference, &difference)
}

/// The size of a change of a derivative or a Coriolis matrix: its largest scaled entry over that of the reference. If the rate of the state
/// is larger, it is over that rate.
///
/// The terms of a derivative have the size of that rate, squared if it is by q. They have it where they cancel, too: a pendulum's ∂ID/∂v is
/// zero at any speed, and derivatives by v are zero at rest. The result is NaN if an entry is.
pub fn derivative_size(robot: &Robot, quantity: Quantity, at: &Magnitudes, reference: &[f64], difference: &[f64]) -> f64 {
    let Measure::Derivative { forward, by_q } = quantity.measure() else { return f64::NAN };
    let Some(scales) = scales(robot, forward, at.state) else { return f64::NAN };
    let largest = |values: &mut dyn Iterator<Item = f64>| values.zip(&scales).fold(0.0, |most, (x, scale)| worst(most, (x * scale).abs()));
    let Rates { turning, falling, far } = Rates::of(robot, at);
    let squared = if far > 0.0 { turning + falling / far } else { turning };
    let size = worst(largest(&mut reference.iter().copied()), if by_q { squared } else { squared.sqrt() });
    ratio(largest(&mut difference.iter().copied()), size)
}

/// What each entry is multiplied by. `None` if M cannot be computed at the state.
fn scales(robot: &Robot, forward: bool, state: usize) -> Option<Vec<f64>> {
    let root = root(robot, state)?;
    let row = |x: &f64| if forward { *x } else { x.recip() };
    Some(root.iter().flat_map(|of_row| root.iter().map(move |of_column| row(of_row) / of_column)).collect())
}

/// The error of second derivatives, block by block. An entry is divided by √(M_jj·M_kk), and one by τ_k by √(M_jj/M_kk): so the entries of a
/// block have one unit. The largest difference is over the largest entry of the block.
///
/// Terms may cancel in the blocks by (q, q) and (q, v). So these are not smaller than the largest entry by (v, v) or (q, a) times the rate of
/// the state, squared or not. The result is NaN if an entry is.
pub(super) fn second_error(robot: &Robot, forward: bool, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    let Some(root) = root(robot, at.state) else { return f64::NAN };
    let turning = Rates::of(robot, at).turning;
    let n = root.len();
    let largest = |block: usize, entry: &dyn Fn(usize) -> f64| {
        let by_tau = block == 3 && forward;
        let scale = |j: usize, k: usize| if by_tau { root[k] / root[j] } else { (root[j] * root[k]).recip() };
        (0..n * n).fold(0.0, |most, place| worst(most, (entry(block * n * n + place) * scale(place / n, place % n)).abs()))
    };
    let size = |block: usize| largest(block, &|entry| reference[entry]);
    // Those by (q, τ) have another unit.
    let still = if forward { size(2) } else { worst(size(2), size(3)) };
    let least = [still * turning, still * turning.sqrt(), 0.0, 0.0];
    least.into_iter().enumerate().fold(0.0, |error, (block, least)| {
        let difference = largest(block, &|entry| value[entry] - reference[entry]);
        worst(error, ratio(difference, worst(size(block), least)))
    })
}

/// √M_ii at a state. `None` if M cannot be computed there.
fn root(robot: &Robot, state: usize) -> Option<Vec<f64>> {
    let model = &robot.model;
    let mut mass = TreeSparse::new(&model.topology);
    Crba::new(&model.topology).run(model, robot.states.q(state), &mut mass).ok()?;
    Some(mass.diagonal().map(f64::sqrt).collect())
}

/// How fast the bodies turn and fall at a state.
struct Rates {
    /// The largest angular acceleration and squared angular velocity of a body, 1/s².
    turning: f64,
    /// The largest linear acceleration, gravity included, m/s².
    falling: f64,
    /// The distance of the farthest body's end from the world's origin, m.
    far: f64,
}

impl Rates {
    fn of(robot: &Robot, at: &Magnitudes) -> Self {
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, worst);
        Self {
            turning: most(&mut at.angular_acceleration.iter().zip(&at.angular_velocity).map(|(alpha, omega)| alpha + omega * omega)),
            falling: most(&mut at.linear_acceleration.iter().copied()) + robot.model.gravity.norm(),
            far: most(&mut at.reach.iter().zip(&at.size).map(|(reach, size)| reach + size)),
        }
    }
}

/// The largest difference of an entry of the regressor. Entries are divided by √M_ii of their row. Then they are compared with the largest
/// of the same unit: those of all masses, first moments or inertias. As terms may cancel, the rates of the state count as well.
pub(super) fn regressor_error(robot: &Robot, at: &Magnitudes, reference: &[f64], value: &[f64]) -> f64 {
    let Some(root) = root(robot, at.state) else { return f64::NAN };
    let model = &robot.model;
    let dofs = model.topology.joints().iter().zip(&model.subspaces).flat_map(|(joint, subspace)| match joint.kind {
        JointKind::Free => vec![(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (1.0, 0.0), (1.0, 0.0), (1.0, 0.0)],
        JointKind::Spherical => vec![(1.0, 0.0); 3],
        _ => vec![(subspace.ang.norm(), subspace.lin.norm())],
    });
    let Rates { turning, falling, far } = Rates::of(robot, at);
    let mut least = [0.0; 3];
    for ((turn, slide), root) in dofs.zip(&root) {
        // A unit of mass, of first moment and of inertia: its force and moment at these rates.
        for (least, force) in least.iter_mut().zip([(turn * far + slide) * falling, turn * falling + slide * turning, turn * turning]) {
            *least = worst(*least, force / root);
        }
    }
    by_unit(&root, least, reference, value)
}

fn by_unit(root: &[f64], least: [f64; 3], reference: &[f64], value: &[f64]) -> f64 {
    let unit = |entry: usize| match entry % layout::PARAMETERS {
        0 => 0,
        1..=3 => 1,
        _ => 2,
    };
    let width = reference.len() / root.len();
    let scaled = |entry: usize, x: f64| x / root[entry / width];
    let mut sizes = least;
    for (entry, &x) in reference.iter().enumerate() {
        sizes[unit(entry)] = worst(sizes[unit(entry)], scaled(entry, x).abs());
    }
    let pairs = reference.iter().zip(value).enumerate();
    pairs.fold(0.0, |error, (entry, (due, x))| worst(error, ratio(scaled(entry, x - due), sizes[unit(entry)])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_results::ModelOrigin;
    use featherbench_robots::Family;

    /// Each block has its own size, and entries that are small in their units count as much as large ones.
    #[test]
    fn second_derivatives_are_measured_by_block() {
        let description = Family::parse("chain:n=2,layout=spatial").unwrap().generate().unwrap();
        let robot = Robot::new(&description, "test", ModelOrigin::Generated, 1, 1).unwrap();
        let (at, root) = (&robot.magnitudes()[0], root(&robot, 0).unwrap());
        for forward in [false, true] {
            let unit = |entry: usize| {
                let (block, j, k) = (entry / 4, entry / 2 % 2, entry % 2);
                if block == 3 && forward { root[j] / root[k] } else { root[j] * root[k] }
            };
            // 1e9 in the blocks by (q, q) and (q, v), where the rates of the state are a smaller size.
            let due: Vec<f64> = (0..16).map(|entry| unit(entry) * [1e9, 1e9, 2.0, 4.0][entry / 4]).collect();
            for entry in 0..16 {
                let mut value = due.clone();
                value[entry] += 0.25 * unit(entry);
                let found = second_error(&robot, forward, at, &due, &value);
                let size = [1e9, 1e9, 2.0, 4.0][entry / 4];
                assert!((found * size / 0.25 - 1.0).abs() < 1e-6, "forward {forward} at {entry}: {found:e}");
            }
        }
    }

    #[test]
    fn a_regressor_is_measured_by_unit() {
        let due: Vec<f64> = (0..40).map(|entry| if entry % 10 == 0 { 1e6 } else { 1.0 }).collect();
        let off = |entry: usize, by: f64| {
            let mut found = due.clone();
            found[entry] += by;
            by_unit(&[1.0, 2.0], [0.0; 3], &due, &found)
        };
        assert_eq!(off(0, 1.0), 1e-6, "beside masses");
        assert_eq!(off(5, 0.25), 0.25, "not beside masses");
        assert_eq!(off(25, 0.25), 0.125, "in the unit of the row");
        assert_eq!(
            by_unit(
                &[1.0, 2.0],
                [0.0, 4.0, 0.0],
                &[0.0; 20],
                &[1.0; 20][..].iter().enumerate().map(|(k, x)| if k == 1 { *x } else { 0.0 }).collect::<Vec<_>>()
            ),
            0.25
        );
        assert!(off(33, f64::NAN).is_nan());
        assert_eq!(by_unit(&[1.0], [0.0; 3], &[0.0; 20], &[1e-300; 20]), f64::INFINITY);
    }
}
