//! The packed kernels against the other text of each algorithm, on every kind of joint and tree.

use crate::common;

use common::{ROBOTS, build, distance, dyadic_chain, largest, within, wrenches};
use featherbench_dynamics::{
    Aba, Bias, Crba, DimensionError, Error, NotPositiveDefinite, PackedAba, PackedCrba, PackedModel, PackedRnea, Rnea, TreeSparse,
};
use featherbench_model::{Description, Model};
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::{Force, RigidBodyInertia, Vec3};

/// Recipes of every kind of joint; trees whose segments are short, long, and cross the ends of registers.
pub fn robots() -> Vec<(String, Model<f64>)> {
    let families =
        ["chain:n=1", "chain:n=9,layout=spatial", "chain:n=36,layout=spatial", "binary_tree", "star", "humanoid", "quadruped", "hand"];
    let generated = families.iter().filter_map(|spec| {
        let description: Description = Family::parse(spec).ok()?.generate().ok()?;
        Some((spec.to_string(), Model::build(&description).ok()?))
    });
    let recipes = ROBOTS.iter().map(|(name, recipe)| (name.to_string(), build(recipe)));
    recipes.chain(generated).collect()
}

#[test]
fn inverse_dynamics_is_that_of_the_other_text() {
    for (name, model) in robots() {
        let packed = PackedModel::new(&model);
        let (mut rnea, mut other) = (PackedRnea::new(&packed), Rnea::new(&model.topology));
        let states = StateBatch::random(&model, 4, 5);
        let wrenches = wrenches(&model, 3);
        let (mut tau, mut expected) = (vec![f64::NAN; model.topology.nv()], vec![0.0; model.topology.nv()]);
        for k in 0..states.count() {
            for wrenches in [None, Some(&wrenches[..])] {
                rnea.run(&packed, states.q(k), states.v(k), states.a(k), wrenches, &mut tau).unwrap();
                other.run(&model, states.q(k), states.v(k), states.a(k), wrenches, &mut expected).unwrap();
                within(&format!("{name}: ID"), distance(&tau, &expected) / largest(&expected), 1e-13);
                rnea.bias(&packed, states.q(k), states.v(k), wrenches, &mut tau).unwrap();
                Bias::new(&model.topology).run(&model, states.q(k), states.v(k), wrenches, &mut expected).unwrap();
                within(&format!("{name}: h"), distance(&tau, &expected) / largest(&expected), 1e-13);
            }
        }
    }
}

#[test]
fn forward_dynamics_is_that_of_the_other_text() {
    for (name, model) in robots() {
        let packed = PackedModel::new(&model);
        let (mut aba, mut other) = (PackedAba::new(&packed), Aba::new(&model.topology));
        let states = StateBatch::random(&model, 4, 5);
        let wrenches = wrenches(&model, 3);
        let (mut a, mut expected) = (vec![f64::NAN; model.topology.nv()], vec![0.0; model.topology.nv()]);
        for k in 0..states.count() {
            for wrenches in [None, Some(&wrenches[..])] {
                aba.run(&packed, states.q(k), states.v(k), states.tau(k), wrenches, &mut a).unwrap();
                other.run(&model, states.q(k), states.v(k), states.tau(k), wrenches, &mut expected).unwrap();
                within(&format!("{name}: FD"), distance(&a, &expected) / largest(&expected), 1e-12);
            }
        }
    }
}

#[test]
fn the_mass_matrix_is_that_of_the_other_text() {
    for (name, model) in robots() {
        let packed = PackedModel::new(&model);
        let (mut crba, mut other) = (PackedCrba::new(&packed), Crba::new(&model.topology));
        let (mut matrix, mut expected) = (TreeSparse::new(&model.topology), TreeSparse::new(&model.topology));
        let states = StateBatch::random(&model, 4, 5);
        for k in 0..states.count() {
            matrix.values_mut().fill(f64::NAN);
            crba.run(&packed, states.q(k), &mut matrix).unwrap();
            other.run(&model, states.q(k), &mut expected).unwrap();
            let root: Vec<f64> = expected.diagonal().map(f64::sqrt).collect();
            for i in 0..model.topology.nv() {
                for &j in model.topology.row_dofs(i) {
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
