//! `M = LᵀL`: against the dense product in double-double, against `LᵀDL`, and counted.

use crate::{common, ltdl};

use common::dense::{Dense, off};
use common::{lifted, within};
use featherbench_dynamics::{Error, Ltl, NotPositiveDefinite, TreeSparse, mass_matrix};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Counted, DoubleDouble, Dual, Operations, Real};
use ltdl::{matrix, plain, sines, topologies, tree};
use wide::f64x4;

#[test]
fn the_product_is_the_matrix_and_the_factor_has_its_zeros() {
    for (name, topology) in topologies().into_iter().filter(|(_, topology)| topology.nv() <= 67) {
        let (n, m) = (topology.nv(), matrix::<f64>(&topology, 7));
        let ltl = m.clone().into_ltl().unwrap();
        let l = Dense::lower(ltl.factors(), false);
        let dense = Dense::of(&m);
        // The bound of the issue is 5 n ε of the norm; this is each entry over the roots of its diagonal entries.
        within(&format!("{name}: LᵀL − M"), dense.distance(&l.transposed().times(&l)), 5.0 * n as f64 * f64::EPSILON);

        let mut x = sines(n);
        ltl.solve(&mut x).unwrap();
        // The matrix is diagonally dominant: its scaled condition number is below 4 n.
        within(&format!("{name}: solution"), off(&x, &dense.clone().solve(&sines(n)).0), 16.0 * n as f64 * f64::EPSILON);
        for (multiply, solve, expected) in [
            (Ltl::multiply_lower as fn(&Ltl<f64>, &mut [f64]) -> _, Ltl::solve_lower as fn(&Ltl<f64>, &mut [f64]) -> _, l.mul(&sines(n))),
            (Ltl::multiply_lower_transposed, Ltl::solve_lower_transposed, l.transposed().mul(&sines(n))),
        ] {
            let mut x = sines(n);
            multiply(&ltl, &mut x).unwrap();
            within(&format!("{name}: product"), off(&x, &expected), n as f64 * f64::EPSILON);
            solve(&ltl, &mut x).unwrap();
            within(&format!("{name}: and back"), common::distance(&x, &sines(n)), 4.0 * n as f64 * f64::EPSILON);
        }
    }
}

/// L of LᵀL is D^½ times L of LᵀDL: mass matrices, several scalars.
#[test]
fn it_is_the_root_of_the_other_factorization() {
    for (name, recipe) in &common::ROBOTS {
        let model = common::build(recipe);
        let (t, states) = (&model.topology, StateBatch::random(&model, 1, 5));
        let m = mass_matrix(&model, states.q(0)).unwrap();
        let extended = |i, j| DoubleDouble::from(m.get(i, j));
        let exact = TreeSparse::from_fn(t, extended).into_ltdl().unwrap();
        let exact = exact.factors();
        let of_root = |i, j| if i == j { exact.get(i, i).sqrt() } else { exact.get(i, i).sqrt() * exact.get(i, j) };
        let root = TreeSparse::from_fn(t, of_root);
        let ltl = TreeSparse::from_fn(t, extended).into_ltl().unwrap();
        let gap = |a: &DoubleDouble, b: &DoubleDouble| (*a - *b).to_f64().abs();
        let off = ltl.factors().values().iter().zip(root.values()).map(|(a, b)| gap(a, b)).fold(0.0, common::larger);
        let scale = common::largest(&root.values().iter().map(|x| x.to_f64()).collect::<Vec<_>>());
        let condition = Dense::of(&m).solve(&vec![0.0; t.nv()]).1;
        let worst = condition.iter().map(|d| m.get(0, 0) / d.to_f64()).fold(1.0, common::larger);
        within(&format!("{name}: double-double"), off / scale, 1e3 * worst * f64::EPSILON * f64::EPSILON);

        let determinant = exact_log_determinant(&root);
        within(
            &format!("{name}: ln det"),
            (m.clone().into_ltl().unwrap().log_determinant() - determinant).abs(),
            1e3 * worst * f64::EPSILON,
        );
        // A register of states and a dual have what one state has.
        let plainly = TreeSparse::from_fn(t, |i, j| Counted(m.get(i, j))).into_ltl().unwrap();
        let fours = TreeSparse::from_fn(t, |i, j| f64x4::splat(m.get(i, j))).into_ltl().unwrap();
        let lane: Vec<f64> = fours.factors().values().iter().map(|x| x.to_array()[1]).collect();
        assert_eq!(lane, plain(plainly.factors().values()), "{name}");
        let dual = TreeSparse::from_fn(t, |i, j| Dual::new(m.get(i, j), 2.0 * m.get(i, j))).into_ltl().unwrap();
        for (dual, value) in dual.factors().values().iter().zip(&lane) {
            // d√(1 + 2t) = 1 at t = 0
            within(&format!("{name}: derivative"), (dual.derivative - value).abs() / scale, 16.0 * worst * f64::EPSILON);
        }
    }
}

fn exact_log_determinant(root: &TreeSparse<DoubleDouble>) -> f64 {
    use featherbench_spatial::Logarithm;
    root.diagonal().map(|l| 2.0 * l.ln().to_f64()).sum()
}

#[test]
fn counts() {
    for (name, topology) in topologies() {
        let n = topology.nv() as u64;
        let depths = (0..topology.nv()).map(|dof| topology.dof_depth(dof) as u64);
        let (d1, d2) = depths.fold((0, 0), |(d1, d2), d| (d1 + d - 1, d2 + d * (d - 1) / 2));
        let m = matrix::<Counted>(&topology, 7);
        let mut ltl = Ltl::new(&topology);
        let factor = Counted::count(|| ltl.run(&m).unwrap());
        assert_eq!(factor, Operations { roots: n, divisions: d1, fused: d2, ..Operations::default() }, "{name}");
        let mut x: Vec<Counted> = lifted(&sines(topology.nv()));
        let solve = Counted::count(|| ltl.solve(&mut x).unwrap());
        assert_eq!(solve, Operations { divisions: 2 * n, fused: 2 * d1, ..Operations::default() }, "{name}");
    }
}

#[test]
fn the_dof_whose_pivot_fails_is_named_as_in_the_other_factorization() {
    let topology = tree([-1, 0, 1, 0, 3]);
    for bad in 0..5 {
        for pivot in [0.0, -2.0, f64::NAN] {
            let mut m = matrix::<Counted>(&topology, 7);
            m.fill(|i, j| {
                Counted(if i != j {
                    0.0
                } else if i == bad {
                    pivot
                } else {
                    1.0
                })
            });
            let NotPositiveDefinite { dof, pivot: found } = m.clone().into_ltl().unwrap_err();
            assert_eq!((dof, found.to_bits()), (bad, pivot.to_bits()));
            assert_eq!(m.into_ltdl().unwrap_err().dof, bad);
        }
    }
    let mut ltl: Ltl<f64> = Ltl::new(&topology);
    assert!(matches!(ltl.run(&matrix(&tree([-1, 0, 1, 2, 3]), 1)), Err(Error::Dimension(_))));
    assert_eq!(ltl.solve(&mut [0.0; 4]).unwrap_err().expected, 5);
    assert_eq!(ltl.multiply_lower(&mut [0.0; 4]).unwrap_err().found, 4);
    // What held a matrix that failed factors the next one.
    ltl.matrix_mut().fill(|_, _| 0.0);
    assert_eq!(ltl.factor().unwrap_err().dof, 4);
    ltl.matrix_mut().fill(|i, j| if i == j { 4.0 } else { 0.0 });
    ltl.factor().unwrap();
    assert_eq!(ltl.factors().diagonal().collect::<Vec<_>>(), [2.0; 5]);
}
