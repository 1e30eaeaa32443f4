//! Every case with random numbers, at least 200 draws each: the solvers against enumeration in double-double arithmetic.

use featherbench_contact::library::{BoxOnBalls, Cradle, Feet, Incline, Kane, RockingBlock, Section, SlidingSphere, Stack, Table};
use featherbench_contact::{Admm, Contact, Enumeration, GaussSeidel, Lemke, Level, Newton, Problem, Solver};
use featherbench_robots::Random;
use nalgebra::{DMatrix, DVector};

const DRAWS: usize = 200;

/// How far an answer's velocities are from the nearest of all answers, in the problem's scale. Impulses need not be unique, velocities are.
fn distance(problem: &Problem, velocities: &DVector<f64>, all: &[featherbench_contact::Point]) -> f64 {
    let distances = all.iter().map(|point| (&point.velocities - velocities).amax() / problem.scales().velocity);
    distances.reduce(|a, b| if b < a { b } else { a }).unwrap()
}

/// Each draw by enumeration and by these solvers.
///
/// - A direct solver must answer with small residuals. Where the answer is unique, it must be that one. Where it is not, redundant rows
///   leave a family whose corners are enumerated, and the residuals are what shows that an answer is in it.
/// - A first-order solver may end at its cap, which it must then say; `capped` is the most draws in which it may.
fn compare(name: &str, solvers: &[&dyn Solver], capped: usize, mut draw: impl FnMut(&mut Random) -> Problem) {
    let mut random = Random::named(7, name);
    let (mut caps, mut unique) = (Vec::new(), 0);
    for number in 0..DRAWS {
        let problem = draw(&mut random);
        let all = Enumeration::default().solve(&problem).unwrap();
        assert!(!all.points().is_empty(), "{name} {number}: {all:?}");
        // Enumeration rounds its answers to f64: residuals are roundings of G λ.
        assert!(all.points().iter().all(|point| point.residuals.largest() <= 1e-10), "{name} {number}: {all:?}");
        unique += usize::from(all.point().is_some());
        for solver in solvers {
            let solution = solver.solve(&problem).unwrap();
            let first_order = ["gauss_seidel", "admm"].contains(&solver.name());
            let Some(point) = solution.point() else {
                assert!(first_order && solution.status() == "cap_reached", "{name} {number}: {} {solution:?}", solver.name());
                caps.push(solver.name());
                continue;
            };
            // A first-order solver ends at a natural-map residual of 1e-10; the energy and the cone have other units, up to 100 of them.
            let allowed = if first_order { 1e-8 } else { 1e-10 };
            assert!(point.residuals.largest() <= allowed, "{name} {number}: {} {:?}", solver.name(), point.residuals);
            // The velocity is then as far as the conditioning of G makes it.
            let allowed = if first_order { 1e-6 } else { 1e-9 };
            let found = distance(&problem, &point.velocities, all.points());
            assert!(found <= allowed || all.point().is_none(), "{name} {number}: {} is {found:e} from the answer", solver.name());
        }
    }
    println!("{name}: unique in {unique} of {DRAWS} draws, caps: {caps:?}");
    assert!(caps.len() <= capped, "{name}: {caps:?}");
}

const DIRECT: [&dyn Solver; 2] = [&Lemke { directions: 8, pivots: 10_000 }, &Newton { tolerance: 1e-12, steps: 500 }];

fn every() -> Vec<&'static dyn Solver> {
    const FIRST: [&dyn Solver; 2] =
        [&GaussSeidel { tolerance: 1e-10, sweeps: 20_000 }, &Admm { rho: None, tolerance: 1e-10, iterations: 20_000 }];
    DIRECT.into_iter().chain(FIRST).collect()
}

#[test]
fn kane() {
    // Gauss–Seidel never ends in six draws, all with μ|G_nt| > G_nn. Two more draws need more than this cap, one of them with ADMM too.
    compare("kane", &every(), 12, |random| {
        let kane = Kane {
            angles: [random.uniform(0.1, 1.3), random.uniform(0.1, 1.3)],
            rates: [-random.uniform(0.1, 1.0), -random.uniform(0.1, 1.0)],
            friction: random.uniform(0.0, 1.0),
            restitution: 0.0,
        };
        kane.problem().unwrap()
    });
}

#[test]
fn spheres() {
    compare("spheres", &every(), 0, |random| {
        let sphere = SlidingSphere {
            mass: random.uniform(0.1, 5.0),
            radius: random.uniform(0.05, 1.0),
            speed: random.uniform(-5.0, 5.0),
            friction: random.uniform(0.05, 1.0),
            duration: random.uniform(0.01, 2.0),
            ..SlidingSphere::default()
        };
        sphere.problem().unwrap()
    });
}

/// One round or elliptic cone, sliding or sticking: enumeration by the quartic, Newton's method in f64.
#[test]
fn inclines() {
    const SPATIAL: [&dyn Solver; 3] = [
        &Newton { tolerance: 1e-12, steps: 500 },
        &GaussSeidel { tolerance: 1e-10, sweeps: 20_000 },
        &Admm { rho: None, tolerance: 1e-10, iterations: 20_000 },
    ];
    compare("inclines", &SPATIAL, 0, |random| {
        let second = random.uniform(0.1, 1.0);
        let incline = Incline {
            angle: random.uniform(0.0, 1.3),
            friction: random.uniform(0.1, 1.0),
            section: if random.below(2) == 0 { Section::Round } else { Section::Elliptic(second) },
            heading: random.uniform(-3.0, 3.0),
            mass: random.uniform(0.1, 10.0),
            ..Incline::default()
        };
        incline.problem().unwrap()
    });
}

/// One round cone with any regular G.
#[test]
fn spatial_contacts() {
    const SPATIAL: [&dyn Solver; 1] = [&Newton { tolerance: 1e-12, steps: 500 }];
    compare("spatial", &SPATIAL, 0, |random| {
        let factor = DMatrix::from_fn(3, 3, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose() + DMatrix::identity(3, 3) * 0.1;
        let free = DVector::from_vec(vec![random.uniform(-1.0, 0.2), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]);
        Problem::from_delassus("spatial", Level::Impulse, vec![Contact::spatial("tip", random.uniform(0.1, 0.8))], matrix, free).unwrap()
    });
}

#[test]
fn tables() {
    compare("tables", &every(), 0, |random| {
        let half_side = random.uniform(0.2, 1.0);
        // The centre is within the square of the legs, often outside that of three of them.
        let centre = [random.uniform(-0.95, 0.95) * half_side, random.uniform(-0.95, 0.95) * half_side];
        Table { weight: random.uniform(1.0, 100.0), centre, half_side }.problem().unwrap()
    });
}

#[test]
fn stacks() {
    compare("stacks", &every(), 0, |random| {
        let count = 2 + random.below(4);
        Stack { masses: (0..count).map(|_| random.uniform(0.3, 3.0)).collect(), gravity: 9.81 }.problem().unwrap()
    });
}

#[test]
fn rocking_blocks() {
    compare("blocks", &DIRECT, 0, |random| {
        let block = RockingBlock {
            mass: random.uniform(0.1, 10.0),
            half_width: random.uniform(0.1, 1.0),
            half_height: random.uniform(0.1, 2.0),
            rate: random.uniform(0.1, 3.0),
            friction: random.uniform(0.05, 1.5),
        };
        block.problem().unwrap()
    });
}

#[test]
fn cradles() {
    compare("cradles", &every(), 0, |random| {
        let count = 2 + random.below(4);
        let masses = (0..count).map(|_| random.uniform(0.3, 3.0)).collect();
        let velocities = (0..count).map(|_| random.uniform(-1.0, 1.0)).collect();
        Cradle { masses, velocities, restitution: random.unit() }.problem().unwrap()
    });
}

/// Redundant rows with friction: the enumeration goes over the corners of families.
#[test]
fn boxes_on_two_balls() {
    compare("boxes", &[&Newton { tolerance: 1e-12, steps: 500 }], 0, |random| {
        let scene = BoxOnBalls {
            box_mass: random.uniform(1.0, 20.0),
            balls: 1 + random.below(2),
            ball_mass: random.uniform(0.2, 3.0),
            force: random.uniform(0.0, 40.0),
            ..BoxOnBalls::default()
        };
        scene.problem().unwrap()
    });
}

/// Flat feet that stick, slide, turn and tip: 12 rows of rank 6 each. Enumeration does not take them; the residuals judge.
#[test]
fn feet() {
    let mut random = Random::named(7, "feet");
    let mut slides = 0;
    for number in 0..DRAWS {
        let free = std::array::from_fn(|k| if k == 2 { -random.uniform(0.02, 0.2) } else { random.uniform(-0.3, 0.3) });
        let problem = Feet { count: 1 + random.below(2), friction: random.uniform(0.1, 1.0), free, ..Feet::default() }.problem().unwrap();
        let solution = Newton::default().solve(&problem).unwrap();
        let point = solution.point().unwrap_or_else(|| panic!("{number}: {}", solution.status()));
        assert!(point.residuals.largest() <= 1e-10, "{number}: {:?}", point.residuals);
        slides += usize::from(point.velocities.amax() > 1e-3);
    }
    assert!(slides > 50, "{slides}");
}

/// Two planar contacts with any G and b: where Lemke's method ends with an answer, it is one of all answers.
#[test]
fn planar_contacts() {
    compare("planar", &[&Lemke { directions: 8, pivots: 10_000 }], 0, |random| {
        let factor = DMatrix::from_fn(4, 4, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose();
        let free = DVector::from_fn(4, |_, _| random.uniform(-1.0, 1.0));
        let contacts = (0..2).map(|k| Contact::planar(format!("{k}"), random.uniform(0.0, 1.0))).collect();
        Problem::from_delassus("planar", Level::Impulse, contacts, matrix, free).unwrap()
    });
}
