//! A vector of one body in one register: x, y, z and an unused number.

use super::lanes::{LANES, Pack};
use super::rotate::joined;
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
#[inline(always)]
pub(super) fn transposed(of: impl Fn(usize) -> Xyz) -> Vec3<Pack> {
    let parts: [[Xyz; 4]; LANES / 4] = std::array::from_fn(|part| Xyz::transpose(std::array::from_fn(|k| of(4 * part + k))));
    let component = |row: usize| joined(std::array::from_fn(|part| parts[part][row]));
    Vec3::new(component(0), component(1), component(2))
}
