//! The three texts of the factorization, the solution and the inverse against each other: plain (`Counted` takes it), in registers (`f64`),
//! and in fours (registers of states). And the inverse against extended precision.

use crate::common;

use common::{ByReciprocal, ROBOTS, build, distance, dyadic_chain, generated, larger, largest, lifted, one_of, topology, within};
use featherbench_dynamics::{Ltdl, NotPositiveDefinite, TreeSparse, mass_matrix};
use featherbench_model::{Axis, JointKind, Topology};
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::{Counted, DoubleDouble, Real};
use wide::f64x4;

/// A topology of one-dof joints with these parents.
pub(crate) fn tree(parents: impl IntoIterator<Item = i64>) -> Topology {
    topology(&parents.into_iter().map(|parent| (parent, JointKind::Revolute(Axis::Z))).collect::<Vec<_>>())
}

/// A random tree: each body begins a branch with this probability.
pub(crate) fn random_tree(n: usize, spread: f64, seed: u64) -> Topology {
    let mut random = Random::new(seed, n as u64);
    let mut path: Vec<i64> = vec![-1];
    tree((0..n as i64).map(|body| {
        if random.unit() < spread {
            path.truncate(1 + random.below(path.len()));
        }
        let parent = path[path.len() - 1];
        path.push(body);
        parent
    }))
}

/// A chain longer than a path that is kept.
fn longest() -> (String, Topology) {
    ("chain 1030, longer than a kept path".into(), tree(-1..1029))
}

/// Chains as long as a block, a register or a path; stars, limbs on a base, and trees with blocks of every size. At night the longest chain
/// too: half of the time is its.
pub(crate) fn topologies() -> Vec<(String, Topology)> {
    let mut all: Vec<(String, Topology)> = Vec::new();
    for n in (1..=26).chain([36, 64, 65, 67, 100]) {
        all.push((format!("chain {n}"), tree(-1..n - 1)));
    }
    if one_of(2) == 1 {
        all.push(longest());
    }
    for n in [2, 3, 7, 8, 9, 30] {
        all.push((format!("star {n}"), tree(std::iter::repeat_n(-1, n))));
        all.push((format!("hub {n}"), tree(std::iter::once(-1).chain(std::iter::repeat_n(0, n)))));
    }
    for name in ["humanoid", "quadruped", "hand", "binary_tree:depth=6"] {
        all.push((name.into(), generated(name).topology));
    }
    for (seed, n) in [2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 20, 33, 50, 80, 121].into_iter().enumerate() {
        for spread in [0.05, 0.2, 0.5, 0.9] {
            all.push((format!("tree {n}, spread {spread}"), random_tree(n, spread, seed as u64)));
        }
    }
    all
}

/// A positive definite matrix whose condition number is moderate: its off-diagonal entries sum to less than its diagonal.
pub(crate) fn matrix<T: Real>(topology: &Topology, seed: u64) -> TreeSparse<T> {
    let mut random = Random::new(seed, topology.nv() as u64);
    let mut matrix = TreeSparse::from_fn(topology, |_, _| random.uniform(-1.0, 1.0));
    let mut sums = vec![random.uniform(0.5, 1.5); topology.nv()];
    for i in 0..topology.nv() {
        for (&j, entry) in topology.row_dofs(i).iter().zip(&matrix.values()[topology.row(i)]) {
            sums[i] += entry.abs();
            sums[j] += entry.abs();
        }
    }
    for (i, sum) in sums.iter().enumerate() {
        matrix.values_mut()[topology.row(i).end - 1] = *sum;
    }
    TreeSparse::from_fn(topology, |i, j| T::from_f64(matrix.get(i, j)))
}

pub(crate) fn plain(numbers: &[Counted]) -> Vec<f64> {
    numbers.iter().map(|number| number.0).collect()
}

pub(crate) fn sines(n: usize) -> Vec<f64> {
    (0..n).map(|k| (1.0 + k as f64).sin()).collect()
}

#[test]
fn registers_give_what_the_plain_text_gives() {
    for (name, topology) in topologies().into_iter().chain([longest()]) {
        let n = topology.nv();
        let (mut fast, mut slow) = (matrix::<f64>(&topology, 7).into_ltdl().unwrap(), matrix::<Counted>(&topology, 7).into_ltdl().unwrap());
        let factors = plain(slow.factors().values());
        let off = distance(fast.factors().values(), &factors) / largest(&factors);
        // The sums have up to n terms, and another order.
        let order = 16.0 + n as f64 / 32.0;
        within(&format!("{name}: factors"), off, 0.5 * order * f64::EPSILON);

        let (mut x, mut y) = (sines(n), lifted::<Counted>(&sines(n)));
        fast.solve(&mut x).unwrap();
        slow.solve(&mut y).unwrap();
        within(&format!("{name}: solution"), distance(&x, &plain(&y)) / largest(&plain(&y)), order * f64::EPSILON);

        if n > 130 {
            continue;
        }
        // What was in the array before does not matter.
        let (mut fast_inverse, mut slow_inverse) = (vec![f64::NAN; n * n], vec![Counted(f64::NAN); n * n]);
        fast.inverse(&mut fast_inverse).unwrap();
        slow.inverse(&mut slow_inverse).unwrap();
        let expected = plain(&slow_inverse);
        within(&format!("{name}: inverse"), distance(&fast_inverse, &expected) / largest(&expected), order * f64::EPSILON);
        // What the selected inverse held before does not matter.
        let mut selected = TreeSparse::from_fn(&topology, |_, _| Counted(f64::NAN));
        slow.selected_inverse(&mut selected).unwrap();
        let of_full: TreeSparse<Counted> = TreeSparse::from_fn(&topology, |i, j| slow_inverse[i * n + j]);
        let off = distance(&plain(selected.values()), &plain(of_full.values())) / largest(&expected);
        within(&format!("{name}: selected inverse"), off, order * f64::EPSILON);
        let mut in_registers = TreeSparse::from_fn(&topology, |_, _| f64::NAN);
        for _ in 0..2 {
            fast.selected_inverse(&mut in_registers).unwrap();
            let off = distance(in_registers.values(), &plain(of_full.values())) / largest(&expected);
            within(&format!("{name}: selected inverse in registers"), off, order * f64::EPSILON);
        }
        for i in 0..n {
            for j in 0..n {
                assert_eq!(fast_inverse[i * n + j], fast_inverse[j * n + i], "{name}: entry ({i}, {j})");
                assert_eq!(slow_inverse[i * n + j].0, slow_inverse[j * n + i].0, "{name}: plain entry ({i}, {j})");
            }
            // Its columns are the solutions of unit right-hand sides.
            let mut column = vec![0.0; n];
            column[i] = 1.0;
            fast.solve(&mut column).unwrap();
            within(
                &format!("{name}: column {i}"),
                distance(&fast_inverse[i * n..][..n], &column) / largest(&expected),
                16.0 * f64::EPSILON,
            );
        }
    }
}

/// Lanes multiply by 1/D: the plain text does the same on a scalar that divides so.
#[test]
fn registers_of_states_give_the_plain_factors_to_the_bit() {
    for (name, topology) in topologies() {
        let n = topology.nv();
        if n > 130 {
            continue;
        }
        let fours = matrix::<f64x4>(&topology, 9).into_ltdl().unwrap();
        let slow = matrix::<ByReciprocal>(&topology, 9).into_ltdl().unwrap();
        let lane = |numbers: &[f64x4]| numbers.iter().map(|number| number.to_array()[2]).collect::<Vec<_>>();
        let plain = |numbers: &[ByReciprocal]| numbers.iter().map(|number| number.0).collect::<Vec<_>>();
        assert_eq!(lane(fours.factors().values()), plain(slow.factors().values()), "{name}: factors");

        let (mut x, mut y) = (lifted::<f64x4>(&sines(n)), lifted::<ByReciprocal>(&sines(n)));
        fours.solve(&mut x).unwrap();
        slow.solve(&mut y).unwrap();
        within(&format!("{name}: solution"), distance(&lane(&x), &plain(&y)) / largest(&plain(&y)), 16.0 * f64::EPSILON);
    }
}

/// Rows that were there before a factorization, its scratch and its padding leave no trace.
#[test]
fn a_repeated_factorization_gives_the_same_bits() {
    for (name, topology) in topologies() {
        let (first, second) = (matrix::<f64>(&topology, 1), matrix::<f64>(&topology, 2));
        let mut ltdl = Ltdl::new(&topology);
        ltdl.run(&first).unwrap();
        ltdl.run(&second).unwrap();
        let expected = second.clone().into_ltdl().unwrap();
        assert_eq!(ltdl.factors(), expected.factors(), "{name}");
        // Numbers from outside take the place of the factors, and leave it.
        let mut other = first.clone();
        ltdl.matrix_mut().exchange(&mut other).unwrap();
        assert_eq!(&other, expected.factors(), "{name}");
        ltdl.factor().unwrap();
        assert_eq!(ltdl.factors(), first.into_ltdl().unwrap().factors(), "{name}");
    }
}

/// Each text names the same dof: the first whose pivot is not positive, from the leaves.
#[test]
fn every_text_names_the_same_dof() {
    for (name, topology) in topologies() {
        let n = topology.nv();
        if n > 130 {
            continue;
        }
        for bad in (0..n).step_by(1 + n / 9) {
            for pivot in [0.0, -1.0, f64::NAN] {
                let mut fast = matrix::<f64>(&topology, 3);
                let mut slow = matrix::<Counted>(&topology, 3);
                // Zero in its row and column: its pivot is what is on the diagonal.
                for i in 0..n {
                    for (&j, place) in topology.row_dofs(i).iter().zip(topology.row(i)) {
                        if i == bad || j == bad {
                            let value = if i == j { pivot } else { 0.0 };
                            (fast.values_mut()[place], slow.values_mut()[place]) = (value, Counted(value));
                        }
                    }
                }
                let NotPositiveDefinite { dof, pivot: found } = fast.into_ltdl().unwrap_err();
                assert_eq!((dof, found.to_bits()), (bad, pivot.to_bits()), "{name}");
                let NotPositiveDefinite { dof, pivot: found } = slow.into_ltdl().unwrap_err();
                assert_eq!((dof, found.to_bits()), (bad, pivot.to_bits()), "{name}, plain");
            }
        }
    }
}

/// A number that is not finite stays in its own tree: nothing is multiplied by zero to leave it out.
#[test]
fn what_is_not_finite_stays_in_its_tree() {
    // Two limbs on the world, and one dof.
    let topology = tree([-1, 0, 1, 2, -1, 4, 5, 6, 7, -1]);
    let mut x = sines(10);
    let ltdl = matrix::<f64>(&topology, 5).into_ltdl().unwrap();
    let mut expected = x.clone();
    ltdl.solve(&mut expected).unwrap();
    for bad in [0, 3, 4, 8, 9] {
        x.copy_from_slice(&sines(10));
        x[bad] = f64::NAN;
        ltdl.solve(&mut x).unwrap();
        let trees = [0..4, 4..9, 9..10];
        for limb in trees {
            if limb.contains(&bad) {
                assert!(x[limb].iter().any(|x| x.is_nan()));
            } else {
                assert_eq!(x[limb.clone()], expected[limb]);
            }
        }
    }
}

/// The inverse of mass matrices, entry by entry against the same matrix in double-double: as good as one solution for each column.
#[test]
fn the_inverse_is_as_good_as_solutions() {
    let robots = ROBOTS.iter().map(|(name, recipe)| ((*name).to_owned(), build(recipe)));
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let chains = [10, 36, 50].map(|n| (format!("chain {n}"), dyadic_chain(&axes, n)));
    for (name, model) in robots.chain(chains) {
        let n = model.topology.nv();
        let states = StateBatch::random(&model, 3, 11);
        let (mut of_inverse, mut of_solutions, mut of_plain, mut of_selected) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        let (mut selected, mut selected_plainly) = (TreeSparse::new(&model.topology), TreeSparse::new(&model.topology));
        let on_path = |i: usize, j: usize| model.topology.row_dofs(i.max(j)).contains(&i.min(j));
        let mut entries = 0;
        for k in 0..states.count() {
            let matrix = mass_matrix(&model, states.q(k)).unwrap();
            let exact: TreeSparse<DoubleDouble> = TreeSparse::from_fn(&model.topology, |i, j| DoubleDouble::from_f64(matrix.get(i, j)));
            let (mut truth, mut inverse) = (vec![DoubleDouble::from_f64(0.0); n * n], vec![0.0; n * n]);
            exact.into_ltdl().unwrap().inverse(&mut truth).unwrap();
            let counted: TreeSparse<Counted> = TreeSparse::from_fn(&model.topology, |i, j| Counted(matrix.get(i, j)));
            let mut divided = vec![Counted(0.0); n * n];
            let mut counted = counted.into_ltdl().unwrap();
            counted.inverse(&mut divided).unwrap();
            counted.selected_inverse(&mut selected_plainly).unwrap();
            let mut ltdl = matrix.into_ltdl().unwrap();
            ltdl.inverse(&mut inverse).unwrap();
            ltdl.selected_inverse(&mut selected).unwrap();
            for i in 0..n {
                let mut column = vec![0.0; n];
                column[i] = 1.0;
                ltdl.solve(&mut column).unwrap();
                for j in 0..n {
                    let scale = (truth[i * n + i].to_f64() * truth[j * n + j].to_f64()).sqrt();
                    let off = |value: f64| (DoubleDouble::from_f64(value) - truth[i * n + j]).to_f64().abs() / scale;
                    assert!(off(inverse[i * n + j]).is_finite() && off(column[j]).is_finite(), "{name}");
                    of_inverse = larger(of_inverse, off(inverse[i * n + j]));
                    of_plain = larger(of_plain, off(divided[i * n + j].0));
                    of_solutions = larger(of_solutions, off(column[j]));
                    if on_path(i, j) {
                        of_selected = larger(of_selected, larger(off(selected.get(i, j)), off(selected_plainly.get(i, j).0)));
                        entries += 1;
                    }
                }
            }
        }
        let floor = 8.0 * f64::EPSILON;
        within(&format!("{name}: inverse, solutions are off by {of_solutions:.1e}"), of_inverse, 4.0 * of_solutions + floor);
        // Divisions in place of products with reciprocals.
        within(&format!("{name}: inverse, the plain one is off by {of_plain:.1e}"), of_inverse, 4.0 * of_plain + floor);
        within(&format!("{name}: selected inverse, solutions are off by {of_solutions:.1e}"), of_selected, 4.0 * of_solutions + floor);
        let stored = 2 * model.topology.stored() - n;
        assert_eq!(entries, states.count() * stored, "{name}: all entries of the pattern");
    }
}

/// A register of states gives what each state gives, and a matrix of another tree is refused.
#[test]
fn the_selected_inverse_of_registers_is_that_of_single_states() {
    for (name, recipe) in &ROBOTS {
        let t = &build(recipe).topology;
        let selected = |mut ltdl: Ltdl<f64x4>| {
            let mut selected = TreeSparse::new(t);
            ltdl.selected_inverse(&mut selected).unwrap();
            selected.values().iter().map(|x| x.to_array()[1]).collect::<Vec<_>>()
        };
        let fours = selected(matrix::<f64x4>(t, 4).into_ltdl().unwrap());
        let mut alone = TreeSparse::new(t);
        matrix::<ByReciprocal>(t, 4).into_ltdl().unwrap().selected_inverse(&mut alone).unwrap();
        assert_eq!(fours, alone.values().iter().map(|x| x.0).collect::<Vec<_>>(), "{name}");
    }
    let mut ltdl = matrix::<f64>(&tree([-1, 0, 0]), 1).into_ltdl().unwrap();
    let mut other = TreeSparse::new(&tree([-1, 0, 1]));
    let refused = ltdl.selected_inverse(&mut other).unwrap_err();
    assert_eq!((refused.what, refused.expected, refused.found), ("dofs of the tree-sparse matrix with the same place in the tree", 3, 1));
    assert_eq!(ltdl.selected_inverse(&mut TreeSparse::new(&tree([-1, 0]))).unwrap_err().what, "dofs of the tree-sparse matrix");
}
