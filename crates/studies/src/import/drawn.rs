//! A robot as it is drawn: placements at the neutral configuration, and the ellipsoids of its inertias.

use featherbench_bench::Robot;
use featherbench_dynamics::forward_kinematics;
use featherbench_model::neutral;
use featherbench_results::{Drawing, DrawnBody};
use featherbench_spatial::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// A robot with more bodies is not drawn: the bodies could not be told apart.
const MOST: usize = 200;

/// The drawing of a robot; `None` if it has too many bodies or none.
pub fn drawing(robot: &Robot) -> Option<Drawing> {
    let (bodies, model) = (&robot.description.bodies, &robot.model);
    if bodies.is_empty() || bodies.len() > MOST {
        return None;
    }
    let q = neutral(&model.topology);
    let zero = vec![0.0; model.topology.nv()];
    let kinematics = forward_kinematics(model, &q, &zero, &zero).ok()?;
    let of = |(body, &compiled): (&featherbench_model::BodyDescription, &usize)| {
        let place = kinematics.body(compiled)?.placement;
        let world = |x: [f64; 3]| rounded((place.rotation * Vec3::from_array(x) + place.translation).to_array());
        let turned = |x: [f64; 3]| rounded((place.rotation * Vec3::from_array(x)).to_array());
        Some(DrawnBody {
            name: body.name.clone(),
            parent: body.parent,
            mass: body.mass,
            origin: world([0.0; 3]),
            centre: world(body.com),
            axes: half_axes(body.mass, body.inertia).map(turned),
        })
    };
    bodies.iter().zip(&model.described).map(of).collect::<Option<_>>().map(Drawing)
}

/// The half axes of the solid ellipsoid of this mass and inertia about its centre: I₁ = m (b² + c²)/5 and so on, thus a² = 5 (I₂ + I₃ − I₁)/2m.
fn half_axes(mass: f64, [xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [[f64; 3]; 3] {
    let eigen = SymmetricEigen::new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
    let trace = xx + yy + zz;
    std::array::from_fn(|k| {
        let square = 5.0 * (trace - 2.0 * eigen.eigenvalues[k]) / (2.0 * mass);
        let length = if square.is_finite() && square > 0.0 { square.sqrt() } else { 0.0 };
        let axis = eigen.eigenvectors.column(k);
        [axis[0] * length, axis[1] * length, axis[2] * length]
    })
}

/// To a hundredth of a millimetre: a drawing shows no more.
fn rounded(x: [f64; 3]) -> [f64; 3] {
    x.map(|x| (x * 1e5).round() / 1e5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ellipsoid_of_a_box_and_of_what_cannot_exist() {
        // A solid ellipsoid of half axes 1, 2, 3 and 5 kg: I = (4 + 9, 1 + 9, 1 + 4).
        let found = half_axes(5.0, [13.0, 0.0, 0.0, 10.0, 0.0, 5.0]);
        let mut lengths = found.map(|axis| axis.iter().map(|x| x * x).sum::<f64>().sqrt());
        lengths.sort_by(f64::total_cmp);
        for (length, due) in lengths.into_iter().zip([1.0, 2.0, 3.0]) {
            assert!((length - due).abs() < 1e-12, "a few roundings of numbers near one: {length}");
        }
        for (mass, inertia) in [(0.0, [0.0; 6]), (1.0, [1.0, 0.0, 0.0, 1.0, 0.0, 5.0])] {
            let found = half_axes(mass, inertia);
            assert!(found.iter().flatten().all(|x| x.is_finite()), "{found:?}");
            assert!(found.contains(&[0.0; 3]), "no body has these: {found:?}");
        }
    }
}
