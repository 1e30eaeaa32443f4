//! A vector of one body in one register: x, y, z and an unused number.

use super::lanes::{LANES, Pack, from_lanes};
use featherbench_spatial::Vec3;
use wide::f64x4;

/// A vector; the fourth number means nothing.
pub(super) type Xyz = f64x4;

/// The register of a vector.
#[inline(always)]
pub(super) fn xyz(v: Vec3<f64>) -> Xyz {
    Xyz::new([v.x, v.y, v.z, 0.0])
}

/// The vector of a register.
#[inline(always)]
pub(super) fn vector(v: Xyz) -> Vec3<f64> {
    let [x, y, z, _] = v.to_array();
    Vec3::new(x, y, z)
}

/// `M v`, M by columns.
#[inline(always)]
pub(super) fn times([x, y, z]: [Xyz; 3], v: Vec3<f64>) -> Xyz {
    x.mul_add(Xyz::splat(v.x), y.mul_add(Xyz::splat(v.y), z * Xyz::splat(v.z)))
}

/// Vector product.
#[inline(always)]
pub(super) fn cross(a: Xyz, b: Xyz) -> Xyz {
    cycled(a.mul_sub(cycled(b), cycled(a) * b))
}

/// `a × b + c × d`.
#[inline(always)]
pub(super) fn two_crosses([a, b]: [Xyz; 2], [c, d]: [Xyz; 2]) -> Xyz {
    let first = a.mul_sub(cycled(b), cycled(a) * b);
    cycled(c.mul_add(cycled(d), (-cycled(c)).mul_add(d, first)))
}

/// y, z, x.
#[inline(always)]
fn cycled(v: Xyz) -> Xyz {
    let [x, y, z, rest] = v.to_array();
    Xyz::new([y, z, x, rest])
}

/// The vectors of a block's bodies, a register per component.
///
/// With eight lanes each register holds four bodies in its lower half and the next four in its upper half. The halves go the same way.
#[inline(always)]
pub(super) fn transposed(of: impl Fn(usize) -> Xyz) -> Vec3<Pack> {
    let body = |k: usize| {
        let groups: [[f64; 4]; LANES / 4] = std::array::from_fn(|group| of(4 * group + k).to_array());
        from_lanes(|i| groups[i / 4][i % 4]).to_array()
    };
    type Row = [f64; LANES];
    let xz = |a: &Row, b: &Row| from_lanes(|i| if i % 2 == 0 { a[i] } else { b[i - 1] }).to_array();
    let y = |a: &Row, b: &Row| from_lanes(|i| if i % 2 == 0 { a[i + 1] } else { b[i] }).to_array();
    let low = |a: &Row, b: &Row| from_lanes(|i| if i % 4 < 2 { a[i] } else { b[i - 2] });
    let high = |a: &Row, b: &Row| from_lanes(|i| if i % 4 < 2 { a[i + 2] } else { b[i] });
    let [b0, b1, b2, b3] = [body(0), body(1), body(2), body(3)];
    let (xz01, xz23) = (xz(&b0, &b1), xz(&b2, &b3));
    let (y01, y23) = (y(&b0, &b1), y(&b2, &b3));
    Vec3::new(low(&xz01, &xz23), low(&y01, &y23), high(&xz01, &xz23))
}
