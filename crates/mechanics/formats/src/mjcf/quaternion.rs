//! Quaternions: the rotation of an MJCF quaternion, and the inverse.

use featherbench_model::Placement;
use featherbench_spatial::largest;

/// The rotation of a quaternion (w, x, y, z) of any length, row-major. It is operation by operation the formula of the MuJoCo oracle for
/// numbers that MuJoCo imported (`turned` in `oracles/featherbench_oracles/core/reading.py`).
pub(super) fn rotation([w, x, y, z]: [f64; 4]) -> [f64; 9] {
    let (ww, xx, yy, zz) = (w * w, x * x, y * y, z * z);
    let n = ((ww + xx) + yy) + zz;
    let entries = [
        ((ww + xx) - yy) - zz,
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        ((ww - xx) + yy) - zz,
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        ((ww - xx) - yy) + zz,
    ];
    entries.map(|entry| entry / n + 0.0)
}

/// The description's rotation of an imported quaternion: normalised as the canonical form does it.
fn read(q: [f64; 4]) -> [f64; 9] {
    Placement { rotation: rotation(q), ..Placement::default() }.normalised().rotation
}

/// A quaternion of a rotation, and the largest error of an entry. If a quaternion nearby gives these nine numbers exactly, it is taken.
/// Otherwise it is the nearest one on grids that are coarse enough to be found again from their own rotations.
/// So a second round trip changes nothing.
pub(super) fn quaternion(r: &[f64; 9]) -> ([f64; 4], f64) {
    let near = estimate(r);
    let error = |q: &[f64; 4]| largest(r.iter().zip(read(*q)).map(|(a, b)| a - b));
    let on_grids = GRIDS.into_iter().map(|grid| on_grid(near, grid));
    let exact = on_grids.chain(neighbours(near, last_place)).find(|q| error(q) == 0.0);
    let q = exact.unwrap_or_else(|| {
        let candidates = GRIDS.into_iter().flat_map(|grid| neighbours(near, move |_| grid).map(move |q| (grid, on_grid(q, grid))));
        let found_again = candidates.filter(|&(grid, q)| on_grid(estimate(&read(q)), grid) == q).map(|(_, q)| q);
        found_again.min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(near)
    });
    (q.map(|x| x + 0.0), error(&q))
}

/// From the error of an estimate, where few points are found again, to four times that, where all are.
const GRIDS: [f64; 3] = [f64::EPSILON / 2.0, f64::EPSILON, 2.0 * f64::EPSILON];

/// Rounds all components to the grid but the first large one, which follows from the length one. (One component is always at least ½. A
/// lower threshold chooses the same one for equal components.)
fn on_grid(q: [f64; 4], step: f64) -> [f64; 4] {
    let large = q.iter().position(|x| x.abs() > 0.49).unwrap_or(0);
    let mut grid = q.map(|x| (x / step).round() * step);
    grid[large] = 0.0;
    grid[large] = (1.0 - grid.iter().map(|x| x * x).sum::<f64>()).sqrt().copysign(q[large]);
    grid
}

fn last_place(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}

/// A quaternion and its neighbours, each component up to two steps away.
fn neighbours(q: [f64; 4], step: impl Fn(f64) -> f64) -> impl Iterator<Item = [f64; 4]> {
    let [w, x, y, z] = q.map(|x| [0.0, 1.0, -1.0, 2.0, -2.0].map(|k| x + k * step(x)));
    (0..5_usize.pow(4)).map(move |k| [w[k % 5], x[k / 5 % 5], y[k / 25 % 5], z[k / 125]])
}

/// A unit quaternion of a rotation, with the component of largest magnitude positive. That one is a square root, the others are quotients.
pub(crate) fn estimate(r: &[f64; 9]) -> [f64; 4] {
    let [xx, yy, zz] = [r[0], r[4], r[8]];
    let squares = [1.0 + xx + yy + zz, 1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz];
    let (wx, wy, wz) = (r[7] - r[5], r[2] - r[6], r[3] - r[1]);
    let (xy, xz, yz) = (r[1] + r[3], r[2] + r[6], r[5] + r[7]);
    let largest = (0..4).max_by(|&a, &b| squares[a].total_cmp(&squares[b])).unwrap_or(0);
    let (row, square) = match largest {
        0 => ([squares[0], wx, wy, wz], squares[0]),
        1 => ([wx, squares[1], xy, xz], squares[1]),
        2 => ([wy, xy, squares[2], yz], squares[2]),
        _ => ([wz, xz, yz, squares[3]], squares[3]),
    };
    // Each is four times the component times the largest one.
    let scale = 2.0 * square.sqrt();
    row.map(|x| x / scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::share::one_of;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn component() -> impl Strategy<Value = f64> {
        let small = (-1.0..1.0, -20..0).prop_map(|(x, e): (f64, i32)| x * 10_f64.powi(e));
        prop_oneof![6 => -1.0..1.0, 2 => Just(0.0), 1 => Just(0.5), 1 => Just(-0.5), 2 => small]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 300 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

        /// The error of any rotation is at most 8ε, and the second round trip gives the same bits.
        #[test]
        fn the_second_trip_changes_nothing(q in [component(), component(), component(), component()]) {
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            prop_assume!(length > 1e-3);
            let given = read(q.map(|x| x / length));
            let (first, error) = quaternion(&given);
            let read = read(first);
            prop_assert!(error <= 8.0 * f64::EPSILON, "{error:e}");
            prop_assert_eq!(quaternion(&read).1, 0.0, "{:?}", first);
        }

        /// Rotations of another formula.
        #[test]
        fn products_of_rotations_are_met_within_rounding(a in [component(), component(), component(), component()], b in [component(), component(), component(), component()]) {
            prop_assume!([a, b].iter().all(|q| q.iter().any(|x| x.abs() > 1e-3)));
            let (a, b) = (read(a), read(b));
            let product: [f64; 9] = std::array::from_fn(|k| (0..3).map(|j| a[3 * (k / 3) + j] * b[3 * j + k % 3]).sum());
            let (first, error) = quaternion(&product);
            prop_assert!(error <= 8.0 * f64::EPSILON, "{error:e}");
            prop_assert_eq!(quaternion(&read(first)).1, 0.0, "{:?}", first);
        }
    }
}
