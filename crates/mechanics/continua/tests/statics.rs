//! Equilibria: closed forms, and those that are not on the branch from rest.

use crate::beams::{links, rod};
use featherbench_continua::known::lumped_axial;
use featherbench_continua::{
    Assembly, Element, Hinges, Load, Rod, Settings, Status, Strain, equilibrium, judge, newton, residual, systems, tangent_stiffness,
};
use featherbench_model::{Description, Placement};
use std::f64::consts::PI;

#[test]
fn a_moment_of_2_pi_closes_a_circle_of_one_element() {
    for (count, strains) in [(1, vec![Strain::BendZ]), (3, vec![Strain::BendZ]), (1, Strain::ALL.to_vec())] {
        let element = Element::Sections { count, strains, points: 2 };
        let (beam, tip) = systems::cantilever(&rod(), &element).unwrap();
        let load = Load::moment(tip.body, [0.0, 0.0, 2.0 * PI]);
        // A dead moment on a rod that may leave the plane makes it buckle sideways first: these dofs are held.
        let planar = |dof: &usize| beam.topology().nv() % 6 != 0 || dof % 6 == Strain::BendZ.index();
        let held = (0..beam.topology().nv()).filter(|dof| !planar(dof)).collect();
        let found = equilibrium(&beam, &[load], &Settings { held, ..Settings::default() }).unwrap();
        assert_eq!(found.status, Status::Converged, "{element:?}");
        let place = beam.place(&found.s, &tip).unwrap();
        // A rounding of 2π, on a circle of radius 1/2π.
        assert!(place.translation.to_array().iter().all(|x| x.abs() < 1e-14), "{:?}", place.translation);
        assert!((place.rotation.to_array()[0] - 1.0).abs() < 1e-14);
    }
    // A chain of links is a polygon, and closes too: a turn of 2π in all.
    let (beam, tip) = systems::cantilever(&rod(), &links(6, Hinges::Middle)).unwrap();
    let found = equilibrium(&beam, &[Load::moment(tip.body, [0.0, 0.0, 2.0 * PI])], &Settings::default()).unwrap();
    assert!(found.s.iter().all(|angle| (angle - PI / 3.0).abs() < 1e-13));
}

#[test]
fn newton_without_load_steps_is_judged() {
    let alpha = 10.0;
    // The elastica itself has one equilibrium there: √10 is below 3.2, the smallest K(k) + F(φ₁, k). Four links have more.
    let (beam, tip) = systems::cantilever(&rod(), &links(4, Hinges::Middle)).unwrap();
    let load = [Load::force(tip.body, tip.placement.translation, [0.0, alpha, 0.0])];
    let settings = Settings { iterations: 200, ..Settings::default() };
    let branch = equilibrium(&beam, &load, &settings).unwrap();
    assert_eq!(branch.status, Status::Converged);
    assert!(branch.steps > 2);
    // From many starts: each end is the branch, or is called what it is. Starts are uniform curls.
    let (mut spurious, mut unstable, mut same) = (0, 0, 0);
    for curl in -12..=12 {
        let start = vec![0.125 * f64::from(curl); 4];
        let found = newton(&beam, &start, &load, &settings).unwrap();
        let far = found.s.iter().zip(&branch.s).any(|(a, b)| (a - b).abs() > 1e-6);
        match found.status {
            Status::Converged => {
                same += 1;
                assert!(!far);
            }
            Status::Spurious { distance, eigenvalue } => {
                spurious += 1;
                assert!(far && distance > 1e-6 && eigenvalue > 0.0);
            }
            Status::Unstable { eigenvalue, .. } => {
                unstable += 1;
                assert!(far && eigenvalue < 0.0);
            }
            Status::CapReached { .. } => continue,
        }
        // Whatever it is called, it is an equilibrium.
        assert!(residual(&beam, &found.s, &load).unwrap().amax() < 1e-9 * alpha);
    }
    println!("{same} on the branch, {spurious} on another, {unstable} unstable");
    assert!(spurious > 0 && unstable > 0 && same > 0);
    // From rest, as the page of known answers warns.
    let rest = newton(&beam, &beam.rest(), &load, &settings).unwrap();
    println!("from rest: {:?}", rest.status);
    assert_ne!(rest.status, Status::Converged);
    assert_eq!(judge(&beam, &branch.s, &load, &settings).unwrap(), Status::Converged);
}

#[test]
fn a_pressed_column_buckles_at_euler_s_load() {
    // P = π² EI/4L². With mid hinges k = EI/h: the column of springs buckles at 4 sin²(π/4n) EI/h², by the difference equation.
    let n = 6;
    let (column, tip) = systems::cantilever(&rod(), &links(n, Hinges::Middle)).unwrap();
    let euler = 4.0 * (PI / (4.0 * n as f64)).sin().powi(2) * (n * n) as f64;
    assert!((euler * 4.0 / (PI * PI) - 1.0).abs() < 0.01);
    assert!((euler - lumped_axial(n, 0, 1.0, 1.0).powi(2)).abs() < 1e-12, "the same difference equation as that of a bar");
    let press = |p: f64| {
        let load = Load::force(tip.body, tip.placement.translation, [-p, 0.0, 0.0]);
        equilibrium(&column, &[load], &Settings { first_step: 1.0, ..Settings::default() }).unwrap().status
    };
    assert_eq!(press(euler * (1.0 - 1e-9)), Status::Converged);
    assert!(matches!(press(euler * (1.0 + 1e-9)), Status::Unstable { eigenvalue, .. } if eigenvalue < 0.0));
}

#[test]
fn a_search_that_cannot_end_says_where_it_stopped() {
    let (beam, tip) = systems::cantilever(&rod(), &links(8, Hinges::Middle)).unwrap();
    let load = [Load::force(tip.body, tip.placement.translation, [0.0, 50.0, 0.0])];
    let found = equilibrium(&beam, &load, &Settings { steps: 2, first_step: 0.01, ..Settings::default() }).unwrap();
    assert!(matches!(found.status, Status::CapReached { load, residual } if load < 0.1 && residual > 1.0));
}

#[test]
fn a_heavy_rod_hangs_by_its_weight_and_a_held_joint_stays() {
    // A rod along x in gravity −z bends about y by ρA g L⁴/8EI.
    let rod = Rod::textbook(1.0, 1.0, 1.0).unwrap();
    let strains = vec![Strain::BendY, Strain::Twist];
    let gravity = [0.0, 0.0, -1e-4];
    let mut assembly = Assembly::new(Description { gravity, ..Description::default() });
    let tip = assembly.attach("rod", &rod, &Element::Sections { count: 12, strains, points: 3 }, None, Placement::default()).unwrap();
    let beam = assembly.build().unwrap();
    let found = equilibrium(&beam, &[], &Settings::default()).unwrap();
    let z = beam.place(&found.s, &tip).unwrap().translation.z;
    // By virtual work with constant curvatures: δ/δ_exact = 1 − O(1/n²).
    assert!((z / (-1e-4 / 8.0) - 1.0).abs() < 0.01, "{z}");
    let held = Settings { held: beam.elastic_dofs(), ..Settings::default() };
    let still = equilibrium(&beam, &[], &held);
    assert!(still.is_ok_and(|found| found.s.iter().all(|s| *s == 0.0)));
}

#[test]
fn the_tangent_is_the_derivative_and_symmetric() {
    let strains = Strain::ALL.to_vec();
    for element in
        [Element::Sections { count: 2, strains: strains.clone(), points: 2 }, Element::Links { count: 3, hinges: Hinges::Start, strains }]
    {
        let (beam, tip) = systems::cantilever(&rod(), &element).unwrap();
        let loads = [Load::force(tip.body, [0.0, 0.1, 0.0], [0.3, -0.2, 0.5])];
        let nv = beam.topology().nv();
        let s: Vec<f64> = (0..nv).map(|k| 0.2 * (1.0 + k as f64).sin()).collect();
        let tangent = tangent_stiffness(&beam, &s, &loads).unwrap();
        assert!((&tangent - tangent.transpose()).norm() < 1e-13 * tangent.norm(), "{element:?}");
        for j in 0..nv {
            let step = 1e-5;
            let moved = |by: f64| {
                let mut moved = s.clone();
                moved[j] += by;
                residual(&beam, &moved, &loads).unwrap()
            };
            // Central differences: an error of order 1e-10, and roundings of ε/1e-5.
            let difference = (moved(step) - moved(-step)) / (2.0 * step);
            assert!((difference - tangent.column(j)).amax() < 1e-8, "{element:?} {j}");
        }
    }
}
