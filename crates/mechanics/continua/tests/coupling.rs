//! Rods on rigid bodies: a light hub, a tip body, a humanoid, a loop. Heavy hubs, stiff rods and flying ones are cases of the study
//! `continuum`.

use crate::beams::{links, ritz, rod, sections};
use featherbench_constrained::{Constrained, Kkt, Mechanism, Rows};
use featherbench_continua::{Assembly, Basis, Continuum, Element, Hinges, Solver, generalized, mass_matrix, modes, systems};
use featherbench_dynamics::{Aba, forward_dynamics};
use featherbench_model::{Loop, LoopEnd, LoopKind, LoopMotion, Model, Placement};
use featherbench_robots::Family;
use featherbench_spatial::{Counted, larger};
use nalgebra::{DMatrix, SymmetricEigen};

/// The positive frequencies of a rod on a free hub in its plane.
fn on_hub(element: &Element, mass: f64) -> Vec<f64> {
    let (assembly, _) = systems::on_free_hub(mass, mass, &rod(), element).unwrap();
    let hub = assembly.build().unwrap();
    let squares = modes(&hub, &hub.rest(), &[]).unwrap().squares;
    // Six free motions have no frequency: their squares are roundings.
    assert!(squares.iter().filter(|square| square.abs() < 1e-9 * squares[squares.len() - 1]).count() >= 6);
    squares.into_iter().filter(|square| *square > 1e-6).map(f64::sqrt).collect()
}

/// The roots of a function in an interval, by bisection between signs on a grid.
fn first_root(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let (mut low, mut high) = (from, to);
    assert!(f(low) * f(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(low) * f(middle) <= 0.0 { high = middle } else { low = middle }
    }
    low
}

#[test]
fn a_light_hub_leaves_a_free_rod() {
    // Free at both ends: cos β cosh β = 1, β = 4.7300.
    let beta = first_root(|b| b.cos() * b.cosh() - 1.0, 4.0, 5.0);
    let w = on_hub(&ritz(Basis::Hermite(10)), 1e-9)[0];
    // Hermite's error β⁴/1440 n⁴ is 3.5e-5 and the next term a twentieth of it; the hub takes some 50 times its inertia.
    let law = beta.powi(4) / (1440.0 * 1e4);
    assert!((w / (beta * beta) - 1.0 - law).abs() < 0.1 * law, "{w}");
}

#[test]
fn a_body_at_the_tip_lowers_the_frequency_as_known() {
    // A point mass μ ρA L at the tip: 1 + cos β cosh β + μ β (cos β sinh β − sin β cosh β) = 0.
    for mu in [0.1, 1.0, 10.0] {
        let equation = |b: f64| 1.0 + b.cos() * b.cosh() + mu * b * (b.cos() * b.sinh() - b.sin() * b.cosh());
        let beta = first_root(equation, 0.3, 1.9);
        for (element, tolerance) in [(ritz(Basis::Hermite(8)), 1e-5), (sections(32), 5e-4), (links(32, Hinges::Middle), 5e-4)] {
            let mut assembly = Assembly::new(Default::default());
            let tip = assembly.attach("rod", &rod(), &element, None, Placement::default()).unwrap();
            systems::carry(&mut assembly, &tip, mu, 0.0);
            let beam = assembly.build().unwrap();
            let w = modes(&beam, &beam.rest(), &[]).unwrap().frequencies()[0];
            // Errors of the elements: β⁴/1440 n⁴ and about 1/4n².
            assert!((w / (beta * beta) - 1.0).abs() < tolerance, "{mu} {element:?}: {w} {}", beta * beta);
        }
    }
}

/// A humanoid with a rod of links at its last body.
fn humanoid_with(count: usize) -> (Assembly, Continuum) {
    let mut assembly = Assembly::new(Family::parse("humanoid").unwrap().generate().unwrap());
    let hand = assembly.description().bodies.len() - 1;
    assembly.attach("rod", &rod(), &links(count, Hinges::Middle), Some(hand), Placement::default()).unwrap();
    let continuum = assembly.clone().build().unwrap();
    (assembly, continuum)
}

/// The answers are those of ABA on the bodies' own model with the springs as forces. Its operations grow by the same number with each link.
#[test]
fn a_rod_on_a_humanoid_is_a_tree_and_costs_the_same_per_link() {
    let (assembly, continuum) = humanoid_with(30);
    assert!(continuum.is_direct());
    let model: Model<f64> = Model::build(assembly.description()).unwrap();
    let nv = continuum.topology().nv();
    let mut s = continuum.rest();
    let elastic = continuum.elastic_dofs();
    let first = s.len() - elastic.len();
    s[first..].iter_mut().enumerate().for_each(|(k, s)| *s = 0.1 * (1.0 + k as f64).sin());
    let rate: Vec<f64> = (0..nv).map(|k| 0.2 * (2.0 + k as f64).cos()).collect();
    let tau: Vec<f64> = (0..nv).map(|k| (3.0 + k as f64).sin()).collect();
    let mut second = vec![0.0; nv];
    Solver::new(&continuum).forward(&continuum, &s, &rate, &tau, &[], &mut second).unwrap();
    let stiffness = continuum.stiffness_matrix();
    let mut forces = tau.clone();
    for (i, dof) in elastic.iter().enumerate() {
        forces[*dof] -= stiffness[(*dof, *dof)] * s[first + i];
    }
    let known = forward_dynamics(&model, &s, &rate, &forces).unwrap();
    // The same recursions on the same tree: roundings of K x alone, which accelerations of light links enlarge.
    let size = known.iter().fold(0.0, |a: f64, b| larger(a, b.abs()));
    assert!(known.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-12 * size), "{known:?} {second:?}");

    let operations = [100, 200, 400].map(|count| {
        let (_, continuum) = humanoid_with(count);
        let (model, topology) = (continuum.model(), continuum.topology());
        let q: Vec<Counted> = continuum.rest().into_iter().map(Counted).collect();
        let zeros = vec![Counted(0.0); topology.nv()];
        let (mut aba, mut second) = (Aba::<Counted>::new(&model.topology), zeros.clone());
        let counted = Counted::count(|| aba.run(model, &q, &zeros, &zeros, None, &mut second).unwrap());
        counted.additions + counted.multiplications + counted.fused + counted.divisions
    });
    assert!(operations[0] > 0);
    assert_eq!(operations[2] - operations[1], 2 * (operations[1] - operations[0]), "{operations:?}");
}

/// A rod whose tip is tied to the world, but for sliding along the rod: the loop is closed by `featherbench_constrained`, with the springs
/// as forces.
#[test]
fn a_rod_that_closes_a_loop_vibrates_as_one_clamped_at_both_ends() {
    let beta = first_root(|b| b.cos() * b.cosh() - 1.0, 4.0, 5.0);
    let [coarse, fine] = [12, 24].map(|count| clamped_at_both_ends(count) / (beta * beta) - 1.0);
    // The midpoint rule: of order 2 with a next term of order 4, some 1/n² beside 4.
    assert!((coarse / fine - 4.0).abs() < 0.04, "{coarse:e} {fine:e}");
    assert!(((4.0 * fine - coarse) / 3.0).abs() < 1e-4, "{coarse:e} {fine:e}");
}

/// The first frequency of as many links.
fn clamped_at_both_ends(count: usize) -> f64 {
    let mut assembly = Assembly::new(Default::default());
    let tip = assembly.attach("rod", &rod(), &links(count, Hinges::Middle), None, Placement::default()).unwrap();
    // The loop's joint slides along its z, which is x here.
    let rotation = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let on_tip = LoopEnd { body: Some(tip.body), placement: Placement { rotation, ..tip.placement } };
    let on_world = LoopEnd { body: None, placement: Placement { rotation, translation: [1.0, 0.0, 0.0] } };
    assembly.tie(Loop { name: "clamp".into(), kind: LoopKind::Joint { ends: [on_world, on_tip], motion: LoopMotion::Prismatic } });
    let mechanism = Mechanism::of(assembly.description()).unwrap();
    let beam = assembly.build().unwrap();
    let nv = beam.topology().nv();

    // Vibrations in the null space of J.
    let mut rows = Rows::new(&mechanism.constraints);
    rows.run(&mechanism.model, &mechanism.constraints, &beam.rest(), &vec![0.0; nv]).unwrap();
    let jacobian = DMatrix::from_row_slice(rows.jacobian().len() / nv, nv, rows.jacobian());
    let eigen = SymmetricEigen::new(jacobian.transpose() * &jacobian);
    let free: Vec<usize> = (0..nv).filter(|k| eigen.eigenvalues[*k] < 1e-12).collect();
    assert_eq!(free.len(), nv - 2);
    let null = DMatrix::from_fn(nv, free.len(), |i, j| eigen.eigenvectors[(i, free[j])]);
    let (stiffness, mass) = (beam.stiffness_matrix(), mass_matrix(&beam, &beam.rest()).unwrap());
    let (squares, shapes) = generalized(&(null.transpose() * &stiffness * &null), &(null.transpose() * mass * &null)).unwrap();

    // A small deflection in that shape accelerates by −ω² of itself.
    let small = null * shapes.column(0) * 1e-7;
    let tau = -(stiffness * &small);
    let still = vec![0.0; nv];
    let mut closed = Constrained::new(&mechanism.model, &mechanism.constraints).unwrap();
    let solution = closed.run(small.as_slice(), &still, tau.as_slice(), &Kkt::default()).unwrap();
    let expected = &small * -squares[0];
    for (a, known) in solution.acceleration.iter().zip(expected.iter()) {
        // Terms of the second order of the deflection, and the condition of M, some n⁴.
        assert!((a - known).abs() < 1e-5 * expected.amax(), "{a:e} {known:e}");
    }
    squares[0].sqrt()
}
