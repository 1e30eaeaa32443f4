//! A proof that there is no solution is never false: problems whose solution is known exactly, and problems that have none, over 24 decades.

use crate::share::one_of;
use featherbench_contact::systems::{Answers, PainleveRod};
use featherbench_contact::{Contact, Enumeration, Lemke, Level, Mechanism, Problem, Solution, Solver};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector};

/// Draws of each kind at night, of which one in ten by day.
const DRAWS: usize = 4000;

fn draws() -> impl Iterator<Item = usize> {
    let part = one_of(10);
    (0..DRAWS).step_by(part)
}

fn both(problem: &Problem) -> [(&'static str, Solution); 2] {
    let solvers: [Box<dyn Solver>; 2] = [Box::new(Lemke::default()), Box::new(Enumeration::default())];
    solvers.map(|solver| (solver.name(), solver.solve(problem).unwrap()))
}

fn decades(random: &mut Random, of: f64) -> f64 {
    10_f64.powf(random.uniform(-0.5 * of, 0.5 * of))
}

/// An integer within ±`most`.
fn integer(random: &mut Random, most: usize) -> f64 {
    random.below(2 * most + 1) as f64 - most as f64
}

/// A row of normals against each other: masses of a line between two walls, pressed together.
fn line(random: &mut Random, masses: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
    let count = masses.len();
    let walls = 1 + random.below(2);
    let jacobian = DMatrix::from_fn(count - 1 + walls, count, |row, column| match column as isize - row as isize {
        0 => 1.0,
        -1 => -1.0,
        _ => 0.0,
    });
    (DMatrix::from_diagonal(&DVector::from_row_slice(masses)), jacobian)
}

/// A mechanism without restitution, whose contacts do not have a given direction of sliding, always has a solution. At rest all of its
/// contacts obey Signorini's law, so its velocities have a point of least energy. With friction Lemke's theorem has it.
#[test]
fn a_mechanism_always_has_a_solution() {
    let mut random = Random::named(1, "mechanisms over 24 decades");
    let mut found = [0, 0];
    for number in draws() {
        let problem = if number % 20 < 10 {
            let count = 1 + random.below(4);
            let masses: Vec<f64> = (0..count).map(|_| decades(&mut random, 24.0)).collect();
            let (mass, jacobian) = line(&mut random, &masses);
            let free = DVector::from_fn(count, |_, _| random.uniform(-1.0, 1.0));
            let contacts = (0..jacobian.nrows()).map(|k| Contact::frictionless(format!("{k}"))).collect();
            Problem::from_mechanism("line", Level::Impulse, contacts, Mechanism { mass, jacobian, free })
        } else {
            // Any planar contacts, whose rows are often dependent.
            let (dofs, count) = (2 + random.below(2), 1 + random.below(3));
            let mass = DMatrix::from_diagonal(&DVector::from_fn(dofs, |_, _| decades(&mut random, 24.0)));
            let jacobian = DMatrix::from_fn(2 * count, dofs, |_, _| integer(&mut random, 1));
            let free = DVector::from_fn(dofs, |_, _| random.uniform(-1.0, 1.0));
            let contacts = (0..count).map(|k| Contact::planar(format!("{k}"), random.uniform(0.0, 2.0))).collect();
            Problem::from_mechanism("any", Level::Impulse, contacts, Mechanism { mass, jacobian, free })
        };
        let problem = problem.unwrap();
        for (count, (name, solution)) in found.iter_mut().zip(both(&problem)) {
            assert_ne!(solution.status(), "no_solution", "{number}, {name}: {problem:?} {solution:?}");
            *count += usize::from(!solution.points().is_empty());
        }
    }
    let all = draws().count();
    assert!(2 * found[0] > all && 2 * found[1] > all, "{found:?} of {all} have an answer");
}

/// G and b of integers and powers of two, so that the constructed impulses obey the laws to the last bit, on masses of 1 to 10¹² kg.
#[test]
fn a_constructed_solution_is_not_denied() {
    let mut random = Random::named(2, "constructed");
    let mut found = [0, 0];
    for number in draws() {
        let (count, dofs) = (1 + random.below(3), 1 + random.below(4));
        let factor = DMatrix::from_fn(2 * count, dofs, |_, _| integer(&mut random, 1));
        let inverse = DVector::from_fn(dofs, |_, _| 2_f64.powi(-(random.below(41) as i32)));
        let matrix = &factor * DMatrix::from_diagonal(&inverse) * factor.transpose();
        let (mut impulses, mut velocities) = (DVector::zeros(2 * count), DVector::zeros(2 * count));
        let mut contacts = Vec::new();
        for contact in 0..count {
            let (n, t) = (2 * contact, 2 * contact + 1);
            let friction = [0.5, 1.0, 2.0, 4.0][random.below(4)];
            let side = [1.0, -1.0][random.below(2)];
            let sliding = random.below(2) == 0;
            let (force, speed) = (1.0 + random.below(3) as f64, random.below(3) as f64);
            match (sliding, random.below(3)) {
                (_, 0) => (velocities[n], velocities[t]) = (speed, integer(&mut random, 2)),
                (true, _) => (impulses[n], impulses[t], velocities[t]) = (force, -friction * side * force, integer(&mut random, 2)),
                (false, 1) => (impulses[n], impulses[t]) = (force, side * friction * force * 0.5),
                (false, _) => (impulses[n], impulses[t], velocities[t]) = (force, -friction * side * force, side * speed),
            }
            let name = format!("{contact}");
            contacts.push(if sliding { Contact::sliding(name, friction, side) } else { Contact::planar(name, friction) });
        }
        // Sums of 53 bits: 40 of the masses, and those of a few integers.
        let free = &velocities - &matrix * &impulses;
        let problem = Problem::from_delassus("constructed", Level::Force, contacts, matrix, free).unwrap();
        for (count, (name, solution)) in found.iter_mut().zip(both(&problem)) {
            assert_ne!(solution.status(), "no_solution", "{number}, {name}: {problem:?} {impulses} {solution:?}");
            *count += usize::from(!solution.points().is_empty());
        }
    }
    let all = draws().count();
    assert!(2 * found[0] > all && 2 * found[1] > all, "{found:?} of {all} have an answer");
}

/// Contacts that press against each other, and rods in Painlevé's paradox: no solver gives a number, and nearly all are proven.
#[test]
fn what_has_no_solution_is_proven_at_any_mass() {
    let mut random = Random::named(3, "without solution");
    let (mut proven, mut all) = ([0, 0], 0);
    for number in draws() {
        let scale = decades(&mut random, 24.0);
        let problem = if number % 20 < 10 {
            // A frictionless point between two walls that both come nearer, beside other contacts.
            let others = random.below(3);
            let dofs = 1 + others;
            let mass = DMatrix::from_diagonal(&DVector::from_fn(dofs, |_, _| decades(&mut random, 24.0)));
            let jacobian = DMatrix::from_fn(2 + others, dofs, |row, column| match (row, column) {
                (0, 0) => 1.0,
                (1, 0) => -1.0,
                (row, column) if row == column + 1 => 1.0,
                _ => 0.0,
            });
            let free = DVector::from_fn(dofs, |_, _| random.uniform(-1.0, 1.0));
            let contacts = (0..2 + others).map(|k| Contact::frictionless(format!("{k}")).with_restitution(0.5)).collect();
            let before = DVector::from_fn(2 + others, |_, _| -random.uniform(0.1, 1.0));
            let problem = Problem::from_mechanism("walls", Level::Impulse, contacts, Mechanism { mass, jacobian, free });
            problem.and_then(|problem| problem.with_before(before))
        } else {
            let rod = PainleveRod {
                mass: scale,
                friction: random.uniform(1.4, 3.0),
                angle: random.uniform(0.7, 1.5),
                rate: random.uniform(0.0, 3.0),
                ..PainleveRod::default()
            };
            if rod.answers() != Answers::None {
                continue;
            }
            rod.problem()
        };
        let problem = problem.unwrap();
        all += 1;
        for (count, (name, solution)) in proven.iter_mut().zip(both(&problem)) {
            assert!(solution.points().is_empty(), "{number}, {name}: {problem:?} {solution:?}");
            *count += usize::from(solution.status() == "no_solution");
        }
    }
    assert!(all > draws().count() / 2);
    assert!(proven.iter().all(|proven| 10 * proven > 9 * all), "{proven:?} of {all}");
}
