//! Structure as integers: what tree-sparse matrices store, what a factorization executes, and that the cost of recursions is linear.

use crate::common;

use common::{dyadic_chain, lifted, topology, within};
use featherbench_dynamics::{Aba, Bias, Ltdl, NotPositiveDefinite, Rnea, TreeSparse, mass_matrix};
use featherbench_model::{Axis, JointKind, Model, Topology};
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::{Counted, Operations, Real};
use nalgebra::DMatrix;

use JointKind::Free;

const REVOLUTE: JointKind = JointKind::Revolute(Axis::Z);

fn chain(n: i64) -> Vec<(i64, JointKind)> {
    (0..n).map(|i| (i - 1, REVOLUTE)).collect()
}

/// Adds `n` revolute bodies in a chain below `parent`; returns the last.
fn limb(tree: &mut Vec<(i64, JointKind)>, parent: i64, n: usize) -> i64 {
    (0..n).fold(parent, |parent, _| {
        tree.push((parent, REVOLUTE));
        tree.len() as i64 - 1
    })
}

fn base_with_limbs(limbs: usize, n: usize) -> Vec<(i64, JointKind)> {
    let mut tree = vec![(-1, Free)];
    for _ in 0..limbs {
        limb(&mut tree, 0, n);
    }
    tree
}

fn humanoid() -> Vec<(i64, JointKind)> {
    let mut tree = base_with_limbs(2, 6);
    let torso = limb(&mut tree, 0, 3);
    for arm_or_head in [7, 7, 1] {
        limb(&mut tree, torso, arm_or_head);
    }
    tree
}

fn binary(depth: u32) -> Vec<(i64, JointKind)> {
    fn grow(tree: &mut Vec<(i64, JointKind)>, parent: i64, depth: u32) {
        if depth > 0 {
            let body = limb(tree, parent, 1);
            grow(tree, body, depth - 1);
            grow(tree, body, depth - 1);
        }
    }
    let mut tree = Vec::new();
    grow(&mut tree, -1, depth);
    tree
}

/// Known counts: tree, n, n + D1, D1, D2.
fn table() -> Vec<(&'static str, Topology, [u64; 4])> {
    let tree = |tree: Vec<_>| topology(&tree);
    vec![
        ("chain 30", tree(chain(30)), [30, 465, 435, 4495]),
        ("chain 36", tree(chain(36)), [36, 666, 630, 7770]),
        ("humanoid", tree(humanoid()), [36, 351, 315, 1787]),
        ("quadruped", tree(base_with_limbs(4, 3)), [18, 117, 99, 375]),
        ("hand", tree(base_with_limbs(5, 4)), [26, 191, 165, 685]),
        ("star 30", tree((0..30).map(|_| (-1, REVOLUTE)).collect()), [30, 30, 0, 0]),
        ("binary 6", tree(binary(6)), [63, 321, 258, 702]),
        ("binary 8", tree(binary(8)), [255, 1793, 1538, 5630]),
        ("binary 10", tree(binary(10)), [1023, 9217, 8194, 37886]),
    ]
}

/// Going out, a slot still holds the parent when a child reads it. Going in, a body's last child is the first to write to the body's slot.
#[test]
fn a_path_slot_is_kept_until_the_last_child() {
    for (name, topology, _) in table() {
        let joints = topology.joints();
        let mut holds = vec![None; joints.len() + 1];
        for (i, joint) in joints.iter().enumerate() {
            assert_eq!(holds[joint.parent_slot], joint.parent, "{name}: the slot that body {i} reads");
            assert_ne!(joint.slot, 0, "{name}: the slot of the world");
            holds[joint.slot] = Some(i);
        }
        let mut holds = vec![None; joints.len() + 1];
        for (i, joint) in joints.iter().enumerate().rev() {
            assert!(holds[joint.slot] == Some(i) || joints.get(i + 1).is_none_or(|next| next.parent != Some(i)), "{name}: sum of body {i}");
            if let Some(parent) = joint.parent {
                let last = joints.iter().rposition(|other| other.parent == Some(parent)) == Some(i);
                assert_eq!(joint.slot == joint.parent_slot, last, "{name}: body {i}");
                assert!(last || holds[joint.parent_slot] == Some(parent), "{name}: body {i} adds");
                holds[joint.parent_slot] = Some(parent);
            }
        }
        let slots = joints.iter().map(|joint| joint.slot).max().unwrap();
        assert!(slots <= topology.depth() && (!name.starts_with("chain") || slots == 1), "{name}: {slots} slots");
    }
}

/// A random positive definite matrix with the sparsity of a topology, as its lower triangle: `LᵀDL` for random L and D.
fn random_matrix(topology: &Topology, seed: u64) -> DMatrix<f64> {
    let mut random = Random::new(seed, 0);
    let n = topology.nv();
    let mut l = DMatrix::<f64>::identity(n, n);
    let mut d = DMatrix::<f64>::zeros(n, n);
    for k in 0..n {
        d[(k, k)] = random.uniform(0.5, 2.0);
        for &j in topology.row_dofs(k) {
            if j != k {
                l[(k, j)] = random.uniform(-0.5, 0.5);
            }
        }
    }
    let mut matrix = l.transpose() * d * l;
    matrix.fill_upper_triangle_with_lower_triangle();
    matrix
}

/// The same matrix in tree-sparse form.
fn sparse<T: Real>(topology: &Topology, dense: &DMatrix<f64>) -> TreeSparse<T> {
    TreeSparse::from_fn(topology, |i, j| T::from_f64(dense[(i, j)]))
}

#[test]
fn counts_of_storage_factorization_and_solution() {
    for (name, topology, [n, stored, d1, d2]) in table() {
        let dense = random_matrix(&topology, 3);
        let matrix: TreeSparse<Counted> = sparse(&topology, &dense);
        assert_eq!([matrix.size() as u64, matrix.values().len() as u64, topology.stored() as u64], [n, stored, stored], "{name}");

        let mut ltdl = Ltdl::new(&topology);
        let factor = Counted::count(|| ltdl.run(&matrix).unwrap());
        assert_eq!(factor, Operations { divisions: d1, fused: d2, ..Operations::default() }, "{name}: factorization");

        let mut x: Vec<Counted> = lifted(&vec![1.0; n as usize]);
        let solve = Counted::count(|| ltdl.solve(&mut x).unwrap());
        assert_eq!(solve, Operations { divisions: n, fused: 2 * d1, ..Operations::default() }, "{name}: solution");

        let mut inverse = TreeSparse::new(&topology);
        let selected = Counted::count(|| ltdl.selected_inverse(&mut inverse).unwrap());
        assert_eq!(selected, Operations { divisions: n, fused: 2 * d2, ..Operations::default() }, "{name}: selected inverse");

        let mut y = x.clone();
        let product = Counted::count(|| matrix.mul(&x, &mut y).unwrap());
        assert_eq!(product, Operations { multiplications: n, fused: 2 * d1, ..Operations::default() }, "{name}: product");
    }
}

#[test]
fn factorization_reproduces_the_matrix_without_fill_in() {
    for (name, topology, _) in table() {
        let n = topology.nv();
        if n > 300 {
            continue;
        }
        let dense = random_matrix(&topology, 5);
        // The product LᵀDL of any factors with the tree's sparsity has it too: nothing outside was dropped.
        let matrix: TreeSparse<f64> = sparse(&topology, &dense);
        assert_eq!((matrix.to_dense() - &dense).amax(), 0.0, "{name}");

        let factors = matrix.clone().into_ltdl().unwrap();
        let l = DMatrix::from_fn(n, n, |i, j| {
            if i == j {
                1.0
            } else if i > j {
                factors.factors().get(i, j)
            } else {
                0.0
            }
        });
        let d = DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(n, factors.factors().diagonal()));
        let error = (l.transpose() * d * &l - &dense).norm() / dense.norm();
        within(&format!("{name}: LᵀDL − M"), error, 5.0 * n as f64 * f64::EPSILON);

        let x: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
        let mut b = vec![0.0; n];
        matrix.mul(&x, &mut b).unwrap();
        let product = &dense * nalgebra::DVector::from_column_slice(&x);
        within(&format!("{name}: M x"), common::distance(&b, product.as_slice()) / dense.amax(), n as f64 * f64::EPSILON);
        factors.solve(&mut b).unwrap();
        let kappa = {
            let eigenvalues = dense.symmetric_eigenvalues();
            eigenvalues.max() / eigenvalues.min()
        };
        within(&format!("{name}: M⁻¹ M x"), common::distance(&b, &x), 16.0 * kappa * f64::EPSILON);
    }
}

/// The seven-body binary tree: which entries of M vanish, and that L has exactly M's zeros.
#[test]
fn branch_induced_sparsity_of_a_seven_body_tree() {
    let topology = topology(&binary(3));
    let parents: Vec<i64> = topology.dof_parents().iter().map(|parent| parent.map_or(0, |p| p as i64 + 1)).collect();
    // Depth-first numbering from one, as the book writes λ.
    assert_eq!(parents, [0, 1, 2, 2, 1, 5, 5]);
    let pattern = ["x", "xx", "xxx", "xx.x", "x...x", "x...xx", "x...x.x"];
    let matrix: TreeSparse<f64> = TreeSparse::from_fn(&topology, |_, _| 1.0);
    for (i, row) in pattern.iter().enumerate() {
        for (j, entry) in row.chars().enumerate() {
            assert_eq!(matrix.get(i, j), if entry == 'x' { 1.0 } else { 0.0 }, "({i}, {j})");
            assert_eq!(matrix.get(j, i), matrix.get(i, j));
        }
    }
    assert_eq!(matrix.get(7, 0), 0.0, "there is no such row");
}

#[test]
fn a_matrix_that_is_not_positive_definite_is_refused() {
    let topology = topology(&chain(4));
    for (bad, pivot) in [(2, 0.0), (1, -3.0), (3, f64::NAN)] {
        let matrix: TreeSparse<f64> = TreeSparse::from_fn(&topology, |i, j| {
            if i != j {
                0.0
            } else if i == bad {
                pivot
            } else {
                1.0
            }
        });
        let NotPositiveDefinite { dof, pivot: found } = matrix.into_ltdl().unwrap_err();
        assert_eq!((dof, found.to_bits()), (bad, pivot.to_bits()));
    }
}

fn counts(axes: &[[f64; 3]], n: usize, work: impl Fn(&Model<f64>, &StateBatch)) -> Operations {
    let model = dyadic_chain(axes, n);
    let states = StateBatch::random(&model, 1, 3);
    Counted::count(|| work(&model, &states))
}

fn rnea(model: &Model<f64>, states: &StateBatch) {
    let mut tau = vec![Counted(0.0); model.topology.nv()];
    let [q, v, a] = [states.q(0), states.v(0), states.a(0)].map(lifted::<Counted>);
    Rnea::new(&model.topology).run(model, &q, &v, &a, None, &mut tau).unwrap();
}

fn bias(model: &Model<f64>, states: &StateBatch) {
    let mut h = vec![Counted(0.0); model.topology.nv()];
    let [q, v] = [states.q(0), states.v(0)].map(lifted::<Counted>);
    Bias::new(&model.topology).run(model, &q, &v, None, &mut h).unwrap();
}

fn aba(model: &Model<f64>, states: &StateBatch) {
    let mut a = vec![Counted(0.0); model.topology.nv()];
    let [q, v, tau] = [states.q(0), states.v(0), states.tau(0)].map(lifted::<Counted>);
    Aba::new(&model.topology).run(model, &q, &v, &tau, None, &mut a).unwrap();
}

/// Operations on a revolute chain are a·n + b exactly: O(n) as an integer identity.
#[test]
fn recursions_are_linear_in_the_number_of_bodies() {
    type Work = fn(&Model<f64>, &StateBatch);
    let (aligned, skew) = (&[[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]][..], &[[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]][..]);
    for (name, axes, work, per_body) in [
        ("RNEA, aligned axes", aligned, rnea as Work, RNEA_PER_BODY[0]),
        ("RNEA, skew axes", skew, rnea, RNEA_PER_BODY[1]),
        ("bias, aligned axes", aligned, bias, BIAS_PER_BODY[0]),
        ("bias, skew axes", skew, bias, BIAS_PER_BODY[1]),
        ("ABA, aligned axes", aligned, aba, ABA_PER_BODY[0]),
        ("ABA, skew axes", skew, aba, ABA_PER_BODY[1]),
    ] {
        let fields = |n| {
            let c = counts(axes, n, work);
            [c.additions, c.multiplications, c.fused, c.divisions, c.roots, c.sin_cos].map(|count| count as i64)
        };
        let (ten, hundred, thousand) = (fields(10), fields(100), fields(1000));
        for k in 0..6 {
            let slope = (hundred[k] - ten[k]) / 90;
            assert_eq!(hundred[k], ten[k] + 90 * slope, "{name}, count {k}: from 10 to 100");
            assert_eq!(thousand[k], hundred[k] + 900 * slope, "{name}, count {k}: from 100 to 1000");
        }
        let slopes: Vec<i64> = (0..6).map(|k| (hundred[k] - ten[k]) / 90).collect();
        let offsets: Vec<i64> = (0..6).map(|k| ten[k] - 10 * slopes[k]).collect();
        println!("{name}: per body [+, ×, fma, ÷, √, sincos] = {slopes:?}, offset {offsets:?}");
        assert_eq!(slopes, per_body, "{name}: a change here is a change of cost, to be made on purpose");
    }
}

/// Additions, multiplications, multiply-adds, divisions, roots and sine-cosine pairs: of a body with an aligned axis, and with a skew one.
const RNEA_PER_BODY: [[i64; 6]; 2] = [[11, 39, 96, 0, 0, 1], [18, 58, 126, 0, 0, 1]];
const BIAS_PER_BODY: [[i64; 6]; 2] = [[10, 39, 95, 0, 0, 1], [15, 55, 125, 0, 0, 1]];
const ABA_PER_BODY: [[i64; 6]; 2] = [[45, 107, 268, 1, 0, 1], [55, 137, 314, 1, 0, 1]];

/// Entries that the mass matrix does not store are exactly zero in fact: no dof outside the path to the root feels the other.
#[test]
fn dofs_on_different_branches_do_not_couple() {
    for (_, recipe) in &common::ROBOTS {
        let model = common::build(recipe);
        let states = StateBatch::random(&model, 1, 2);
        let n = model.topology.nv();
        let mut weightless = model.clone();
        weightless.gravity = featherbench_spatial::Vec3::zero();
        let matrix = mass_matrix(&model, states.q(0)).unwrap();
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let column = featherbench_dynamics::inverse_dynamics(&weightless, states.q(0), &vec![0.0; n], &unit).unwrap();
            for (i, force) in column.iter().enumerate() {
                let related = model.topology.row_dofs(i).contains(&j) || model.topology.row_dofs(j).contains(&i);
                assert!(related || (*force == 0.0 && matrix.get(i, j) == 0.0), "({i}, {j})");
            }
        }
    }
}
