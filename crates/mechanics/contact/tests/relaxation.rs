//! The convex relaxation: our Newton method against an accelerated projected gradient that shares no text with it.

use featherbench_contact::{Contact, Convex, Level, Newton, Problem, Solver};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Minimises ½ λᵀGλ + bᵀλ over the cones by Nesterov's accelerated gradient with restarts. `friction` is μ of every contact, of three rows.
fn accelerated(g: &DMatrix<f64>, b: &DVector<f64>, friction: f64) -> DVector<f64> {
    let step = 1.0 / SymmetricEigen::new(g.clone()).eigenvalues.max();
    let (mut x, mut y, mut t) = (DVector::zeros(b.len()), DVector::zeros(b.len()), 1.0_f64);
    for _ in 0..200_000 {
        let mut next: DVector<f64> = &y - (g * &y + b) * step;
        for contact in 0..b.len() / 3 {
            let (n, t1, t2) = (next[3 * contact], next[3 * contact + 1], next[3 * contact + 2]);
            let s = t1.hypot(t2);
            // The nearest point of the cone s ≤ μ n: itself, the tip, or on the edge along (1, μ).
            if s > friction * n {
                let along = (n + friction * s) / (1.0 + friction * friction);
                let along = if along > 0.0 { along } else { 0.0 };
                let factor = if s > 0.0 { friction * along / s } else { 0.0 };
                (next[3 * contact], next[3 * contact + 1], next[3 * contact + 2]) = (along, t1 * factor, t2 * factor);
            }
        }
        let change = &next - &x;
        if change.norm() <= 1e-16 * (1.0 + next.norm()) {
            return next;
        }
        let following = 0.5 * (1.0 + (1.0 + 4.0 * t * t).sqrt());
        if (&y - &next).dot(&change) > 0.0 {
            (t, y) = (1.0, next.clone());
        } else {
            y = &next + &change * ((t - 1.0) / following);
            t = following;
        }
        x = next;
    }
    x
}

/// Regular problems of one to four round contacts: the relaxation has one answer, and both methods find it.
#[test]
fn two_methods_find_the_same_answer() {
    let mut random = Random::named(10, "relaxation");
    for number in 0..200 {
        let count = 1 + random.below(4);
        let rows = 3 * count;
        let factor = DMatrix::from_fn(rows, rows, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose() + DMatrix::identity(rows, rows) * 0.2;
        let free = DVector::from_fn(rows, |_, _| random.uniform(-1.0, 0.5));
        let friction = random.uniform(0.1, 1.0);
        let contacts = (0..count).map(|k| Contact::spatial(format!("{k}"), friction)).collect();
        let problem = Problem::from_delassus("relaxed", Level::Impulse, contacts, matrix, free).unwrap();
        let solution = Convex::default().solve(&problem).unwrap();
        let point = solution.point().unwrap_or_else(|| panic!("{number}: {}", solution.status()));
        let known = accelerated(problem.delassus(), problem.free(), friction);
        // The gradient method ends when its steps are roundings; its error is that times the condition of G, at most 100.
        assert!((&point.impulses - &known).amax() < 1e-9, "{number}: {}", (&point.impulses - &known).amax());
        // c ∈ K*: c_n ≥ μ ‖c_t‖, which Coulomb's law does not ask for.
        for contact in 0..count {
            let c = point.velocities.rows(3 * contact, 3);
            assert!(c[0] >= friction * c[1].hypot(c[2]) - 1e-11, "{number}");
        }
    }
}

/// Several round contacts under the true laws: every Newton answer has small residuals, and the other solvers agree where they end.
#[test]
fn newton_solves_several_round_contacts() {
    let mut random = Random::named(11, "round");
    let mut solved = 0;
    for number in 0..200 {
        let rows = 3 * (2 + random.below(3));
        let factor = DMatrix::from_fn(rows, rows, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose() + DMatrix::identity(rows, rows) * 0.2;
        let free = DVector::from_fn(rows, |_, _| random.uniform(-1.0, 0.5));
        let contacts = (0..rows / 3).map(|k| Contact::spatial(format!("{k}"), 0.5)).collect();
        let problem = Problem::from_delassus("round", Level::Impulse, contacts, matrix, free).unwrap();
        let solution = Newton::default().solve(&problem).unwrap();
        let Some(point) = solution.point() else { continue };
        assert!(point.residuals.largest() <= 1e-10, "{number}: {:?}", point.residuals);
        solved += 1;
    }
    println!("round contacts: Newton solved {solved} of 200");
    assert!(solved >= 190, "{solved} of 200");
}
