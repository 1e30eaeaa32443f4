//! Which parameters a body can have, and log-Cholesky numbers.

use featherbench_identification::{LogCholesky, PseudoInertia};
use featherbench_robots::Random;
use nalgebra::SVector;

/// A body of drawn numbers, over six decades of mass.
fn drawn(random: &mut Random) -> LogCholesky {
    LogCholesky(std::array::from_fn(|k| match k {
        0 => random.uniform(-3.0, 3.0),
        1..=3 => random.uniform(-3.0, -0.5),
        _ => random.uniform(-0.5, 0.5),
    }))
}

/// The solid ball, the rod and the point mass, by their textbook inertias.
#[test]
fn bodies_of_every_rank_are_consistent() {
    let (m, r) = (2.0, 0.3);
    let ball = 0.4 * m * r * r;
    let rod = m * 0.8 * 0.8 / 12.0;
    // A point at (1, 2, −1): h = m c, Ī = m (c·c 1 − c cᵀ).
    let point = [m, m, 2.0 * m, -m, 5.0 * m, -2.0 * m, m, 2.0 * m, 2.0 * m, 5.0 * m];
    for (pi, rank) in
        [([m, 0.0, 0.0, 0.0, ball, 0.0, 0.0, ball, 0.0, ball], 4), ([m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, rod, 0.0, rod], 2), (point, 1)]
    {
        let found = PseudoInertia::of(&pi).consistency();
        assert!(found.is_consistent() && found.rank == rank, "{pi:?}: {found:?}");
    }
    // Σ of the ball is m r²/5 in each direction.
    assert!((PseudoInertia::of(&[m, 0.0, 0.0, 0.0, ball, 0.0, 0.0, ball, 0.0, ball]).0[(1, 1)] - m * r * r / 5.0).abs() < 1e-15);
}

#[test]
fn bodies_that_cannot_exist_are_refused() {
    // Positive moments that break the triangle inequality: Σ = diag(1.5, 1.5, −0.5).
    let triangle = PseudoInertia::of(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 3.0]);
    assert_eq!([0, 1, 2].map(|k| triangle.0[(k, k)]), [1.5, 1.5, -0.5]);
    assert!(!triangle.consistency().is_consistent());
    // A centre of mass too far out for the inertia, and a negative mass.
    for pi in [
        [1.0, 1.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.1, 0.0, 0.1],
        [-1.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.1, 0.0, 0.1],
        [f64::NAN, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.1, 0.0, 0.1],
    ] {
        assert!(!PseudoInertia::of(&pi).consistency().is_consistent(), "{pi:?}");
        assert_eq!(LogCholesky::of(&pi), None, "{pi:?}");
    }
}

#[test]
fn log_cholesky_goes_there_and_back() {
    let mut random = Random::named(1, "log-Cholesky");
    for _ in 0..200 {
        let phi = drawn(&mut random);
        let pi = phi.parameters();
        let consistency = PseudoInertia::of(&pi).consistency();
        assert!(consistency.smallest > 0.0 && consistency.rank == 4, "{consistency:?}");
        let back = LogCholesky::of(&pi).unwrap().parameters();
        // Σ is the difference of entries of Ī: a few roundings of the largest entry of each kind.
        let (inertia, moment) = (pi[4].max(pi[7]).max(pi[9]), pi[0]);
        for (k, (there, back)) in pi.iter().zip(back).enumerate() {
            let size = if k < 4 { moment } else { inertia };
            assert!((there - back).abs() <= 1e-14 * size, "{k}: {there} {back}");
        }
    }
}

/// The Jacobian against extrapolated central differences, whose error is h⁴: some 1e-10 with rounding.
#[test]
fn the_jacobian_is_that_of_differences() {
    let mut random = Random::named(2, "log-Cholesky");
    for _ in 0..20 {
        let phi = drawn(&mut random);
        let jacobian = phi.jacobian();
        for column in 0..10 {
            let central = |h: f64| {
                let at = |step: f64| {
                    let mut moved = phi;
                    moved.0[column] += step;
                    moved.parameters()
                };
                let (up, down) = (at(h), at(-h));
                std::array::from_fn::<f64, 10, _>(|k| (up[k] - down[k]) / (2.0 * h))
            };
            let (fine, coarse) = (central(5e-4), central(1e-3));
            let size = jacobian.column(column).amax();
            for k in 0..10 {
                let extrapolated = (4.0 * fine[k] - coarse[k]) / 3.0;
                assert!((extrapolated - jacobian[(k, column)]).abs() < 1e-9 * size, "∂π{k}/∂φ{column}");
            }
        }
    }
}

/// U is linear in the s and t of φ: along them, the second difference of a cost tr(Λ P) with Λ ≽ 0 is twice what the rows say.
#[test]
fn the_curvature_is_that_of_differences() {
    let mut random = Random::named(3, "log-Cholesky");
    for _ in 0..20 {
        let (phi, lambda) = (drawn(&mut random), PseudoInertia::of(&drawn(&mut random).parameters()).0);
        let slope: [f64; 10] = std::array::from_fn(|k| {
            let unit = PseudoInertia::of(&std::array::from_fn(|other| if other == k { 1.0 } else { 0.0 }));
            (lambda * unit.0).trace()
        });
        let change: [f64; 10] = std::array::from_fn(|k| if k < 4 { 0.0 } else { random.uniform(-0.5, 0.5) });
        let cost = |part: f64| -> f64 {
            let moved = LogCholesky(std::array::from_fn(|k| phi.0[k] + part * change[k]));
            moved.parameters().iter().zip(&slope).map(|(pi, slope)| pi * slope).sum()
        };
        let difference = 0.5 * (cost(1.0) - 2.0 * cost(0.0) + cost(-1.0));
        let found = (phi.curvature(&slope) * SVector::from(change)).norm_squared();
        // A quadratic function: rounding of its values alone.
        assert!((difference - found).abs() <= 1e-13 * (cost(1.0) + cost(-1.0)), "{difference} {found}");
        // A slope that falls everywhere has nothing that adds to the cost.
        assert_eq!(phi.curvature(&slope.map(|slope| -slope)).norm(), 0.0);
    }
    assert_eq!(drawn(&mut random).curvature(&[f64::NAN; 10]).norm(), 0.0);
}
