//! What is done with the factors beside solutions: products, half-solutions, the square root, the determinant and columns of the inverse.
//! Against dense matrices in double-double, against each other, and counted.

use crate::{common, ltdl};

use common::dense::{Dense, off};
use common::{lifted, within};
use featherbench_dynamics::{DimensionError, Ltdl, TreeSparse};
use featherbench_model::Topology;
use featherbench_spatial::{Counted, DoubleDouble, Dual, Logarithm, Operations, Real};
use ltdl::{matrix, plain, sines, topologies};
use wide::{f32x8, f64x4};

/// An operation in place on a vector.
type InPlace<T> = fn(&Ltdl<T>, &mut [T]) -> Result<(), DimensionError>;

/// L and its transpose, then R and its transpose: the product, and the solution that undoes it.
fn pairs<T: Real>() -> [(&'static str, InPlace<T>, InPlace<T>); 4] {
    [
        ("L", Ltdl::multiply_lower, Ltdl::solve_lower),
        ("Lᵀ", Ltdl::multiply_lower_transposed, Ltdl::solve_lower_transposed),
        ("R", Ltdl::multiply_root, Ltdl::solve_root),
        ("Rᵀ", Ltdl::multiply_root_transposed, Ltdl::solve_root_transposed),
    ]
}

/// Small enough for dense matrices in double-double.
fn small() -> impl Iterator<Item = (String, Topology)> {
    topologies().into_iter().filter(|(_, topology)| topology.nv() <= 67)
}

fn factored<T: Real>(topology: &Topology) -> Ltdl<T> {
    matrix::<T>(topology, 7).into_ltdl().unwrap()
}

#[test]
fn products_are_those_of_dense_matrices_and_solutions_undo_them() {
    for (name, topology) in small() {
        let (n, factors) = (topology.nv(), factored::<f64>(&topology));
        let lower = Dense::lower(factors.factors(), true);
        let root = Dense::from_fn(n, |i, j| DoubleDouble::from(factors.factors().get(i, i)).sqrt() * lower.at(i, j));
        let dense = [&lower, &lower.transposed(), &root, &root.transposed()].map(|matrix| matrix.mul(&sines(n)));
        for ((what, multiply, solve), expected) in pairs().into_iter().zip(dense) {
            let mut x = sines(n);
            multiply(&factors, &mut x).unwrap();
            // |L| has rows that sum to 2 at most (the matrix is diagonally dominant), its columns to n.
            let terms = n as f64 * f64::EPSILON;
            within(&format!("{name}: {what} x"), off(&x, &expected), terms);
            solve(&factors, &mut x).unwrap();
            within(&format!("{name}: {what}⁻¹ {what} x"), common::distance(&x, &sines(n)), 4.0 * terms);
        }
    }
}

/// Two halves are a whole, in every text: plain, in registers and in fours.
#[test]
fn the_halves_of_a_solution_make_the_whole() {
    fn check<T: Real>(name: &str, topology: &Topology, values: impl Fn(&[T]) -> Vec<f64>)
    where
        f64: featherbench_spatial::Lift<T>,
    {
        let (n, ltdl) = (topology.nv(), factored::<T>(topology));
        let (mut whole, mut halves, mut by_root) = (lifted::<T>(&sines(n)), lifted::<T>(&sines(n)), lifted::<T>(&sines(n)));
        ltdl.solve(&mut whole).unwrap();
        ltdl.solve_lower_transposed(&mut halves).unwrap();
        for (x, d) in halves.iter_mut().zip(ltdl.factors().diagonal()) {
            *x = *x / d;
        }
        ltdl.solve_lower(&mut halves).unwrap();
        assert_eq!(values(&halves), values(&whole), "{name}: {}", std::any::type_name::<T>());
        ltdl.solve_root_transposed(&mut by_root).unwrap();
        ltdl.solve_root(&mut by_root).unwrap();
        let (whole, by_root) = (values(&whole), values(&by_root));
        // Two roots in place of a division: three roundings of each number more.
        within(&format!("{name}: by the root"), common::distance(&by_root, &whole) / common::largest(&whole), 16.0 * f64::EPSILON);
    }
    for (name, topology) in topologies() {
        check::<f64>(&name, &topology, <[f64]>::to_vec);
        check::<Counted>(&name, &topology, plain);
        check::<f64x4>(&name, &topology, |x| x.iter().map(|x| x.to_array()[3]).collect());
    }
}

/// `|R x|² = xᵀMx` and `|R⁻ᵀ b|² = bᵀM⁻¹b`, and the derivatives of both along `M + t N`, which are xᵀNx and −(M⁻¹b)ᵀN(M⁻¹b).
#[test]
fn the_root_gives_both_norms_and_their_derivatives() {
    for (name, topology) in small() {
        let n = topology.nv();
        let (m, rate) = (matrix::<f64>(&topology, 7), matrix::<f64>(&topology, 8));
        let moving: TreeSparse<Dual<f64>> = TreeSparse::from_fn(&topology, |i, j| Dual::new(m.get(i, j), rate.get(i, j)));
        let moving = moving.into_ltdl().unwrap();
        let square = |x: &[Dual<f64>]| x.iter().fold(Dual::zero(), |sum, x| x.mul_add(*x, sum));
        let form = |m: &TreeSparse<f64>, x: &[f64]| {
            let mut y = vec![0.0; n];
            m.mul(x, &mut y).unwrap();
            x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>()
        };
        let tolerance = 16.0 * n as f64 * f64::EPSILON;

        let mut x: Vec<Dual<f64>> = lifted(&sines(n));
        moving.multiply_root(&mut x).unwrap();
        let (found, value, derivative) = (square(&x), form(&m, &sines(n)), form(&rate, &sines(n)));
        within(&format!("{name}: |R x|²"), (found.value - value).abs() / value, tolerance);
        within(&format!("{name}: its derivative"), (found.derivative - derivative).abs() / derivative, tolerance);

        let (mut b, mut y): (Vec<Dual<f64>>, _) = (lifted(&sines(n)), sines(n));
        moving.solve_root_transposed(&mut b).unwrap();
        factored::<f64>(&topology).solve(&mut y).unwrap();
        let (found, value, derivative) = (square(&b), form(&m, &y), -form(&rate, &y));
        within(&format!("{name}: |R⁻ᵀ b|²"), (found.value - value).abs() / value, tolerance);
        within(&format!("{name}: its derivative"), (found.derivative / derivative - 1.0).abs(), tolerance);
    }
}

#[test]
fn the_logarithm_of_the_determinant() {
    for (name, topology) in small() {
        let n = topology.nv();
        let (m, rate) = (matrix::<f64>(&topology, 7), matrix::<f64>(&topology, 8));
        let (_, pivots) = Dense::of(&m).solve(&vec![0.0; n]);
        let truth = pivots.iter().fold(DoubleDouble::zero(), |sum, pivot| sum + pivot.ln());
        let magnitudes: f64 = pivots.iter().map(|pivot| pivot.to_f64().ln().abs()).sum();
        // Each pivot has an error of a few ulps for each dof below; n sums.
        let tolerance = (8.0 * n as f64 + magnitudes * n as f64) * f64::EPSILON;
        let ltdl = m.clone().into_ltdl().unwrap();
        within(&format!("{name}: f64"), (DoubleDouble::from(ltdl.log_determinant()) - truth).to_f64().abs(), tolerance);

        let extended: TreeSparse<DoubleDouble> = TreeSparse::from_fn(&topology, |i, j| m.get(i, j).into());
        let off = (extended.into_ltdl().unwrap().log_determinant() - truth).to_f64().abs();
        // u in place of 2u for f64; sums of 40 u² for each logarithm.
        within(&format!("{name}: double-double"), off, 16.0 * tolerance * f64::EPSILON);

        let lanes = factored::<f64x4>(&topology).log_determinant().to_array();
        within(&format!("{name}: lanes"), (lanes[1] - truth.to_f64()).abs(), tolerance);
        let single = factored::<f32x8>(&topology).log_determinant().to_array();
        within(
            &format!("{name}: single precision"),
            (f64::from(single[6]) - truth.to_f64()).abs(),
            tolerance / f64::EPSILON * f64::from(f32::EPSILON),
        );

        // d ln det (M + t N)/dt = tr M⁻¹N
        let moving: TreeSparse<Dual<f64>> = TreeSparse::from_fn(&topology, |i, j| Dual::new(m.get(i, j), rate.get(i, j)));
        let found = moving.into_ltdl().unwrap().log_determinant().derivative;
        let mut inverse = vec![0.0; n * n];
        ltdl.inverse(&mut inverse).unwrap();
        let products = |k: usize| (0..n).map(|j| inverse[k * n + j] * rate.get(k, j)).collect::<Vec<_>>();
        let products: Vec<f64> = (0..n).flat_map(products).collect();
        let sum: f64 = products.iter().map(|product| product.abs()).sum();
        within(&format!("{name}: derivative"), (found - products.iter().sum::<f64>()).abs(), 16.0 * n as f64 * f64::EPSILON * sum);
    }
}

/// 2000 dofs of 1e300: the determinant is 10^600000.
#[test]
fn a_determinant_out_of_range_has_a_logarithm() {
    let mut star = TreeSparse::of_parents(&vec![None; 2000]).unwrap();
    star.fill(|_, _| 1e300);
    let found = star.into_ltdl().unwrap().log_determinant();
    within("star", (found / (2000.0 * 300.0 * std::f64::consts::LN_10) - 1.0).abs(), 2000.0 * f64::EPSILON);
}

/// The counts of the files' heads. D1 of a tree is the sum of d − 1 over its dofs.
#[test]
fn counts() {
    for (name, topology) in topologies() {
        let n = topology.nv() as u64;
        let d1 = topology.stored() as u64 - n;
        let ltdl = factored::<Counted>(&topology);
        let mut x: Vec<Counted> = lifted(&sines(topology.nv()));
        for (what, multiply, solve) in pairs::<Counted>() {
            let root = if what.starts_with('R') { n } else { 0 };
            let products = Counted::count(|| multiply(&ltdl, &mut x).unwrap());
            assert_eq!(products, Operations { fused: d1, roots: root, multiplications: root, ..Operations::default() }, "{name}: {what} x");
            let solution = Counted::count(|| solve(&ltdl, &mut x).unwrap());
            assert_eq!(solution, Operations { fused: d1, roots: root, divisions: root, ..Operations::default() }, "{name}: {what}⁻¹ x");
        }
    }
}

#[test]
fn shapes_are_checked() {
    let ltdl = factored::<f64>(&ltdl::tree([-1, 0, 0]));
    for (what, multiply, solve) in pairs::<f64>() {
        for (name, call) in [("multiply", multiply), ("solve", solve)] {
            let refused = call(&ltdl, &mut [0.0; 2]).unwrap_err();
            assert_eq!((refused.expected, refused.found), (3, 2), "{name} {what}");
        }
    }
}
