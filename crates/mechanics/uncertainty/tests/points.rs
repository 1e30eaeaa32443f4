//! Sobol' points: each dimension and many planes are evenly filled, before and after scrambling.

use featherbench_uncertainty::{Error, Sobol};

/// Of 2^m points, each of the 2^m intervals has one, in every dimension: so the direction numbers are regular.
#[test]
fn every_dimension_is_stratified() {
    let sobol = Sobol::new(96, 3).unwrap();
    let count = 1_usize << 8;
    let mut unit = vec![0.0; 96];
    let mut seen = vec![vec![0_u32; count]; 96];
    let mut plain = vec![vec![0_u32; count]; 96];
    for k in 0..count {
        sobol.point(k as u64, &mut unit);
        for (d, u) in unit.iter().enumerate() {
            assert!(*u > 0.0 && *u < 1.0);
            seen[d][(u * count as f64) as usize] += 1;
        }
        for (d, bits) in sobol.plain(k as u64).into_iter().enumerate() {
            plain[d][(bits >> 24) as usize] += 1;
        }
    }
    assert!(seen.iter().chain(&plain).flatten().all(|hits| *hits == 1));
}

/// The second dimension is that of the polynomial x + 1 with m₁ = 1: its first points are 0, 1/2, 3/4, 1/4 in Gray order, here by index.
#[test]
fn the_first_two_dimensions_are_the_known_ones() {
    let sobol = Sobol::new(2, 1).unwrap();
    let points: Vec<[f64; 2]> = (0..4).map(|k| sobol.plain(k)).map(|p| [0, 1].map(|d| f64::from(p[d]) / 4_294_967_296.0)).collect();
    assert_eq!(points, [[0.0, 0.0], [0.5, 0.5], [0.25, 0.75], [0.75, 0.25]]);
    // They are a (0, 2)-sequence: of 2^m points one is in each box of area 2^−m.
    let m = 8;
    for a in 0..=m {
        let mut hits = vec![0; 1 << m];
        for k in 0..1 << m {
            let p = sobol.plain(k);
            hits[((p[0] as usize).checked_shr(32 - a).unwrap_or(0)) << (m - a) | (p[1] as usize).checked_shr(32 - (m - a)).unwrap_or(0)] +=
                1;
        }
        assert!(hits.iter().all(|h| *h == 1), "{a}");
    }
}

/// Scrambling keeps the boxes: a function of nested bits alone.
#[test]
fn scrambled_planes_keep_their_boxes() {
    let m = 8;
    for seed in 0..4 {
        let sobol = Sobol::new(2, seed).unwrap();
        let mut unit = [0.0; 2];
        for a in 0..=m {
            let mut hits = vec![0; 1 << m];
            for k in 0..1 << m {
                sobol.point(k, &mut unit);
                let place = |u: f64, bits: u32| (u * f64::from(1_u32 << bits)) as usize;
                hits[place(unit[0], a) << (m - a) | place(unit[1], m - a)] += 1;
            }
            assert!(hits.iter().all(|h| *h == 1), "{seed} {a}");
        }
    }
}

/// A scrambled point is uniform: over many seeds the first point has mean 1/2 and variance 1/12, within four standard errors.
#[test]
fn a_scrambled_point_is_uniform() {
    let count = 4000;
    let first = Sobol::new(3, 0).unwrap();
    let (mut sums, mut squares, mut unit) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    for seed in 0..count {
        first.with_seed(seed).point(5, &mut unit);
        for d in 0..3 {
            sums[d] += unit[d] - 0.5;
            squares[d] += (unit[d] - 0.5).powi(2);
        }
    }
    let n = count as f64;
    for d in 0..3 {
        assert!((sums[d] / n).abs() < 4.0 * (1.0 / 12.0 / n).sqrt(), "{d} {}", sums[d] / n);
        // The variance of (u − ½)² is 1/180.
        assert!((squares[d] / n - 1.0 / 12.0).abs() < 4.0 * (1.0 / 180.0 / n).sqrt(), "{d} {}", squares[d] / n);
    }
}

#[test]
fn too_many_dimensions_are_refused() {
    assert_eq!(Sobol::new(97, 1).unwrap_err(), Error::TooManyDimensions { found: 97, limit: 96 });
}
