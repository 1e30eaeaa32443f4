//! Constrained forward dynamics by three methods, against a dense solution of the KKT equations.

use crate::common::{EVERY_JOINT, assert_within, every_law, model};
use featherbench_constrained::{
    Attachment, Constrained, Constraint, Constraints, Error, Kkt, Law, Method, Outcome, Proximal, RangeSpace, Solution,
};
use featherbench_dynamics::{bias_force, forward_kinematics, mass_matrix};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
use featherbench_robots::StateBatch;
use nalgebra::{DMatrix, DVector};

/// The methods, with what they may miss of the largest number of an answer. KKT loses κ·ε, and κ of J is up to 10⁵ here;
/// range-space loses more, because G has the square of it.
/// The proximal method ends at a residual of 10⁻¹¹ of the terms, and λ is that divided by the least eigenvalue of G, down to 10⁻⁶.
fn methods() -> [(Box<dyn Method>, f64); 3] {
    let patient = Proximal { iterations: 20_000, ..Proximal::default() };
    [(Box::new(Kkt::default()), 1e-11), (Box::new(RangeSpace::default()), 1e-9), (Box::new(patient), 1e-5)]
}

/// M, h, J, J̇v in dense form.
struct Dense {
    mass: DMatrix<f64>,
    force: DVector<f64>,
    jacobian: DMatrix<f64>,
    bias: DVector<f64>,
}

fn form(model: &Model<f64>, constraints: &Constraints, q: &[f64], v: &[f64], tau: &[f64]) -> Dense {
    let n = model.topology.nv();
    let mass = mass_matrix(model, q).unwrap();
    let mut rows = featherbench_constrained::Rows::new(constraints);
    rows.run(model, constraints, q, v).unwrap();
    let force = DVector::from_column_slice(tau) - DVector::from_vec(bias_force(model, q, v).unwrap());
    Dense {
        mass: DMatrix::from_fn(n, n, |i, j| mass.get(i, j)),
        force,
        jacobian: DMatrix::from_row_slice(constraints.rows(), n, rows.jacobian()),
        bias: DVector::from_iterator(constraints.rows(), rows.biases()),
    }
}

impl Dense {
    /// v̇, Jᵀλ and the rank, by the singular values of `L⁻¹ Jᵀ` with `M = L Lᵀ`: those below `cut` of the largest count as zero.
    fn solve(&self, ask: &DVector<f64>, cut: f64) -> (DVector<f64>, DVector<f64>, usize) {
        let factor = self.mass.clone().cholesky().expect("M is positive definite");
        let lower = factor.l();
        let half = lower.solve_lower_triangular(&self.jacobian.transpose()).unwrap();
        let free = factor.solve(&self.force);
        let short = ask - &self.bias - &self.jacobian * &free;
        let svd = half.svd(true, true);
        let cut = cut * svd.singular_values.max();
        let (u, v) = (svd.u.as_ref().unwrap(), svd.v_t.as_ref().unwrap());
        let mut z = DVector::zeros(self.mass.nrows());
        let kept: Vec<usize> = (0..u.ncols()).filter(|k| svd.singular_values[*k] > cut).collect();
        for &k in &kept {
            z += u.column(k) * (v.row(k).transpose().dot(&short) / svd.singular_values[k]);
        }
        let force = &lower * z;
        (free + factor.solve(&force), force, kept.len())
    }
}

fn vector(x: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(x)
}

#[test]
fn methods_solve_the_dense_equations_on_every_joint() {
    let mut cases = 0;
    for spec in EVERY_JOINT {
        let model = model(spec);
        let states = StateBatch::random(&model, 6, 11);
        for k in 0..states.count() {
            let constraints = every_law(&model, 40 + k as u64);
            let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
            let dense = form(&model, &constraints, q, v, tau);
            // What some acceleration does is consistent, also where rows are redundant: bodies next to each other have fewer dofs than
            // rows.
            let ask = &dense.jacobian * vector(states.a(k)) + &dense.bias;
            let (acceleration, force, rank) = dense.solve(&ask, 1e-9);
            let mut dynamics = Constrained::new(&model, &constraints).unwrap();
            for (method, tolerance) in methods() {
                let equations = dynamics.equations(q, v, tau, |row, _, _| ask[row]).unwrap();
                let found = method.solve(&equations).unwrap();
                assert_eq!(method.solve(&equations).unwrap(), found, "a repeated call gives the same bits");
                assert_eq!(found.outcome, Outcome::Solved, "{}", method.name());
                let what = |of: &str| format!("{of} by {}, {spec} {k}", method.name());
                let error = (vector(&found.acceleration) - &acceleration).amax() / acceleration.amax();
                assert_within(&what("v̇"), error, tolerance);
                let error = (dense.jacobian.tr_mul(&vector(&found.multipliers)) - &force).amax() / force.amax();
                assert_within(&what("Jᵀλ"), error, tolerance);
                if method.name() != "proximal" {
                    assert_eq!(found.rank, Some(rank));
                }
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 36);
}

/// A foot on the ground by four points: 12 rows of rank 6. Two feet: 24 rows of rank 12; their normals are 8 rows of rank 6.
fn feet(model: &Model<f64>, q: &[f64], axes: [bool; 3]) -> Constraints {
    let still = vec![0.0; model.topology.nv()];
    let placed = forward_kinematics(model, q, &still, &still).unwrap();
    // The two tips farthest below: legs end there.
    let joints = model.topology.joints();
    let mut tips: Vec<usize> = (0..joints.len()).filter(|body| joints.iter().all(|joint| joint.parent != Some(*body))).collect();
    let height = |body: usize| placed.body(body).unwrap().placement.translation.z;
    tips.sort_by(|a, b| height(*a).total_cmp(&height(*b)));
    let mut list = Vec::new();
    for &foot in &tips[..2] {
        let place = placed.body(foot).unwrap().placement;
        for (k, corner) in [[0.12, 0.05], [0.12, -0.05], [-0.06, 0.05], [-0.06, -0.05]].into_iter().enumerate() {
            let second = Attachment::point(foot, [corner[0], corner[1], -0.03]);
            let first = Attachment::world(place.point(second.placement.translation).to_array());
            list.push(Constraint { name: format!("foot {foot} corner {k}"), law: Law::Point { first, second, axes } });
        }
    }
    Constraints::new(&model.topology, list).unwrap()
}

#[test]
fn two_feet_have_24_rows_of_rank_12() {
    let model = model("humanoid");
    let neutral = featherbench_model::neutral::<f64>(&model.topology);
    // Bent knees: legs that are stretched out are singular.
    let mut q = neutral;
    q[7..].iter_mut().enumerate().for_each(|(k, q)| *q = 0.1 + 0.05 * k as f64 % 0.3);
    let v = vec![0.0; model.topology.nv()];
    let tau: Vec<f64> = (0..v.len()).map(|k| (k as f64).sin()).collect();
    for (axes, rows, rank) in [([true; 3], 24, 12), ([false, false, true], 8, 6)] {
        let constraints = feet(&model, &q, axes);
        assert_eq!(constraints.rows(), rows);
        let mut dynamics = Constrained::new(&model, &constraints).unwrap();
        let solutions: Vec<Solution> = methods().iter().map(|(method, _)| dynamics.run(&q, &v, &tau, method.as_ref()).unwrap()).collect();
        assert_eq!(solutions[0].rank, Some(rank));
        assert_eq!(solutions[1].rank, Some(rank));
        // A second witness of the rank: singular values of J, which fall by ten powers at once.
        let dense = form(&model, &constraints, &q, &v, &tau);
        let mut singular: Vec<f64> = dense.jacobian.singular_values().iter().copied().collect();
        singular.sort_by(|a, b| b.total_cmp(a));
        assert!(singular[rank - 1] > 1e-3 * singular[0] && singular[rank] < 1e-14 * singular[0], "{singular:?}");
        let due = vector(&solutions[0].acceleration);
        for (solution, (method, tolerance)) in solutions.iter().zip(methods()) {
            assert_eq!(solution.outcome, Outcome::Solved);
            assert_within(method.name(), (vector(&solution.acceleration) - &due).amax() / due.amax(), tolerance);
            assert!(solution.imbalance < 1e-8 && solution.residual < 1e-8, "{} {solution:?}", method.name());
        }
    }
}

/// Corners of a rigid foot asked to separate: errors that name the corner, and the least-squares answer of the proximal method.
#[test]
fn contradictions_are_told() {
    let model = model("humanoid");
    let mut q = featherbench_model::neutral::<f64>(&model.topology);
    q[7..].iter_mut().for_each(|q| *q = 0.2);
    let v = vec![0.0; model.topology.nv()];
    let constraints = feet(&model, &q, [true; 3]);
    let ask = |row: usize| if row == 0 { 1.0 } else { 0.0 };
    let mut dynamics = Constrained::new(&model, &constraints).unwrap();
    let equations = dynamics.equations(&q, &v, &v, |row, _, _| ask(row)).unwrap();
    for method in [&Kkt::default() as &dyn Method, &RangeSpace::default()] {
        let error = method.solve(&equations).unwrap_err();
        assert!(matches!(&error, Error::Inconsistent { rank: 12, rows: 24, .. }), "{error}");
        assert!(error.to_string().contains("foot"), "{error}");
    }
    let found = Proximal::default().solve(&equations).unwrap();
    assert_eq!(found.outcome, Outcome::LeastSquares);
    assert!(found.mu.is_some_and(|mu| mu > 0.0) && found.iterations >= 1);
    // The least residual by singular values of J: what the rows cannot reach of what they are asked.
    let dense = form(&model, &constraints, &q, &v, &v);
    let asked = DVector::from_fn(24, |row, _| ask(row)) - &dense.bias;
    let svd = dense.jacobian.clone().svd(true, false);
    let u = svd.u.unwrap();
    let reached = (0..u.ncols()).filter(|k| svd.singular_values[*k] > 1e-10).fold(DVector::zeros(24), |sum, k| {
        let column = u.column(k).into_owned();
        sum + &column * column.dot(&asked)
    });
    let due = (&asked - reached).amax();
    assert!(due > 0.1, "{due}");
    assert_within("least squares", (found.residual - due).abs(), 1e-8);
}

#[test]
fn a_cap_is_not_an_answer() {
    let model = model("chain:n=6");
    let states = StateBatch::random(&model, 1, 2);
    let held = Constraint::point("tip", Attachment::world([0.1, 0.2, 0.3]), Attachment::point(5, [0.1, 0.0, 0.0]));
    let constraints = Constraints::new(&model.topology, vec![held]).unwrap();
    let mut dynamics = Constrained::new(&model, &constraints).unwrap();
    let mut run = |method: Proximal| dynamics.run(states.q(0), states.v(0), states.tau(0), &method);
    let slow = Proximal { mu: 10.0, iterations: 3, ..Proximal::default() };
    let found = run(slow).unwrap();
    assert_eq!((found.outcome, found.iterations), (Outcome::CapReached, 3));
    // With enough of them the same μ gets there: its rate is μ / (μ + σ).
    let found = run(Proximal { iterations: 100_000, ..slow }).unwrap();
    assert_eq!(found.outcome, Outcome::Solved);
    assert!(found.iterations > 10);
    for mu in [0.0, -1.0, f64::NAN] {
        assert!(matches!(run(Proximal { mu, ..slow }), Err(Error::Parameter { parameter: "mu", .. })), "{mu}");
    }
    assert!(run(Proximal { tolerance: f64::NAN, ..slow }).is_err());
}

/// No constraint: the methods give free forward dynamics, and constraints add no power.
#[test]
fn without_constraints_the_robot_falls_freely() {
    let model = model("quadruped");
    let states = StateBatch::random(&model, 2, 2);
    let constraints = Constraints::new(&model.topology, Vec::new()).unwrap();
    let mut dynamics = Constrained::new(&model, &constraints).unwrap();
    for k in 0..states.count() {
        let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
        let due = vector(&featherbench_dynamics::forward_dynamics(&model, q, v, tau).unwrap());
        for (method, _) in methods() {
            let found = dynamics.run(q, v, tau, method.as_ref()).unwrap();
            assert_within(method.name(), (vector(&found.acceleration) - &due).amax() / due.amax(), 1e-11);
        }
    }
}

/// Finite numbers whose products are not: refused, and no number is taken for an answer.
#[test]
fn overflow_is_refused() {
    let model = model("chain:n=4");
    let held = Constraint::point("tip", Attachment::world([0.1, 0.2, 0.3]), Attachment::point(3, [0.1, 0.0, 0.0]));
    let constraints = Constraints::new(&model.topology, vec![held]).unwrap();
    let mut dynamics = Constrained::new(&model, &constraints).unwrap();
    let q = [0.1, 0.2, 0.3, 0.4];
    for (method, _) in methods() {
        let found = dynamics.run(&q, &[1e200; 4], &[0.0; 4], method.as_ref());
        assert!(matches!(found, Err(Error::NotFinite { .. })), "{found:?}");
        let found = dynamics.run(&q, &[0.0; 4], &[f64::NAN; 4], method.as_ref());
        assert_eq!(found, Err(Error::NotFinite { what: "joint forces tau", index: 0 }));
        let found = dynamics.run(&q, &[0.0; 4], &[0.0; 3], method.as_ref());
        assert!(matches!(found, Err(Error::Dimension(_))));
    }
}

/// Two wheels with c₁ q₁ + c₂ q₂ = 0 and a torque on the first: q̈₁ = τ / (I₁ + (c₁/c₂)² I₂).
#[test]
fn a_gear_reflects_inertia_by_the_square_of_its_ratio() {
    let (first, second, torque, ratio) = (0.3, 0.7, 1.1, [2.0, -3.0]);
    let wheel = |name: &str, inertia: f64| BodyDescription {
        name: name.into(),
        parent: None,
        mass: 1.0,
        com: [0.0; 3],
        inertia: [inertia, 0.0, 0.0, inertia, 0.0, inertia],
        joint: JointDescription { kind: JointType::Revolute { axis: [0.0, 0.0, 1.0] }, ..JointDescription::default() },
    };
    let bodies = vec![wheel("first", first), wheel("second", second)];
    let model: Model<f64> = Model::build(&Description { bodies, ..Description::default() }).unwrap();
    let gear = Law::Gear { terms: vec![(0, ratio[0]), (1, ratio[1])], offset: 0.0 };
    let slope = -ratio[0] / ratio[1];
    let mimic = Law::Mimic { follower: 1, leader: 0, polynomial: [0.0, slope, 0.0, 0.0, 0.0] };
    let due = torque / (first + slope * slope * second);
    for law in [gear, mimic] {
        let constraints = Constraints::new(&model.topology, vec![Constraint { name: "gear".into(), law }]).unwrap();
        let mut dynamics = Constrained::new(&model, &constraints).unwrap();
        for (method, _) in methods() {
            let found = dynamics.run(&[0.0; 2], &[0.4, 0.4 * slope], &[torque, 0.0], method.as_ref()).unwrap();
            // One row: a few roundings; the proximal method ends at 10⁻¹¹ of them.
            let tolerance = if method.name() == "proximal" { 1e-10 } else { 1e-15 };
            assert_within(method.name(), (found.acceleration[0] - due).abs() / due, tolerance);
            assert_within(method.name(), (found.acceleration[1] - slope * due).abs() / due, tolerance);
            // What the row does to the second wheel is all that turns it.
            let force = second * slope * due;
            let row = match constraints.list()[0].law {
                Law::Gear { .. } => ratio[1],
                _ => 1.0,
            };
            assert_within("λ", (found.multipliers[0] * row - force).abs() / due, tolerance);
        }
    }
}
