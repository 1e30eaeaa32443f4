//! Solids of even density: volume (m³), and moments of inertia per mass (m²) about the centre, in the solid's axes.

use std::f64::consts::PI;

/// Volume and principal moments per mass.
pub(crate) type Solid = (f64, [f64; 3]);

/// A box with these edges, m.
pub(crate) fn cuboid([x, y, z]: [f64; 3]) -> Solid {
    let (xx, yy, zz) = (x * x / 12.0, y * y / 12.0, z * z / 12.0);
    (x * y * z, [yy + zz, xx + zz, xx + yy])
}

/// A ball of this radius, m.
pub(crate) fn ball(r: f64) -> Solid {
    ellipsoid([r; 3])
}

/// An ellipsoid with these half axes, m.
pub(crate) fn ellipsoid([a, b, c]: [f64; 3]) -> Solid {
    let [aa, bb, cc] = [a, b, c].map(|x| 0.2 * x * x);
    (4.0 / 3.0 * PI * a * b * c, [bb + cc, aa + cc, aa + bb])
}

/// A cylinder along z, of radius and length, m.
pub(crate) fn cylinder(r: f64, l: f64) -> Solid {
    let across = r * r / 4.0 + l * l / 12.0;
    (PI * r * r * l, [across, across, r * r / 2.0])
}

/// A cylinder along z with half balls at its ends: radius, and length of the cylinder, m.
pub(crate) fn capsule(r: f64, l: f64) -> Solid {
    // The centres of mass of the half balls are 3r/8 beyond the cylinder's ends.
    let (middle, ends) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
    let ball = 0.4 * r * r + l * l / 4.0 + 3.0 / 8.0 * l * r;
    let across = (middle * (r * r / 4.0 + l * l / 12.0) + ends * ball) / (middle + ends);
    let along = (middle * r * r / 2.0 + ends * 0.4 * r * r) / (middle + ends);
    (middle + ends, [across, across, along])
}
