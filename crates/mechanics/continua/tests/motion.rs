//! Dynamics of every element: M, its energy, conservation, damping, stiff steps.

use crate::beams::{links, rod};
use featherbench_continua::{
    Assembly, Basis, Continuum, Element, Hinges, Load, Masses, Material, Motion, Rod, Section, Solver, Strain, collocation, energies,
    library, mass_matrix, momentum, passivity,
};
use featherbench_dynamics::integrate::{DormandPrince, ImplicitMidpoint, Tolerance};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};
use featherbench_spatial::DoubleDouble;
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector};

/// A thick soft rod whose strains all matter, with this damping time.
fn soft(damping: f64) -> Rod {
    let material = Material { young: 60.0, poisson: 0.3, density: 1.0, damping };
    Rod::new(material, Section::rectangle(0.5, 0.7), 2.0).unwrap()
}

/// One of each kind.
fn elements() -> Vec<Element> {
    use Strain::{BendY, BendZ, Extension, Twist};
    let some = vec![Twist, BendY, BendZ, Extension];
    vec![
        Element::Links { count: 3, hinges: Hinges::Middle, strains: Strain::ALL.to_vec() },
        Element::Links { count: 2, hinges: Hinges::Start, strains: vec![BendZ, Twist] },
        Element::Links { count: 2, hinges: Hinges::StartStiffWall, strains: vec![BendY] },
        Element::Ritz { basis: Basis::Monomials(2), strains: some.clone() },
        Element::Ritz { basis: Basis::Modes(2), strains: vec![BendY, BendZ] },
        Element::Ritz { basis: Basis::Hermite(2), strains: some },
        Element::Sections { count: 2, strains: Strain::ALL.to_vec(), points: 3 },
        Element::Sections { count: 2, strains: vec![BendY, BendZ], points: 2 },
        Element::String { count: 3, masses: Masses::Uniform, planar: false },
    ]
}

/// A rod of this element that is clamped to a free hub and carries a body.
fn on_hub(element: &Element, damping: f64) -> Continuum {
    let (mut assembly, tip) = library::on_free_hub(1.5, 0.3, &soft(damping), element).unwrap();
    library::carry(&mut assembly, &tip, 0.4, 0.05);
    assembly.build().unwrap()
}

/// Numbers between −1 and 1.
fn numbers(count: usize, phase: f64) -> Vec<f64> {
    (0..count).map(|k| (12.9898 * (k as f64 + 1.0) + phase).sin()).collect()
}

/// A state away from rest, with a unit quaternion.
fn state(continuum: &Continuum, size: f64) -> (Vec<f64>, Vec<f64>) {
    let topology = continuum.topology();
    let step: Vec<f64> = numbers(topology.nv(), 0.3).iter().map(|x| size * x).collect();
    let s = featherbench_model::integrate(topology, &continuum.rest(), &step).unwrap();
    (s, numbers(topology.nv(), 1.7).iter().map(|x| size * x).collect())
}

#[test]
fn m_is_symmetric_positive_definite_and_the_kinetic_energy() {
    for element in elements() {
        let continuum = on_hub(&element, 0.0);
        let (s, rate) = state(&continuum, 0.3);
        let nv = rate.len();
        let mut solver = Solver::new(&continuum);
        let columns = DMatrix::from_fn(nv, nv, |i, j| {
            let (mut unit, mut column) = (vec![0.0; nv], vec![0.0; nv]);
            unit[j] = 1.0;
            solver.mass_times(&continuum, &s, &unit, &mut column).unwrap();
            column[i]
        });
        assert!((&columns - columns.transpose()).norm() < 1e-14 * columns.norm(), "{element:?}");
        let matrix = mass_matrix(&continuum, &s).unwrap();
        assert!(matrix.clone().cholesky().is_some(), "{element:?}");
        let v = DVector::from_vec(rate.clone());
        let kinetic = energies(&continuum, &s, &rate).unwrap().kinetic;
        assert!((0.5 * v.dot(&(matrix * &v)) / kinetic - 1.0).abs() < 1e-13, "{element:?}");
    }
}

#[test]
fn forward_dynamics_undoes_inverse_dynamics() {
    for element in elements() {
        let continuum = on_hub(&element, 0.02);
        let (s, rate) = state(&continuum, 0.3);
        let nv = rate.len();
        let second = numbers(nv, 2.9);
        let (mut tau, mut back) = (vec![0.0; nv], vec![0.0; nv]);
        let last = continuum.shape(&s).unwrap().len() - 1;
        let loads = [Load { follows: true, ..Load::force(last, [0.1, 0.0, 0.2], [0.3, 0.1, -0.2]) }, Load::moment(0, [0.1, 0.2, 0.3])];
        let mut solver = Solver::new(&continuum);
        solver.inverse(&continuum, &s, &rate, &second, &loads, &mut tau).unwrap();
        solver.forward(&continuum, &s, &rate, &tau, &loads, &mut back).unwrap();
        for (a, b) in second.iter().zip(&back) {
            // The condition of M, at most 1e5 here, times roundings.
            assert!((a - b).abs() < 1e-10, "{element:?}: {a} {b}");
        }
        // The same state in double-double: inverse dynamics is right to roundings.
        let wide = |x: &[f64]| x.iter().map(|x| DoubleDouble::from(*x)).collect::<Vec<_>>();
        let mut exact = wide(&tau);
        Solver::new(&continuum).inverse(&continuum, &wide(&s), &wide(&rate), &wide(&second), &loads, &mut exact).unwrap();
        let size = tau.iter().fold(0.0, |a: f64, b| larger(a, b.abs()));
        assert!(tau.iter().zip(&exact).all(|(a, b)| (a - b.to_f64()).abs() < 1e-14 * size), "{element:?}");
    }
}

/// The state after a time, with what was seen at each accepted step.
fn run(continuum: &Continuum, start: (Vec<f64>, Vec<f64>), time: f64, mut seen: impl FnMut(&[f64], &[f64])) -> (Vec<f64>, Vec<f64>) {
    let (mut s, mut rate) = start;
    let tolerance = Tolerance { absolute: 1e-11, relative: 1e-11, ..Tolerance::default() };
    let mut motion = Motion::new(continuum, |_| Vec::new());
    DormandPrince::new(continuum.topology())
        .run(&mut motion, [0.0, time], &mut s, &mut rate, &tolerance, |_, s, rate| seen(s, rate))
        .unwrap();
    (s, rate)
}

#[test]
fn energy_and_momentum_of_a_free_robot_are_conserved() {
    for element in elements() {
        let continuum = on_hub(&element, 0.0);
        let start = state(&continuum, 0.2);
        let total = |s: &[f64], rate: &[f64]| energies(&continuum, s, rate).map(|e| e.kinetic + e.potential).unwrap();
        let (before, energy) = (momentum(&continuum, &start.0, &start.1).unwrap(), total(&start.0, &start.1));
        let (s, rate) = run(&continuum, start, 0.2, |_, _| ());
        let after = momentum(&continuum, &s, &rate).unwrap();
        // The integrator's tolerance of 1e-11 per step over some hundred steps.
        assert!((total(&s, &rate) / energy - 1.0).abs() < 1e-8, "{element:?}");
        let difference = (after.momentum - before.momentum).to_array();
        assert!(difference.iter().all(|x| x.abs() < 1e-8), "{element:?}: {difference:?}");
    }
}

#[test]
fn damping_takes_energy_at_every_step_and_as_much_as_it_says() {
    for element in elements().into_iter().filter(|element| !matches!(element, Element::String { .. })) {
        let continuum = on_hub(&element, 0.02);
        let start = state(&continuum, 0.2);
        let total = |s: &[f64], rate: &[f64]| energies(&continuum, s, rate).map(|e| e.kinetic + e.potential).unwrap();
        let mut last = total(&start.0, &start.1);
        let first = last;
        run(&continuum, start.clone(), 0.2, |s, rate| {
            let now = total(s, rate);
            assert!(now <= last * (1.0 + 1e-13), "{element:?}");
            last = now;
        });
        assert!(last < 0.999 * first, "{element:?}");
        // dE/dt = −ẋᵀ D ẋ, by a short run there and back: central differences with an error of order h².
        let h = 1e-4;
        let energy_at = |time: f64| {
            let (s, rate) = run(&continuum, start.clone(), time, |_, _| ());
            total(&s, &rate)
        };
        let slope = (energy_at(h) - energy_at(-h)) / (2.0 * h);
        let power = continuum.dissipation(&start.1).unwrap();
        assert!((slope + power).abs() < 1e-3 * power, "{element:?}: {slope} {power}");
    }
}

#[test]
fn elements_are_passive_and_collocation_is_not() {
    for element in elements() {
        let continuum = on_hub(&element, 0.02);
        let (s, _) = state(&continuum, 0.3);
        let found = passivity(&mass_matrix(&continuum, &s).unwrap(), &continuum.stiffness_matrix(), &continuum.damping_matrix());
        assert!(found.passive(), "{element:?}: {found:?}");
    }
    for terms in 2..=5 {
        let (mass, stiffness) = collocation(&rod(), Basis::Monomials(terms)).unwrap();
        let found = passivity(&mass, &stiffness, &DMatrix::zeros(terms, terms));
        // Already the mass matrix gives energy below zero; K of s² and s³ is zero, since both have no fourth derivative.
        assert!(!found.passive() && found.smallest[0] < -1e-3 && found.asymmetry[0] > 0.1, "{terms}: {found:?}");
    }
    // NaN is never passive.
    let (one, nan) = (DMatrix::identity(1, 1), DMatrix::from_element(1, 1, f64::NAN));
    assert!(passivity(&one, &one, &one).passive() && !passivity(&one, &nan, &one).passive() && !passivity(&nan, &one, &one).passive());
}

#[test]
fn a_stiff_rod_takes_long_implicit_steps() {
    // Its fastest frequency is 2/h √(…) ≈ 3.5e5 rad/s: an explicit step is below 1e-5. Steps are 500 times as long.
    let rod = Rod::textbook(1e8, 1.0, 1.0).unwrap();
    let mut assembly = Assembly::new(Description { gravity: [0.0, -9.81, 0.0], ..Description::default() });
    let joint =
        JointDescription { name: "hinge".into(), kind: JointType::Revolute { axis: [0.0, 0.0, 1.0] }, ..JointDescription::default() };
    let inertia = [0.1, 0.0, 0.0, 0.1, 0.0, 0.1];
    let host = assembly.add(BodyDescription { name: "hub".into(), parent: None, mass: 1.0, com: [0.0; 3], inertia, joint });
    assembly.attach("rod", &rod, &links(4, Hinges::Middle), Some(host), Placement::default()).unwrap();
    let continuum = assembly.clone().build().unwrap();
    let mut motion = Motion::new(&continuum, |_| Vec::new());
    let mut midpoint = ImplicitMidpoint::with_derivatives(continuum.topology(), 0);
    let (mut s, mut rate) = (continuum.rest(), vec![0.0; continuum.topology().nv()]);
    let (h, steps) = (5e-3, 40);
    for step in 0..steps {
        midpoint.step_by_newton(&mut motion, h * f64::from(step), h, &mut s, &mut rate).unwrap();
    }
    // Beside the rigid pendulum.
    let model = featherbench_model::Model::<f64>::build(&assembly.rigid()).unwrap();
    let mut fall = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
        a.copy_from_slice(&featherbench_dynamics::forward_dynamics(&model, q, v, &[0.0])?);
        Ok(())
    };
    let (mut q, mut v) = ([0.0], [0.0]);
    DormandPrince::new(&model.topology)
        .run(&mut fall, [0.0, h * f64::from(steps)], &mut q, &mut v, &Tolerance::default(), |_, _, _| ())
        .unwrap();
    // The midpoint rule's error of order h², and deflections of 1e-7.
    assert!((s[0] - q[0]).abs() < 1e-4 && q[0].abs() > 0.1, "{} {}", s[0], q[0]);
}
