//! Impact laws: Kane's printed numbers, energy, and sequences of simultaneous impacts.

use featherbench_contact::impact::{Law, NoImpact, impact, orders, sequence};
use featherbench_contact::systems::{Cradle, Kane, PainleveRod, Stack};
use featherbench_contact::{Contact, Level, Problem};
use nalgebra::{DMatrix, DVector};

fn gain(kane: &Kane, law: Law) -> f64 {
    let problem = kane.problem().unwrap();
    100.0 * impact(&problem, law).unwrap().energy / problem.free_energy().unwrap()
}

#[test]
fn kanes_numbers() {
    let kane = Kane::default();
    let problem = kane.problem().unwrap();
    let (g, b) = (problem.delassus(), problem.free());
    for (found, page) in
        [(b[0], -0.134202014), (b[1], -0.267174343), (g[(0, 0)], 1.00956029), (g[(0, 1)], 1.52130866), (g[(1, 1)], 2.44033805)]
    {
        assert!((found - page).abs() < 1e-8, "{found} {page}");
    }
    let end = impact(&problem, Law::Newton).unwrap();
    assert!((end.impulses[0] - 0.56797988).abs() < 1e-8 && (end.impulses[1] + 0.244596591).abs() < 1e-8);
    for (restitution, friction, law, page) in [
        (0.5, 0.5, Law::Newton, 58.7495),
        (0.7, 0.5, Law::Newton, 175.76),
        (0.9, 0.5, Law::Newton, 219.87),
        (0.0, 0.5, Law::Newton, -48.6397),
        (1.0, 0.0, Law::Newton, 0.0),
        (0.5, 0.5, Law::Poisson, -45.4922),
        (0.5, 0.5, Law::Stronge, -44.6812),
    ] {
        let found = gain(&Kane { restitution, friction, ..kane }, law);
        assert!((found - page).abs() < 0.006, "{} e={restitution} μ={friction}: {found}", law.name());
    }
}

/// Poisson and Stronge by a second route: the impact as a differential equation, in small steps of normal impulse.
#[test]
fn processes_agree_with_small_steps() {
    let mut random = featherbench_robots::Random::named(5, "process");
    for _ in 0..60 {
        let friction = random.uniform(0.0, 1.2);
        let kane = Kane {
            angles: [random.uniform(0.1, 1.2), random.uniform(0.1, 1.2)],
            rates: [-random.uniform(0.1, 1.0), -random.uniform(0.1, 1.0)],
            friction,
            restitution: random.uniform(0.0, 1.0),
        };
        let problem = kane.problem().unwrap();
        for law in [Law::Poisson, Law::Stronge] {
            let end = impact(&problem, law).unwrap();
            let stepped = small_steps(&problem, law, kane.restitution, friction);
            // Steps of 1e-5 of the impulse, first order.
            assert!((&end.velocities - &stepped).amax() < 2e-4, "{} {kane:?}: {} {stepped}", law.name(), end.velocities);
            assert!(end.energy <= 1e-15, "{} creates energy", law.name());
        }
    }
}

fn small_steps(problem: &Problem, law: Law, e: f64, friction: f64) -> DVector<f64> {
    let (g, free) = (problem.delassus(), problem.free());
    let g = [[g[(0, 0)], g[(0, 1)]], [g[(1, 0)], g[(1, 1)]]];
    let (mut normal, mut slip) = (free[0], free[1]);
    let step = 1e-5 * -normal / g[0][0];
    let (mut impulse, mut work, mut compression) = (0.0, 0.0, None);
    loop {
        // Friction that stops the slip within this step, if the cone allows it.
        let stopping = (-(slip / step) - g[1][0]) / g[1][1];
        let ratio = stopping.clamp(-friction, friction);
        let next = normal + (g[0][0] + g[0][1] * ratio) * step;
        work += 0.5 * step * (normal + next);
        impulse += step;
        normal = next;
        slip += (g[1][0] + g[1][1] * ratio) * step;
        let ends = match compression {
            None if normal >= 0.0 => {
                compression = Some((impulse, work));
                e == 0.0
            }
            None => false,
            Some((compressed, _)) if law == Law::Poisson => impulse >= (1.0 + e) * compressed,
            Some((_, done)) => law == Law::Stronge && work >= done * (1.0 - e * e),
        };
        if ends {
            return DVector::from_vec(vec![normal, slip]);
        }
    }
}

/// Moreau's law with the same e in all rows creates no energy: ΔT = [λᵀ(c⁺ + e c⁻) − ½(1 − e) λᵀGλ]/(1 + e), and both parts are ≤ 0.
#[test]
fn moreau_creates_no_energy() {
    let mut random = featherbench_robots::Random::named(6, "moreau");
    let mut newton_gains = 0;
    for _ in 0..300 {
        let e = random.uniform(0.0, 1.0);
        let factor = DMatrix::from_fn(4, 4, |_, _| random.uniform(-1.0, 1.0));
        let matrix = &factor * factor.transpose();
        let free = DVector::from_fn(4, |row, _| if row % 2 == 0 { -random.unit() } else { random.uniform(-1.0, 1.0) });
        let contacts = (0..2).map(|k| Contact::planar(format!("{k}"), 0.6).with_restitution(e)).collect();
        let problem = Problem::from_delassus("drawn", Level::Impulse, contacts, matrix, free).unwrap();
        let Ok(end) = impact(&problem, Law::Moreau { tangential: e }) else { continue };
        assert!(end.energy <= 1e-12, "{}", end.energy);
        newton_gains += usize::from(impact(&problem, Law::Newton).is_ok_and(|end| end.energy > 1e-3));
    }
    assert!(newton_gains >= 3, "Newton's law gains energy in {newton_gains} of these draws");
}

/// Two light balls hit a heavy one from both sides. The orders end differently, mirrored.
#[test]
fn orders_disagree() {
    let cradle = Cradle { masses: vec![1.0, 3.0, 1.0], velocities: vec![1.0, 0.0, -1.0], restitution: 0.5 };
    let problem = cradle.problem().unwrap();
    let both = orders(&problem, Law::Newton, 100).unwrap();
    assert!(both.sequences.iter().all(|sequence| sequence.complete && sequence.end.energy < 0.0));
    let ends: Vec<Vec<f64>> = both.sequences.iter().map(|s| cradle.velocities_after(s.end.impulses.as_slice())).collect();
    let mirrored: Vec<f64> = ends[1].iter().rev().map(|v| -v).collect();
    assert!(ends[0].iter().zip(mirrored).all(|(a, b)| (a - b).abs() < 1e-13), "{ends:?}");
    // At once the heavy ball stays by symmetry.
    let at_once = cradle.velocities_after(impact(&problem, Law::Newton).unwrap().impulses.as_slice());
    assert!(at_once[1].abs() < 1e-15);
    // A cap that is too low says so.
    assert!(!sequence(&problem, Law::Newton, &[0, 1], 1).unwrap().complete);
    // Where only one contact closes at first, both orders are the same.
    let one = orders(&Cradle::default().problem().unwrap(), Law::Newton, 100).unwrap();
    assert!(one.disagreement < 1e-14 && one.sequences[0].history == [0, 1]);
}

/// What a law is not defined for is refused by name.
#[test]
fn laws_refuse_what_they_are_not_for() {
    let two = Cradle::default().problem().unwrap();
    for (problem, law, words) in [
        (&two, Law::Poisson, "takes one contact"),
        (&PainleveRod::default().problem().unwrap(), Law::Newton, "level of impulses"),
        (&Stack::two(1.0).problem().unwrap(), Law::Newton, "level of impulses"),
        (&two, Law::Moreau { tangential: 2.0 }, "tangential coefficient"),
    ] {
        let error = impact(problem, law).unwrap_err();
        assert!(matches!(error, NoImpact::Law { .. }) && error.to_string().contains(words), "{error}");
    }
    assert!(sequence(&two, Law::Newton, &[0, 0], 5).unwrap_err().to_string().contains("every contact once"));
}
