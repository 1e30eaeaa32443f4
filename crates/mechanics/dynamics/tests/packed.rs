//! The packed kernels against the other text of each algorithm, on every kind of joint and tree.

use crate::common;

use common::{ROBOTS, build, distance, dyadic_chain, generated, largest, within, wrenches};
use featherbench_dynamics::{
    Aba, Bias, Crba, DimensionError, Error, NotPositiveDefinite, PackedAba, PackedCrba, PackedModel, PackedRnea, Rnea, TreeSparse,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Force, RigidBodyInertia, Vec3};

/// Recipes of every kind of joint; trees whose segments are short, long, and cross the ends of registers.
pub fn robots() -> Vec<(String, Model<f64>)> {
    let families =
        ["chain:n=1", "chain:n=9,layout=spatial", "chain:n=36,layout=spatial", "binary_tree", "star", "humanoid", "quadruped", "hand"];
    let recipes = ROBOTS.iter().map(|(name, recipe)| (name.to_string(), build(recipe)));
    recipes.chain(families.iter().map(|spec| (spec.to_string(), generated(spec)))).collect()
}

#[test]
fn dynamics_is_that_of_the_other_text() {
    for (name, model) in robots() {
        let (t, packed) = (&model.topology, PackedModel::new(&model));
        let (mut rnea, mut aba, mut crba) = (PackedRnea::new(&packed), PackedAba::new(&packed), PackedCrba::new(&packed));
        let (states, wrenches) = (StateBatch::random(&model, 4, 5), wrenches(&model, 3));
        let (mut matrix, mut expected) = (TreeSparse::new(t), TreeSparse::new(t));
        for k in 0..states.count() {
            let (q, v, a, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
            for f in [None, Some(&wrenches[..])] {
                let compare = |what: &str, tolerance: f64, packed: &mut dyn FnMut(&mut [f64]), other: &mut dyn FnMut(&mut [f64])| {
                    let (mut found, mut expected) = (vec![f64::NAN; t.nv()], vec![0.0; t.nv()]);
                    packed(&mut found);
                    other(&mut expected);
                    within(&format!("{name}: {what}"), distance(&found, &expected) / largest(&expected), tolerance);
                };
                compare("ID", 1e-13, &mut |tau| rnea.run(&packed, q, v, a, f, tau).unwrap(), &mut |tau| {
                    Rnea::new(t).run(&model, q, v, a, f, tau).unwrap();
                });
                compare("h", 1e-13, &mut |h| rnea.bias(&packed, q, v, f, h).unwrap(), &mut |h| {
                    Bias::new(t).run(&model, q, v, f, h).unwrap();
                });
                compare("FD", 1e-12, &mut |a| aba.run(&packed, q, v, tau, f, a).unwrap(), &mut |a| {
                    Aba::new(t).run(&model, q, v, tau, f, a).unwrap();
                });
            }
            matrix.values_mut().fill(f64::NAN);
            crba.run(&packed, q, &mut matrix).unwrap();
            Crba::new(t).run(&model, q, &mut expected).unwrap();
            let root: Vec<f64> = expected.diagonal().map(f64::sqrt).collect();
            for i in 0..t.nv() {
                for &j in t.row_dofs(i) {
                    let residual = (matrix.get(i, j) - expected.get(i, j)).abs() / (root[i] * root[j]);
                    within(&format!("{name}: M[{i}, {j}]"), residual, 1e-14);
                }
            }
        }
    }
}

#[test]
fn a_base_far_away_costs_no_digits() {
    let near = dyadic_chain(&[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], 20);
    let mut far = near.clone();
    far.placements[0].translation = Vec3::new(1e6, -1e6, 3e5);
    let (near, far) = (PackedModel::new(&near), PackedModel::new(&far));
    let states = StateBatch::random(&dyadic_chain(&[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], 20), 3, 2);
    let of = |model: &PackedModel, k: usize| {
        let (mut tau, mut a, mut matrix) = (vec![0.0; 20], vec![0.0; 20], TreeSparse::new(model.topology()));
        PackedRnea::new(model).run(model, states.q(k), states.v(k), states.a(k), None, &mut tau).unwrap();
        PackedAba::new(model).run(model, states.q(k), states.v(k), states.tau(k), None, &mut a).unwrap();
        PackedCrba::new(model).run(model, states.q(k), &mut matrix).unwrap();
        (tau, a, matrix.values().to_vec())
    };
    for k in 0..states.count() {
        assert_eq!(of(&near, k), of(&far, k), "no position of the world appears");
    }
}

#[test]
fn a_workspace_keeps_nothing_of_the_model_and_state_before() {
    let models: Vec<Model<f64>> = [[0.0, 0.0, -9.0], [1.0, 2.0, 3.0]]
        .into_iter()
        .map(|gravity| Model { gravity: Vec3::from_array(gravity), ..build(&ROBOTS[7].1) })
        .collect();
    let packed: Vec<PackedModel> = models.iter().map(PackedModel::new).collect();
    let states = StateBatch::random(&models[0], 2, 9);
    let run = |rnea: &mut PackedRnea, aba: &mut PackedAba, m: usize, k: usize| {
        let mut out = [vec![0.0; states.nv], vec![0.0; states.nv]];
        rnea.run(&packed[m], states.q(k), states.v(k), states.a(k), None, &mut out[0]).unwrap();
        aba.run(&packed[m], states.q(k), states.v(k), states.tau(k), None, &mut out[1]).unwrap();
        out
    };
    let (mut rnea, mut aba) = (PackedRnea::new(&packed[0]), PackedAba::new(&packed[0]));
    for (m, k) in [(0, 0), (1, 1), (0, 1), (1, 0), (0, 0)] {
        let fresh = run(&mut PackedRnea::new(&packed[m]), &mut PackedAba::new(&packed[m]), m, k);
        assert_eq!(run(&mut rnea, &mut aba, m, k), fresh, "model {m}, state {k}");
    }
}

#[test]
fn each_argument_of_the_wrong_length_is_named() {
    let model = PackedModel::new(&build(&ROBOTS[7].1));
    let (nq, nv, bodies) = (model.topology().nq(), model.topology().nv(), model.topology().bodies());
    let (q, x, short, few) = (vec![0.5; nq], vec![0.5; nv], vec![0.5; nv - 1], vec![Force::zero(); bodies - 1]);
    let (mut out, mut short_out) = (vec![0.0; nv], vec![0.0; nv - 1]);
    let mut rnea = PackedRnea::new(&model);
    let named = |error: Result<(), DimensionError>| error.map_err(|error| error.what).unwrap_err();
    assert_eq!(named(rnea.run(&model, &x, &x, &x, None, &mut out)), "configuration q");
    assert_eq!(named(rnea.run(&model, &q, &short, &x, None, &mut out)), "velocity v");
    assert_eq!(named(rnea.run(&model, &q, &x, &short, None, &mut out)), "acceleration a");
    assert_eq!(named(rnea.run(&model, &q, &x, &x, None, &mut short_out)), "joint forces tau");
    assert_eq!(named(rnea.run(&model, &q, &x, &x, Some(&few), &mut out)), "external wrenches");
    assert_eq!(named(rnea.bias(&model, &q, &x, None, &mut short_out)), "bias force h");
    assert_eq!(named(PackedCrba::new(&model).run(&model, &x, &mut TreeSparse::new(model.topology()))), "configuration q");
    let aba = |tau: &[f64], a: &mut [f64]| match PackedAba::new(&model).run(&model, &q, &x, tau, None, a) {
        Err(Error::Dimension(error)) => error.what,
        other => panic!("{other:?}"),
    };
    assert_eq!((aba(&short, &mut out), aba(&x, &mut short_out)), ("joint forces tau", "acceleration a"));
    let other = PackedModel::new(&dyadic_chain(&[[0.0, 1.0, 0.0]], 40));
    assert_eq!(named(PackedRnea::new(&other).run(&model, &q, &x, &x, None, &mut out)), "blocks of the workspace");
}

#[test]
fn a_massless_tip_is_named() {
    let mut model = dyadic_chain(&[[0.0, 1.0, 0.0]], 3);
    model.inertias[2] = RigidBodyInertia::zero();
    let (packed, zero, mut a) = (PackedModel::new(&model), [0.0; 3], [0.0; 3]);
    let error = PackedAba::new(&packed).run(&packed, &zero, &zero, &zero, None, &mut a).unwrap_err();
    assert_eq!(error, Error::NotPositiveDefinite(NotPositiveDefinite { dof: 2, pivot: 0.0 }));
    // Armature is inertia enough.
    model.armature[2] = 0.1;
    let packed = PackedModel::new(&model);
    assert!(PackedAba::new(&packed).run(&packed, &zero, &zero, &zero, None, &mut a).is_ok());
}
