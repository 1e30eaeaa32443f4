//! Updates and downdates of the factors: against the dense sum in double-double, next to singular matrices, refused, and counted.

use crate::{common, ltdl};

use common::dense::Dense;
use common::within;
use featherbench_dynamics::{DimensionError, Error, Ltdl, NotPositiveDefinite, TreeSparse};
use featherbench_model::Topology;
use featherbench_robots::Random;
use featherbench_spatial::{Counted, DoubleDouble, Dual, Operations};
use ltdl::{matrix, plain, topologies, tree};
use wide::f64x4;

/// Trees with a dof of each and some vectors along its path: the deepest dof, and one drawn.
fn cases() -> Vec<(String, Topology, usize, Vec<f64>)> {
    let mut cases = Vec::new();
    for (name, topology) in topologies().into_iter().filter(|(_, topology)| topology.nv() <= 67) {
        let n = topology.nv();
        let mut random = Random::new(21, n as u64);
        let deepest = (0..n).max_by_key(|&dof| topology.dof_depth(dof)).unwrap();
        for (dof, rank) in [(deepest, 1), (random.below(n), 1), (deepest, 3)] {
            let vectors: Vec<f64> = (0..rank * topology.dof_depth(dof)).map(|_| random.uniform(-1.0, 1.0)).collect();
            cases.push((format!("{name}, dof {dof}, rank {rank}"), topology.clone(), dof, vectors));
        }
    }
    cases
}

/// M + σ Σ w wᵀ, exactly but for double-double.
fn changed(m: &TreeSparse<f64>, topology: &Topology, dof: usize, sigma: f64, vectors: &[f64]) -> Dense {
    let (mut dense, path) = (Dense::of(m), topology.row_dofs(dof));
    for w in vectors.chunks_exact(path.len()) {
        for (&i, &w_i) in path.iter().zip(w) {
            for (&j, &w_j) in path.iter().zip(w) {
                let place = i * dense.n + j;
                dense.entries[place] += DoubleDouble::from_product(w_i, w_j) * sigma.into();
            }
        }
    }
    dense
}

/// The largest σ Σ w wᵀ that M − it survives, by wᵀM⁻¹w: less than 1/σ for one vector, and for several when their sum is.
fn limit(m: &TreeSparse<f64>, topology: &Topology, dof: usize, vectors: &[f64]) -> f64 {
    let path = topology.row_dofs(dof);
    let of_one = |w: &[f64]| {
        let mut b = vec![0.0; topology.nv()];
        path.iter().zip(w).for_each(|(&dof, &w)| b[dof] = w);
        let (x, _) = Dense::of(m).solve(&b);
        x.iter().zip(&b).map(|(x, b)| x.to_f64() * b).sum::<f64>()
    };
    1.0 / vectors.chunks_exact(path.len()).map(of_one).sum::<f64>()
}

/// From a tenth of M to 10¹² of it. The measure is of the result: an update loses nothing.
#[test]
fn an_update_gives_the_factors_of_the_sum() {
    for (name, topology, dof, vectors) in cases() {
        let m = matrix::<f64>(&topology, 7);
        for sigma in [0.0, 0.1, 1.0, 1e3, 1e12] {
            let mut ltdl = m.clone().into_ltdl().unwrap();
            ltdl.update(dof, sigma, &vectors).unwrap();
            let truth = changed(&m, &topology, dof, sigma, &vectors);
            let rank = vectors.len() / topology.dof_depth(dof);
            // Each vector changes a number by three roundings, and each entry is the sum of d products.
            let terms = (rank * topology.dof_depth(dof) + topology.nv()) as f64;
            within(&format!("{name}, σ = {sigma}"), truth.distance(&Dense::product_of(ltdl.factors())), 4.0 * terms * f64::EPSILON);
            if sigma == 0.0 {
                assert_eq!(ltdl.factors(), m.clone().into_ltdl().unwrap().factors(), "{name}: nothing is added");
            }
        }
    }
}

/// Up to 10⁻¹² of what makes M singular. The measure is of M: it is what rounding M itself does.
#[test]
fn a_downdate_gives_the_factors_of_the_difference_next_to_singular_matrices() {
    for (name, topology, dof, vectors) in cases() {
        let m = matrix::<f64>(&topology, 7);
        let largest = limit(&m, &topology, dof, &vectors);
        for left in [0.9, 1e-3, 1e-6, 1e-9, 1e-12] {
            let sigma = largest * (1.0 - left);
            let mut ltdl = m.clone().into_ltdl().unwrap();
            ltdl.downdate(dof, sigma, &vectors).unwrap();
            assert!(ltdl.factors().diagonal().all(|pivot| pivot > 0.0), "{name}");
            let truth = changed(&m, &topology, dof, -sigma, &vectors);
            let scale = Dense::of(&m);
            let product = Dense::product_of(ltdl.factors());
            let error = Dense::from_fn(scale.n, |i, j| scale.at(i, j) + product.at(i, j) - truth.at(i, j));
            let rank = vectors.len() / topology.dof_depth(dof);
            let terms = (rank * topology.dof_depth(dof) + topology.nv()) as f64;
            within(&format!("{name}, {left} left"), scale.distance(&error), 4.0 * terms * f64::EPSILON);
        }
    }
}

/// A vector that is added and taken away leaves the factors, and so do a rank k and its vectors one by one.
#[test]
fn a_downdate_undoes_an_update() {
    for (name, topology, dof, vectors) in cases() {
        let before = matrix::<f64>(&topology, 7).into_ltdl().unwrap();
        let mut ltdl = before.clone();
        ltdl.update(dof, 0.5, &vectors).unwrap();
        let mut by_one = before.clone();
        for vector in vectors.chunks_exact(topology.dof_depth(dof)) {
            by_one.update(dof, 0.5, vector).unwrap();
        }
        assert_eq!(ltdl.factors(), by_one.factors(), "{name}");
        ltdl.downdate(dof, 0.5, &vectors).unwrap();
        let off = common::distance(ltdl.factors().values(), before.factors().values()) / common::largest(before.factors().values());
        // As above, twice; and M + σ w wᵀ is at most 2 n times as large as M.
        let terms = (vectors.len() + topology.nv()) as f64;
        within(&name, off, 16.0 * terms * f64::EPSILON);
        // Solutions use the changed factors.
        let (mut x, mut y) = (ltdl::sines(topology.nv()), ltdl::sines(topology.nv()));
        ltdl.solve(&mut x).unwrap();
        before.solve(&mut y).unwrap();
        within(&format!("{name}: solution"), common::distance(&x, &y) / common::largest(&y), 64.0 * terms * f64::EPSILON);
    }
}

/// What leaves no positive definite matrix is refused, with the dof at which the factorization of the difference fails. Then the factors are
/// as before, to the bit; also if earlier vectors were taken away, or if one lane of four fails.
#[test]
fn a_refused_change_leaves_the_factors() {
    let mut after_others = 0;
    for (name, topology, dof, vectors) in cases() {
        let m = matrix::<f64>(&topology, 7);
        let before = m.clone().into_ltdl().unwrap();
        let mut ltdl = before.clone();
        let depth = topology.dof_depth(dof);
        let first = limit(&m, &topology, dof, &vectors[..depth]);
        for factor in [1.001, 2.0, 1e6] {
            let sigma = first * factor;
            let Err(Error::NotPositiveDefinite(error)) = ltdl.downdate(dof, sigma, &vectors[..depth]) else { panic!("{name}") };
            let difference = changed(&m, &topology, dof, -sigma, &vectors[..depth]);
            let mut exact = Ltdl::new(&topology);
            let truth = exact.run(&TreeSparse::from_fn(&topology, |i, j| difference.at(i, j)));
            let Err(Error::NotPositiveDefinite(truth)) = truth else { panic!("{name}") };
            assert_eq!(error.dof, truth.dof, "{name}");
            // s⁻ is the product of the ratios of the pivots below. It is a difference of numbers up to 1, and divides.
            let below = topology.row_dofs(dof).iter().filter(|&&below| below > error.dof);
            let s: f64 = below.map(|&k| exact.factors().get(k, k).to_f64() / before.factors().get(k, k)).product();
            let scale = (error.pivot.abs() + before.factors().get(error.dof, error.dof)) / s;
            within(&format!("{name}: pivot"), (error.pivot - truth.pivot).abs() / scale, 4.0 * topology.nv() as f64 * f64::EPSILON);
            assert!(error.pivot <= 0.0 && ltdl.factors() == before.factors(), "{name}");
        }
        // The last vector is what is too much.
        if vectors.len() > depth {
            let mut scaled = vectors.clone();
            let last = scaled.len() - depth;
            scaled[..last].iter_mut().for_each(|w| *w *= 1e-3);
            assert!(matches!(
                ltdl.downdate(dof, 1.5 * limit(&m, &topology, dof, &vectors[last..]), &scaled),
                Err(Error::NotPositiveDefinite(_))
            ));
            assert_eq!(ltdl.factors(), before.factors(), "{name}: after other vectors");
            after_others += 1;
        }
        for bad in [f64::NAN, f64::INFINITY] {
            let mut spoilt = vectors.clone();
            spoilt[0] = bad;
            if bad.is_nan() {
                assert!(ltdl.update(dof, 1.0, &spoilt).is_err(), "{name}");
            }
            assert!(ltdl.downdate(dof, 1.0, &spoilt).is_err(), "{name}");
            assert_eq!(ltdl.factors(), before.factors(), "{name}: {bad}");
        }
        let lanes: Vec<f64x4> = vectors[..depth].iter().map(|w| f64x4::new([0.0, 0.01 * w, *w, 0.0])).collect();
        let mut fours = matrix::<f64x4>(&topology, 7).into_ltdl().unwrap();
        let kept = fours.factors().clone();
        assert!(fours.downdate(dof, f64x4::splat(2.0 * first), &lanes).is_err(), "{name}: lane 2");
        assert_eq!(fours.factors(), &kept, "{name}");
    }
    assert!(after_others > 20, "{after_others}");
}

/// The text is one for all scalars: a lane has the numbers of its state, a dual the derivative.
#[test]
fn every_scalar_is_changed_alike() {
    for (name, topology, dof, vectors) in cases() {
        let counted: Vec<Counted> = common::lifted(&vectors);
        let mut slow = matrix::<Counted>(&topology, 7).into_ltdl().unwrap();
        let mut fours = matrix::<f64x4>(&topology, 7).into_ltdl().unwrap();
        let lanes: Vec<f64x4> = vectors.iter().map(|w| f64x4::new([-w, *w, 0.0, 2.0 * w])).collect();
        let sigma = f64x4::new([1.0, 0.25, 1e3, 1.0]);
        fours.update(dof, sigma, &lanes).unwrap();
        slow.update(dof, Counted(0.25), &counted).unwrap();
        let lane = |of: &Ltdl<f64x4>, k: usize| of.factors().values().iter().map(|x| x.to_array()[k]).collect::<Vec<_>>();
        let (found, expected) = (lane(&fours, 1), plain(slow.factors().values()));
        // The factors of lanes are products with 1/D: a rounding more for each dof of a path, before and in the change.
        let roundings = 4.0 * (topology.nv() + vectors.len()) as f64;
        within(&format!("{name}: lane"), common::distance(&found, &expected) / common::largest(&expected), roundings * f64::EPSILON);

        // d/dσ by a dual: (M + σ w wᵀ)' = Σ w wᵀ, and xᵀMx has the derivative Σ (wᵀx)².
        let mut dual = matrix::<Dual<f64>>(&topology, 7).into_ltdl().unwrap();
        let w: Vec<Dual<f64>> = common::lifted(&vectors);
        dual.update(dof, Dual::new(0.25, 1.0), &w).unwrap();
        let mut x: Vec<Dual<f64>> = common::lifted(&ltdl::sines(topology.nv()));
        dual.multiply_root(&mut x).unwrap();
        let derivative: f64 = x.iter().map(|x| 2.0 * x.value * x.derivative).sum();
        let path = topology.row_dofs(dof);
        let along = |w: &[f64]| w.iter().zip(path).map(|(w, &dof)| w * ltdl::sines(topology.nv())[dof]).sum::<f64>().powi(2);
        let expected: f64 = vectors.chunks_exact(path.len()).map(along).sum();
        let size: f64 = x.iter().map(|x| 2.0 * (x.value * x.derivative).abs()).sum();
        within(
            &format!("{name}: derivative"),
            (derivative - expected).abs() / size,
            16.0 * (topology.nv() + vectors.len()) as f64 * f64::EPSILON,
        );
    }
}

/// An update or a downdate.
type Change = fn(&mut Ltdl<Counted>, usize, Counted, &[Counted]) -> Result<(), Error>;

#[test]
fn counts() {
    fn count(depth: u64, rank: u64, change: Change) -> Operations {
        // A chain of the path, and dofs off it that cost nothing.
        let topology = tree((0..depth as i64).map(|body| body - 1).chain([0, -1]));
        let mut ltdl = matrix::<Counted>(&topology, 7).into_ltdl().unwrap();
        let vectors = vec![Counted(0.01); (rank * depth) as usize];
        Counted::count(|| change(&mut ltdl, depth as usize - 1, Counted(0.1), &vectors).unwrap())
    }
    for (d, k) in [(1_u64, 1_u64), (2, 1), (7, 1), (36, 1), (36, 6)] {
        let pairs = d * (d - 1) / 2;
        let expected = Operations {
            fused: 3 * k * pairs,
            multiplications: k * (6 * d + pairs),
            divisions: 5 * k * d,
            additions: k * d,
            ..Operations::default()
        };
        assert_eq!(count(d, k, Ltdl::update), expected, "update, {d}, {k}");
        let expected = Operations { multiplications: 6 * k * d, additions: 2 * k * d, ..expected };
        assert_eq!(count(d, k, Ltdl::downdate), expected, "downdate, {d}, {k}");
    }
}

#[test]
fn shapes_are_checked() {
    let mut ltdl = matrix::<f64>(&tree([-1, 0, 1, 0]), 7).into_ltdl().unwrap();
    let refusal = |result: Result<(), Error>| match result {
        Err(Error::Dimension(DimensionError { what, expected, found })) => (what, expected, found),
        other => panic!("{other:?}"),
    };
    assert_eq!(refusal(ltdl.update(4, 1.0, &[0.0])), ("dofs, for the one that was named", 5, 4));
    assert_eq!(refusal(ltdl.downdate(usize::MAX, 1.0, &[])), ("dofs, for the one that was named", usize::MAX, 4));
    assert_eq!(refusal(ltdl.update(2, 1.0, &[0.0; 4])), ("numbers of the vectors along the path", 6, 4));
    assert_eq!(refusal(ltdl.update(3, 1.0, &[0.0])), ("numbers of the vectors along the path", 2, 1));
    let before = ltdl.factors().clone();
    ltdl.update(2, 1.0, &[]).unwrap();
    assert_eq!(ltdl.factors(), &before, "rank 0");
    // A negative σ makes an update a downdate.
    let error = ltdl.update(2, -1e9, &[1.0, 0.0, 0.0]).unwrap_err();
    assert!(matches!(error, Error::NotPositiveDefinite(NotPositiveDefinite { dof: 0, pivot }) if pivot < 0.0));
}
