//! Roll, pitch and yaw: the rotation of URDF angles, and the inverse. The rotation of a quaternion.

use featherbench_spatial::{DoubleDouble, Real, largest};
use std::f64::consts::TAU;

/// Rz(yaw)·Ry(pitch)·Rx(roll), row-major: the doubles nearest to that rotation, which then needs no normalising.
pub(super) fn rotation(angles: [f64; 3]) -> [f64; 9] {
    let [(sr, cr), (sp, cp), (sy, cy)] = angles.map(sin_cos);
    let entries = [
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    ];
    // No negative zeros: the rotation of zero angles is the identity to the bit.
    entries.map(|entry| entry.to_f64() + 0.0)
}

/// The rotation of a quaternion (x, y, z, w) of any length, and its length; `None` of zeros. The doubles nearest to that rotation.
pub(super) fn of_quaternion(given: [f64; 4]) -> Option<([f64; 9], f64)> {
    // Scaled first, so that squares neither overflow nor underflow.
    let size = largest(given);
    if size == 0.0 {
        return None;
    }
    let [x, y, z, w] = given.map(|x| DoubleDouble::from_f64(x) / DoubleDouble::from_f64(size));
    let square = x * x + y * y + z * z + w * w;
    let twice = DoubleDouble::from_f64(2.0) / square;
    let one = DoubleDouble::from_f64(1.0);
    let entries = [
        one - twice * (y * y + z * z),
        twice * (x * y - z * w),
        twice * (x * z + y * w),
        twice * (x * y + z * w),
        one - twice * (x * x + z * z),
        twice * (y * z - x * w),
        twice * (x * z - y * w),
        twice * (y * z + x * w),
        one - twice * (x * x + y * y),
    ];
    Some((entries.map(|entry| entry.to_f64() + 0.0), size * square.sqrt().to_f64()))
}

/// Sine and cosine with 32 digits.
fn sin_cos(angle: f64) -> (DoubleDouble, DoubleDouble) {
    DoubleDouble::from_f64(angle).sin_cos()
}

/// Angles of a rotation. If a triple gives these nine numbers exactly, as for a rotation that was imported, it is taken; otherwise a near
/// one. A second round trip gives the same angles. No negative zeros.
pub(super) fn angles(r: &[f64; 9]) -> [f64; 3] {
    nearest(&rotation(nearest(r))).map(|angle| angle + 0.0)
}

/// The largest difference of two rotations' entries.
pub(super) fn distance(a: &[f64; 9], b: &[f64; 9]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a - b))
}

/// The angles that give exactly this rotation, or else the candidate that comes nearest.
fn nearest(r: &[f64; 9]) -> [f64; 3] {
    let candidates = candidates(r);
    let exact = candidates.iter().find_map(|&near| exact(r, near));
    let error = |angles: &[f64; 3]| distance(&rotation(*angles), r);
    exact.or_else(|| candidates.into_iter().min_by(|a, b| error(a).total_cmp(&error(b)))).unwrap_or_default()
}

/// Angles by inverse tangents. Two pitches belong to a rotation: θ and π − θ. There are two formulas for the yaw. The first column of R
/// loses nothing if the rotation was made from angles. The other two columns are good for any rotation, near the poles as well.
fn candidates(r: &[f64; 9]) -> [[f64; 3]; 4] {
    let of = |side: f64| {
        let pitch = (-r[6]).atan2(side * r[7].hypot(r[8]));
        let roll = (side * r[7]).atan2(side * r[8]);
        let (sin, cos) = roll.sin_cos();
        let yaw = (sin * r[2] - cos * r[1]).atan2(cos * r[4] - sin * r[5]);
        [[roll, pitch, (side * r[3]).atan2(side * r[0])], [roll, pitch, yaw]]
    };
    let ([a, b], [c, d]) = (of(1.0), of(-1.0));
    [a, b, c, d]
}

/// The largest error of the inverse tangents, in units in the last place: each has about two, and its arguments as much.
const ULPS: usize = 5;

/// The first triple near these angles, or near a full turn away, that gives the rotation to the bit. Each angle is compared with the
/// entries that it alone determines, before triples are tried.
fn exact(r: &[f64; 9], [roll, pitch, yaw]: [f64; 3]) -> Option<[f64; 3]> {
    neighbours(pitch).filter(|pitch| 0.0 - sin_cos(*pitch).0.to_f64() == r[6]).find_map(|pitch| {
        let cp = sin_cos(pitch).1;
        let made = |angle: &f64, sin: f64, cos: f64| {
            let (s, c) = sin_cos(*angle);
            (s * cp).to_f64() == sin && (c * cp).to_f64() == cos
        };
        let rolls = neighbours(roll).filter(|roll| made(roll, r[7], r[8]));
        rolls.into_iter().find_map(|roll| {
            let yaws = neighbours(yaw).filter(|yaw| made(yaw, r[3], r[0]));
            yaws.map(|yaw| [roll, pitch, yaw]).find(|&angles| rotation(angles) == *r)
        })
    })
}

/// An angle, its neighbours among the doubles in order of distance, and the same a full turn away, as files may have it.
fn neighbours(angle: f64) -> impl Iterator<Item = f64> {
    [angle, angle - TAU, angle + TAU].into_iter().flat_map(|centre| {
        let up = std::iter::successors(Some(centre), |x| Some(x.next_up())).take(ULPS + 1);
        let down = std::iter::successors(Some(centre.next_down()), |x| Some(x.next_down())).take(ULPS);
        up.chain(down)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::share::one_of;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Angles as in files: anything, few digits, quarter turns, and numbers close to these.
    fn angle() -> impl Strategy<Value = f64> {
        let quarter = (-4..=4).prop_map(|k| f64::from(k) * FRAC_PI_2);
        let typed = (-6283..=6283).prop_map(|k| f64::from(k) / 1000.0);
        let near =
            (quarter.clone(), -16..=0, -1.0..1.0).prop_map(|(angle, exponent, x): (f64, i32, f64)| angle + x * 10_f64.powi(exponent));
        prop_oneof![4 => -PI..PI, 2 => quarter, 2 => typed, 3 => near, 1 => -8.0..8.0]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 5_000 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

        /// A rotation that was imported from angles is written back to the bit.
        #[test]
        fn a_rotation_from_a_file_goes_back_exactly(given in [angle(), angle(), angle()]) {
            let read = rotation(given);
            let again = rotation(angles(&read));
            prop_assert_eq!(again, read, "{:?} {:?}", given, angles(&read));
            prop_assert_eq!(angles(&again), angles(&read));
        }

        /// The error of a rotation from a quaternion, orthonormal to rounding, is at most 8ε, and the second round trip gives the same
        /// bits.
        #[test]
        fn any_rotation_is_met_within_rounding(q in [-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0_f64], pole in 0..3, exponent in -17..0) {
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            prop_assume!(length > 0.1);
            let [mut x, mut y, mut z, mut w] = q.map(|x| x / length);
            if pole > 0 {
                // Close to a pole: pitch = ±90°, where roll and yaw turn about one axis.
                let tilt = FRAC_PI_2 / 2.0 * if pole == 1 { 1.0 } else { -1.0 } + x * 10_f64.powi(exponent);
                let (sin, cos) = tilt.sin_cos();
                let (turn_sin, turn_cos) = (3.0 * y).sin_cos();
                [x, y, z, w] = [-turn_sin * sin, turn_cos * sin, turn_sin * cos, turn_cos * cos];
            }
            let r = [
                1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w),
                2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w),
                2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y),
            ];
            let read = rotation(angles(&r));
            prop_assert!(distance(&read, &r) <= 8.0 * f64::EPSILON, "{:e}", distance(&read, &r));
            prop_assert_eq!(rotation(angles(&read)), read);
        }
    }
}
