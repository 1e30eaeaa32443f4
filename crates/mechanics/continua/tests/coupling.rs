//! Rods on rigid bodies: a hub, a tip body, a humanoid; limits of heavy hubs and stiff rods.

use crate::beams::{links, ritz, rod, sections};
use featherbench_constrained::{Constrained, Kkt, Mechanism, Rows};
use featherbench_continua::known::cantilever_root;
use featherbench_continua::{
    Assembly, Basis, Continuum, Element, Hinges, Load, Motion, Rod, Solver, Strain, energies, generalized, library, mass_matrix, modes,
    momentum, rigid_limit,
};
use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
use featherbench_dynamics::{Aba, forward_dynamics};
use featherbench_model::{Loop, LoopEnd, LoopKind, LoopMotion, Model, Placement};
use featherbench_robots::Family;
use featherbench_spatial::{Counted, Vec3, larger};
use nalgebra::{DMatrix, SymmetricEigen};

fn bending() -> [Element; 3] {
    [links(16, Hinges::Middle), sections(12), ritz(Basis::Hermite(6))]
}

/// The positive frequencies of a rod on a free hub in its plane.
fn on_hub(element: &Element, mass: f64) -> Vec<f64> {
    let (assembly, _) = library::on_free_hub(mass, mass, &rod(), element).unwrap();
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
fn a_heavy_hub_is_a_wall() {
    for element in bending() {
        let (clamped, _) = library::cantilever(&rod(), &element).unwrap();
        let wall = modes(&clamped, &clamped.rest(), &[]).unwrap().frequencies()[0];
        let mut before = f64::INFINITY;
        for mass in [1e2, 1e4, 1e6] {
            let difference = on_hub(&element, mass)[0] / wall - 1.0;
            // The hub's share is of order 1/mass.
            assert!(difference > 0.0 && difference < before / 50.0 && difference * mass < 20.0, "{element:?} {mass}: {difference:e}");
            before = difference;
        }
        assert!((wall / cantilever_root(0).powi(2) - 1.0).abs() < 2e-3);
    }
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
            library::carry(&mut assembly, &tip, mu, 0.0);
            let beam = assembly.build().unwrap();
            let w = modes(&beam, &beam.rest(), &[]).unwrap().frequencies()[0];
            // Errors of the elements: β⁴/1440 n⁴ and about 1/4n².
            assert!((w / (beta * beta) - 1.0).abs() < tolerance, "{mu} {element:?}: {w} {}", beta * beta);
        }
    }
}

#[test]
fn stiff_rods_are_rigid_to_1e_10_until_rounding_says_no() {
    let mut held = 0;
    for (count, element) in
        [1, 4, 16].into_iter().flat_map(|n| [(n, links(n, Hinges::Middle)), (n, sections(n)), (n, ritz(Basis::Hermite(n)))])
    {
        let (mut assembly, tip) = library::on_free_hub(1.0, 0.2, &rod(), &element).unwrap();
        library::carry(&mut assembly, &tip, 0.5, 0.1);
        let (q, v) = ([0.1, 0.2, -0.3, 0.0, 0.0, 0.6, 0.8], [0.1, 0.2, 0.3, 0.4, -0.5, 0.6]);
        let tau = [1.0, -2.0, 0.5, 0.3, 0.7, -0.4];
        for factor in [1e3, 1e6, 1e9, 1e12] {
            let limit = rigid_limit(&assembly, factor, &q, &v, &tau).unwrap();
            // The deflection's share is some units of it, and rounding's is at most some hundred times the bound, which has K x alone.
            let bound = 20.0 * limit.deflection + 100.0 * limit.floor + 1e-13;
            assert!(limit.difference <= bound, "{element:?} {factor:e}: {:e} {:e}", limit.difference, limit.floor);
            println!("{count} {factor:e} {:e} floor {:e} deflection {:e}", limit.difference, limit.floor, limit.deflection);
            if factor == 1e12 {
                // Where the bound of rounding is above 1e-10, nothing is promised: it is for Hermite splines on 16 parts.
                assert!(limit.difference <= 1e-10 || limit.floor > 1e-10, "{element:?}");
                held += usize::from(limit.floor <= 1e-10);
            }
        }
    }
    assert_eq!(held, 8);
}

/// The momentum of a free flexible rod is the integral of the forces, whatever the discretisation.
#[test]
fn a_flying_rod_has_the_momentum_of_its_loads() {
    // After J. C. Simo and L. Vu-Quoc (1986): a free rod with a force and a moment at one end, which rise and fall as a triangle.
    let rod = Rod::textbook(100.0, 1.0, 10.0).unwrap();
    let pulse = |t: f64| {
        if t < 0.5 {
            2.0 * t
        } else if t < 1.0 {
            2.0 - 2.0 * t
        } else {
            0.0
        }
    };
    for element in [
        Element::Links { count: 4, hinges: Hinges::Middle, strains: vec![Strain::BendY, Strain::BendZ] },
        Element::Sections { count: 2, strains: vec![Strain::BendZ, Strain::BendY, Strain::Twist], points: 2 },
    ] {
        // The hub is a thin slice of the rod.
        let (assembly, tip) = library::on_free_hub(0.1, 0.1, &rod, &element).unwrap();
        let flying = assembly.build().unwrap();
        let (force, moment) = ([8.0, 1.0, 0.5], [0.0, 4.0, -8.0]);
        let at_tip = Load { moment, ..Load::force(tip.body, tip.placement.translation, force) };
        let topology = flying.topology();
        let (mut s, mut rate) = (flying.rest(), vec![0.0; topology.nv()]);
        // The angular momentum about the world's origin grows by m + p × f. The impulse of p × f is integrated beside, by Simpson's rule on
        // each step of equal length.
        let tolerance = Tolerance { absolute: 1e-10, relative: 1e-10, ..Tolerance::default() };
        let mut motion = Motion::new(&flying, |t| vec![at_tip.times(pulse(t))]);
        let mut method = DormandPrince::new(topology);
        let (steps, mut turned) = (200, Vec3::from_array([0.0; 3]));
        let h = 1.0 / f64::from(steps);
        let rate_of = |t: f64, s: &[f64]| {
            let place = flying.place(s, &tip).unwrap().translation;
            (Vec3::from_array(moment) + place.cross(Vec3::from_array(force))) * pulse(t)
        };
        for step in 0..steps {
            let t = h * f64::from(step);
            let first = rate_of(t, &s);
            method.run(&mut motion, [t, t + 0.5 * h], &mut s, &mut rate, &tolerance, |_, _, _| ()).unwrap();
            let middle = rate_of(t + 0.5 * h, &s);
            method.run(&mut motion, [t + 0.5 * h, t + h], &mut s, &mut rate, &tolerance, |_, _, _| ()).unwrap();
            turned += (first + middle * 4.0 + rate_of(t + h, &s)) * (h / 6.0);
        }
        let found = momentum(&flying, &s, &rate).unwrap();
        for (p, f) in found.momentum.lin.to_array().iter().zip(force) {
            // ∫ of the triangle is ½.
            assert!((p - 0.5 * f).abs() < 1e-8, "{element:?}: {p} {f}");
        }
        let about_origin = found.momentum.ang + found.center.position.cross(found.momentum.lin);
        for (l, known) in about_origin.to_array().iter().zip(turned.to_array()) {
            // Simpson's error of order h⁴ = 1e-9, times fourth derivatives.
            assert!((l - known).abs() < 1e-6, "{element:?}: {l} {known}");
        }
        assert!(energies(&flying, &s, &rate).unwrap().potential > 1e-3, "it bends");
    }
}

#[test]
fn links_on_a_humanoid_are_served_by_aba() {
    let mut assembly = Assembly::new(Family::parse("humanoid").unwrap().generate().unwrap());
    let hand = assembly.description().bodies.len() - 1;
    let element = Element::Links { count: 50, hinges: Hinges::Middle, strains: vec![Strain::BendY, Strain::BendZ] };
    assembly.attach("rod", &rod(), &element, Some(hand), Placement::default()).unwrap();
    let continuum = assembly.build().unwrap();
    assert!(continuum.is_direct());
    // ABA beside M⁻¹ by the sparse factorization of the reduced tree.
    let nv = continuum.topology().nv();
    let (tau, rate, s) = (vec![0.1; nv], vec![0.01; nv], continuum.rest());
    let (mut by_aba, mut rest) = (vec![0.0; nv], vec![0.0; nv]);
    let mut solver = Solver::new(&continuum);
    solver.forward(&continuum, &s, &rate, &tau, &[], &mut by_aba).unwrap();
    solver.inverse(&continuum, &s, &rate, &by_aba, &[], &mut rest).unwrap();
    // Residual beside the largest force that enters: |M| |a|.
    let size = by_aba.iter().fold(1.0, |a: f64, b| larger(a, b.abs()));
    assert!(rest.iter().zip(&tau).all(|(a, b)| (a - b).abs() < 1e-12 * size), "{rest:?}");
    let matrix = solver.mass(&continuum, &s).unwrap();
    let zeros = vec![0.0; nv];
    let mut bias = vec![0.0; nv];
    solver.inverse(&continuum, &s, &rate, &zeros, &[], &mut bias).unwrap();
    let mut by_factors: Vec<f64> = tau.iter().zip(&bias).map(|(tau, bias)| tau - bias).collect();
    matrix.into_ltdl().unwrap().solve(&mut by_factors).unwrap();
    assert!(by_factors.iter().zip(&by_aba).all(|(a, b)| (a - b).abs() < 1e-6 * size));
}

/// A humanoid with a rod of links at its last body.
fn humanoid_with(count: usize) -> (Assembly, Continuum) {
    let mut assembly = Assembly::new(Family::parse("humanoid").unwrap().generate().unwrap());
    let hand = assembly.description().bodies.len() - 1;
    assembly.attach("rod", &rod(), &links(count, Hinges::Middle), Some(hand), Placement::default()).unwrap();
    let continuum = assembly.clone().build().unwrap();
    (assembly, continuum)
}

/// What `examples/rod_on_humanoid.rs` times. The answers are those of ABA on the bodies' own model with the springs as forces. The
/// operations of ABA grow by the same number with each link.
#[test]
fn a_rod_on_a_humanoid_is_a_tree_and_costs_the_same_per_link() {
    let (assembly, continuum) = humanoid_with(30);
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
