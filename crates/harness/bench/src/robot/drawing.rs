//! Robots as they are drawn: placements at the neutral configuration, and the ellipsoids of their inertias.

use crate::Robot;
use featherbench_dynamics::forward_kinematics;
use featherbench_model::{BodyDescription, neutral};
use featherbench_results::{Drawing, DrawnBody};
use featherbench_spatial::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};
use std::collections::{BTreeMap, BTreeSet};

/// The drawing of a robot; `None` if it has too many bodies or none, or if a placement is not finite.
pub fn of(robot: &Robot) -> Option<Drawing> {
    let (bodies, model) = (&robot.description.bodies, &robot.model);
    if bodies.is_empty() || bodies.len() > Drawing::MOST_BODIES {
        return None;
    }
    let q = neutral(&model.topology);
    let zero = vec![0.0; model.topology.nv()];
    let kinematics = forward_kinematics(model, &q, &zero, &zero).ok()?;
    let of = |(body, &compiled): (&BodyDescription, &usize)| {
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
    let drawing = bodies.iter().zip(&model.described).map(of).collect::<Option<_>>().map(Drawing)?;
    drawing.is_finite().then_some(drawing)
}

/// The drawings that a run keeps, by robot: first those of the robots in `first`, then those of the others in their order, until they have
/// [`Drawing::MOST_BYTES`]. The number is that of the drawings that are left out for it.
///
/// Robots and rows alone decide, so a run that is merged from shards has the same file as that of one process.
pub fn of_run(robots: &[Robot], first: &BTreeSet<&str>) -> (BTreeMap<String, Drawing>, usize) {
    of_run_within(robots, first, Drawing::MOST_BYTES)
}

fn of_run_within(robots: &[Robot], first: &BTreeSet<&str>, most: usize) -> (BTreeMap<String, Drawing>, usize) {
    let (before, behind): (Vec<&Robot>, Vec<&Robot>) = robots.iter().partition(|robot| first.contains(robot.name.as_str()));
    let (mut drawings, mut bytes, mut left_out) = (BTreeMap::new(), 0, 0);
    for robot in before.into_iter().chain(behind) {
        let Some(drawing) = of(robot) else { continue };
        bytes += size(&robot.name, &drawing);
        if bytes > most {
            left_out += 1;
        } else {
            drawings.insert(robot.name.clone(), drawing);
        }
    }
    (drawings, left_out)
}

/// The bytes of a drawing and its name in the file of drawings.
fn size(name: &str, drawing: &Drawing) -> usize {
    serde_json::to_string(&(name, drawing)).map_or(0, |text| text.len())
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
    use featherbench_results::ModelOrigin;

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

    #[test]
    fn robots_of_findings_are_drawn_first_and_what_is_too_much_is_counted() {
        let robot = |name: &str, bodies: usize| {
            let chain = featherbench_robots::Family::parse(&format!("chain:n={bodies}")).unwrap().generate().unwrap();
            let description = featherbench_model::Description { name: name.into(), ..chain };
            Robot::new(&description, "chain", ModelOrigin::Generated, 1, 1).unwrap()
        };
        let robots = [robot("a", 3), robot("b", 3), robot("long", Drawing::MOST_BODIES + 1), robot("c", 3)];
        let names = |drawings: BTreeMap<String, Drawing>| drawings.into_keys().collect::<Vec<_>>();
        let (all, left_out) = of_run(&robots, &BTreeSet::new());
        assert_eq!((all["a"].0.len(), left_out), (3, 0));
        // All three have the same bytes.
        let one = size("a", &all["a"]);
        assert_eq!(names(all), ["a", "b", "c"], "too many bodies cannot be told apart");
        let (some, left_out) = of_run_within(&robots, &BTreeSet::from(["c"]), 2 * one);
        assert_eq!((names(some), left_out), (vec!["a".to_owned(), "c".to_owned()], 1));
    }
}
