//! The Delassus matrix by three routes, which agree with extended precision.

use crate::common::{EVERY_JOINT, assert_within, every_law, model, slack};
use featherbench_constrained::delassus::{by_factors, by_propagation, dense};
use featherbench_constrained::{Attachment, Constraint, Constraints, Rows};
use featherbench_dynamics::mass_matrix;
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::DoubleDouble;
use nalgebra::DMatrix;

/// Of the largest diagonal entry, as the design asks. The factors of M are those of a matrix that differs by roundings, so they lose up to
/// κ(M)·ε more: 1e-12 at κ = 4e5. Propagation loses nothing of that kind, because it does not form M.
const AGREEMENT: f64 = 1e-13;

fn extended(x: &[f64]) -> Vec<DoubleDouble> {
    x.iter().map(|x| DoubleDouble::from_sum(*x, 0.0)).collect()
}

/// The truth, with J and M in extended precision too.
fn truth(model: &Model<f64>, constraints: &Constraints, q: &[f64]) -> DMatrix<f64> {
    let q = extended(q);
    let mut rows = Rows::<DoubleDouble>::new(constraints);
    rows.run(model, constraints, &q, &extended(&vec![0.0; model.topology.nv()])).unwrap();
    dense(rows.jacobian(), &mass_matrix(model, &q).unwrap()).unwrap().map(DoubleDouble::to_f64)
}

fn agree(what: &str, model: &Model<f64>, constraints: &Constraints, q: &[f64]) {
    let due = truth(model, constraints, q);
    let scale = due.diagonal().max();
    let mut rows = Rows::new(constraints);
    rows.run(model, constraints, q, &vec![0.0; model.topology.nv()]).unwrap();
    let mass = mass_matrix(model, q).unwrap();
    let eigenvalues = DMatrix::from_fn(mass.size(), mass.size(), |i, j| mass.get(i, j)).symmetric_eigenvalues();
    let condition = eigenvalues.max() / eigenvalues.min();
    let factors = mass.into_ltdl().unwrap();
    let routes =
        [("factors", by_factors(rows.jacobian(), &factors).unwrap()), ("propagation", by_propagation(model, q, rows.rows()).unwrap())];
    for (route, found) in routes {
        let loss = if route == "factors" { condition * f64::EPSILON } else { 0.0 };
        assert_within(&format!("{what} by {route}"), (&found - &due).amax() / scale, (AGREEMENT + loss) * slack(constraints, &rows));
        assert_eq!(found, found.transpose());
    }
}

#[test]
fn three_routes_agree() {
    let mut cases = 0;
    let robots = ["humanoid", "quadruped", "hand", "chain:n=30", "tree:n=40", "binary_tree:depth=5"].map(|spec| (spec, 3, 9));
    for (spec, count, seed) in EVERY_JOINT.map(|spec| (spec, 12, 7)).into_iter().chain(robots) {
        let model = model(spec);
        let states = StateBatch::random(&model, count, seed);
        for k in 0..states.count() {
            agree(&format!("{spec} {k}"), &model, &every_law(&model, k as u64), states.q(k));
            cases += 1;
        }
    }
    assert_eq!(cases, 42);
}

/// A point mass that slides along x: G = 1/m, by hand.
#[test]
fn a_free_body_responds_by_its_mass_and_inertia() {
    let model = model("joints:kind=free,base=fixed,shape=single");
    let q = featherbench_model::neutral::<f64>(&model.topology);
    let inertia = model.inertias[0];
    let com = inertia.com().to_array();
    // Held at its centre of mass: G = 1/m, whatever the inertia.
    let held = Constraint::point("com", Attachment::world([0.0; 3]), Attachment::point(0, com));
    let constraints = Constraints::new(&model.topology, vec![held]).unwrap();
    let mut rows = Rows::new(&constraints);
    rows.run(&model, &constraints, &q, &[0.0; 6]).unwrap();
    let found = by_propagation(&model, &q, rows.rows()).unwrap();
    let due = DMatrix::identity(3, 3) / inertia.mass;
    // The inertia at the origin is that at the centre and m c², which cancel: a few roundings of 1/m.
    assert_within("1/m", (found - due).amax() * inertia.mass, 1e-14);
}
