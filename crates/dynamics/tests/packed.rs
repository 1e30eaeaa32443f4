//! The packed kernels against the other text of each algorithm, on every kind of joint and tree.

use crate::common;

use common::{ROBOTS, build, distance, largest, within, wrenches};
use featherbench_dynamics::{Aba, Bias, Crba, PackedAba, PackedCrba, PackedModel, PackedRnea, Rnea, TreeSparse};
use featherbench_model::{Description, Model};
use featherbench_robots::{Family, StateBatch};

/// Recipes of every kind of joint; trees whose segments are short, long, and cross the ends of registers.
fn robots() -> Vec<(String, Model<f64>)> {
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
