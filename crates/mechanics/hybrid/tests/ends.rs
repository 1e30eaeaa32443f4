//! How runs end: grazing, several guards at once, chains, caps; and events that hide within a step.

use featherbench_hybrid::systems::{BouncingBall, MovingTable, SlantedBox};
use featherbench_hybrid::{Cap, Direction, Hybrid, Run, Settings, Start, Status, simulate};
use featherbench_spatial::Real;
use std::f64::consts::{FRAC_PI_2, PI};

/// x runs with the rate 1; the guard is a polynomial of it with given roots; the reset keeps x, or moves it by θ.
struct Line {
    roots: Vec<f64>,
    direction: Direction,
}

impl Hybrid for Line {
    fn states(&self) -> usize {
        1
    }

    fn parameters(&self) -> usize {
        1
    }

    fn direction(&self, _: usize, _: usize) -> Direction {
        self.direction
    }

    fn flow<T: Real>(&self, _: usize, _: T, _: &[T], _: &[T], rate: &mut [T]) {
        rate[0] = T::one();
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], _: &[T]) -> T {
        self.roots.iter().fold(T::one(), |product, root| product * (x[0] - T::from_f64(*root)))
    }

    fn reset<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        after[0] = x[0] + theta[0];
    }
}

fn line(roots: &[f64], direction: Direction, to: f64) -> Run<f64> {
    let start = Start { mode: 0, time: 0.0, state: vec![0.0] };
    simulate(&Line { roots: roots.to_vec(), direction }, &[0.0], &start, to, &Settings::default()).unwrap()
}

fn times(run: &Run<f64>) -> Vec<f64> {
    run.events.iter().map(|event| event.time).collect()
}

/// Two crossings next to each other are both found, though g has the same sign at the ends of every step; down to the tolerance of grazing.
#[test]
fn pairs_of_crossings_do_not_hide() {
    let mut found = 0;
    for power in 1..=4 {
        let half = 10.0_f64.powi(-power);
        for centre in [0.313, 0.5, 0.77] {
            let roots = [centre - half, centre + half];
            for (direction, known) in [(Direction::Falling, &roots[..1]), (Direction::Rising, &roots[1..]), (Direction::Either, &roots[..])]
            {
                let run = line(&roots, direction, 1.0);
                assert_eq!((&run.status, run.events.len()), (&Status::Finished, known.len()), "{roots:?} {direction:?}");
                assert!(times(&run).iter().zip(known).all(|(time, root)| (time - root).abs() <= 1e-12), "{roots:?} {:?}", times(&run));
                found += 1;
            }
        }
    }
    assert_eq!(found, 36);
}

/// g = (x − c)² + d: above the tolerance nothing, within it grazing on either side, below it two crossings.
#[test]
fn grazing_is_its_own_status() {
    let run = line(&[0.4, 0.4], Direction::Falling, 1.0);
    assert!(matches!(run.status, Status::Grazing { guard: 0, value, .. } if value.abs() <= 1e-10), "{:?}", run.status);
    assert!((run.time - 0.4).abs() < 1e-6 && run.events.is_empty());
    // A half distance of 10⁻⁶ is a depth of 10⁻¹²; 10⁻⁴ is one of 10⁻⁸.
    let run = line(&[0.4 - 1e-6, 0.4 + 1e-6], Direction::Falling, 1.0);
    assert_eq!(run.status.name(), "grazing");
    let run = line(&[0.4 - 1e-4, 0.4 + 1e-4], Direction::Falling, 1.0);
    assert_eq!((run.status.name(), run.events.len()), ("finished", 1));
    // A triple root crosses with ġ = 0.
    let run = line(&[0.4, 0.4, 0.4], Direction::Rising, 1.0);
    assert_eq!(run.status.name(), "grazing");
}

/// 300 drawn throws whose apex is near a ceiling, from far below to far above: none is passed over. Between the two tolerances either
/// report is right.
#[test]
fn no_drawn_throw_is_passed_over() {
    let mut random = featherbench_robots::Random::named(8, "ceiling");
    let settings = Settings::default();
    let mut seen = std::collections::BTreeMap::new();
    for _ in 0..300 {
        let (gravity, speed) = (random.uniform(1.0, 20.0), random.uniform(0.5, 6.0));
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let depth = sign * 10.0_f64.powf(random.uniform(-14.0, -2.0));
        let ceiling = speed * speed / (2.0 * gravity) - depth;
        let start = Start { mode: 0, time: 0.0, state: vec![0.0, 0.0, random.uniform(-2.0, 2.0), speed] };
        let theta = [gravity, 0.8, -FRAC_PI_2, -ceiling];
        let to = random.uniform(1.1, 3.0) * speed / gravity;
        let run = simulate(&SlantedBox { walls: 1 }, &theta, &start, to, &settings).unwrap();
        *seen.entry(run.status.name()).or_insert(0) += 1;
        // The height is good to a few ulps of itself, and the dense output to a tenth of the tolerance.
        let (value, margin) = (settings.grazing_value, 0.2 * settings.grazing_value);
        if depth < -(value + margin) {
            assert!(run.status == Status::Finished && run.events.is_empty(), "{depth:e}: {:?}", run.status);
        } else if depth.abs() < value - margin {
            assert_eq!(run.status.name(), "grazing", "{depth:e}");
        } else if depth > value + margin {
            // √(2g·10⁻¹⁰) is above the tolerance of the rate.
            assert_eq!((run.status.name(), run.events.len()), ("finished", 1), "{depth:e}");
            let rate = (2.0 * gravity * depth).sqrt();
            let known = (speed - rate) / gravity;
            // An error of 4 ulps in the height, as a time.
            let due = 4.0 * f64::EPSILON * (1.0 + ceiling) / rate;
            assert!((run.events[0].time - known).abs() <= due.max(1e-12), "{depth:e}: {:e} {due:e}", run.events[0].time - known);
        }
    }
    println!("{seen:?}");
    assert!(seen.len() == 2 && seen.values().all(|count| *count > 50), "{seen:?}");
}

/// A guard may move faster than the state. The flow of a ball is a parabola, for which any step is exact; its table moves up and down many
/// times within such a step. The first contact is that of a scan of the closed form in steps of a thousandth of the table's period.
#[test]
fn a_fast_guard_is_resolved() {
    let mut random = featherbench_robots::Random::named(9, "fast table");
    let mut impacts = 0;
    for _ in 0..60 {
        let (gravity, height, frequency) = (random.uniform(2.0, 12.0), random.uniform(0.2, 1.0), random.uniform(30.0, 400.0));
        let amplitude = random.uniform(0.01, 0.1) * height;
        let theta = [gravity, 0.5, amplitude, frequency];
        let start = Start { mode: 0, time: 0.0, state: vec![height, 0.0] };
        let to = (2.0 * (height + amplitude) / gravity).sqrt();
        let run = simulate(&MovingTable, &theta, &start, to, &Settings { events: 1, ..Settings::default() }).unwrap();
        let gap = |t: f64| height - 0.5 * gravity * t * t - amplitude * (frequency * t).sin();
        let step = 1e-3 * std::f64::consts::TAU / frequency;
        let known = (1..).map(|k| f64::from(k) * step).find(|t| gap(*t) <= 0.0).unwrap();
        let first = run.events.first().map_or(run.time, |event| event.time);
        assert!(first <= known && first >= known - step, "Ω = {frequency}, A = {amplitude}: {first} {known} {:?}", run.status);
        impacts += run.events.len();
    }
    assert!(impacts > 50, "{impacts}");
}

/// A ball into a corner of a given opening, along its bisector.
fn corner(opening: f64, settings: &Settings) -> Run<f64> {
    // The walls have the directions 0 and `opening`; their normals point inside.
    let theta = [0.0, 1.0, FRAC_PI_2, 0.0, opening - FRAC_PI_2, 0.0];
    let (sine, cosine) = (0.5 * opening).sin_cos();
    let start = Start { mode: 0, time: 0.0, state: vec![cosine, sine, -cosine, -sine] };
    simulate(&SlantedBox { walls: 2 }, &theta, &start, 2.0, settings).unwrap()
}

/// Two walls at once. In a right angle both orders end alike. For other openings the orders differ, and the run does not choose.
#[test]
fn corners_are_met_in_both_orders() {
    let settings = Settings::default();
    let run = corner(FRAC_PI_2, &settings);
    assert_eq!((run.status.name(), run.simultaneous.len(), run.events.len()), ("finished", 1, 2));
    let both = &run.simultaneous[0];
    assert_eq!((&both.guards, &both.ascending.guards, &both.descending.guards), (&vec![0, 1], &vec![0, 1], &vec![1, 0]));
    assert!((both.time - 1.0).abs() <= 1e-12 && both.disagreement < 1e-12);
    let back = [0.5_f64.sqrt(); 4];
    assert!(run.state.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", run.state);

    let opening = 1.2;
    let run = corner(opening, &settings);
    assert_eq!((run.status.name(), run.simultaneous.len()), ("ambiguous", 1));
    let both = &run.simultaneous[0];
    // The direction π + β/2 is reflected at walls of the directions 0 and β, until it leads away from both.
    let reflected = |walls: [f64; 3]| walls.iter().fold(PI + 0.5 * opening, |angle, wall| 2.0 * wall - angle);
    let (ascending, descending) = (reflected([0.0, opening, 0.0]), reflected([opening, 0.0, opening]));
    for (order, guards, angle) in [(&both.ascending, [0, 1, 0], ascending), (&both.descending, [1, 0, 1], descending)] {
        assert!(order.complete && order.guards == guards, "{:?}", order.guards);
        let (sine, cosine) = angle.sin_cos();
        assert!((order.state[2] - cosine).abs() < 1e-12 && (order.state[3] - sine).abs() < 1e-12, "{:?} {cosine} {sine}", order.state);
    }
    let difference = (ascending.cos() - descending.cos()).abs().max((ascending.sin() - descending.sin()).abs());
    assert!(both.disagreement > 0.3 * difference && both.disagreement <= difference);
    // A chain that may have one event only is not complete, so its order is not known.
    let run = corner(opening, &Settings { chain: 1, ..settings });
    assert!(run.simultaneous[0].disagreement.is_infinite() && run.status == Status::Ambiguous);
}

/// Simultaneous means within the tolerance of time. A wall that is moved by d is met d/cos 45° later.
#[test]
fn walls_met_one_after_another() {
    for (shift, reports) in [(1e-13, 1), (1e-11, 0), (1e-6, 0)] {
        let theta = [0.0, 1.0, FRAC_PI_2, 0.0, 0.0, -shift];
        let half = 0.5_f64.sqrt();
        let start = Start { mode: 0, time: 0.0, state: vec![half, half, -half, -half] };
        let run = simulate(&SlantedBox { walls: 2 }, &theta, &start, 2.0, &Settings::default()).unwrap();
        assert_eq!((run.status.name(), run.events.len(), run.simultaneous.len()), ("finished", 2, reports), "{shift:e}");
        assert!((run.events[1].time - run.events[0].time - shift / half).abs() <= 1e-12, "{shift:e}");
    }
}

/// Two modes that hand over to each other at x = ½, for ever.
struct Hesitant;

impl Hybrid for Hesitant {
    fn states(&self) -> usize {
        1
    }

    fn parameters(&self) -> usize {
        0
    }

    fn modes(&self) -> usize {
        2
    }

    fn direction(&self, _: usize, _: usize) -> Direction {
        Direction::Rising
    }

    fn flow<T: Real>(&self, _: usize, _: T, _: &[T], _: &[T], rate: &mut [T]) {
        rate[0] = T::one();
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], _: &[T]) -> T {
        x[0] - T::from_f64(0.5)
    }

    fn target(&self, mode: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize {
        1 - mode
    }
}

/// Each cap is reached, and is the status.
#[test]
fn no_cap_is_silent() {
    let settings = Settings::default();
    let start = Start { mode: 0, time: 0.0, state: vec![0.0] };
    let run = simulate(&Hesitant, &[], &start, 1.0, &Settings { chain: 7, ..settings }).unwrap();
    // One crossing, and seven at its instant.
    assert_eq!((&run.status, run.events.len()), (&Status::Capped(Cap::Chain), 8));
    assert!(run.events.iter().all(|event| (event.time - 0.5_f64).abs() < 1e-15));
    let saw = Line { roots: vec![0.5], direction: Direction::Rising };
    let run = |settings| simulate(&saw, &[-1.0], &start, 10.0, &settings).unwrap();
    // One that leads back fires every second.
    let capped = run(Settings { events: 4, ..settings });
    assert_eq!((&capped.status, capped.events.len()), (&Status::Capped(Cap::Events), 4));
    assert!(times(&capped).iter().zip([0.5, 1.5, 2.5, 3.5]).all(|(a, b)| (a - b).abs() <= 1e-12));
    let short = run(Settings { steps: 3, ..settings });
    assert!(short.status == Status::Capped(Cap::Steps) && short.time < 10.0);
    let names = [Status::<f64>::Finished.name(), Status::<f64>::Capped(Cap::Steps).name(), Status::<f64>::Ambiguous.name()];
    assert_eq!(names, ["finished", "capped", "ambiguous"]);
}

/// An event right at the end belongs to the run; a run of no length has none. A reset that keeps the state lets the flow pass.
#[test]
fn the_ends_of_time() {
    let run = line(&[1.0], Direction::Rising, 1.0);
    assert_eq!((&run.status, run.events.len()), (&Status::Finished, 1));
    assert!((run.time - 1.0_f64).abs() <= 1e-15);
    let run = line(&[0.3], Direction::Rising, 0.0);
    assert!(run.status == Status::Finished && run.records.is_empty() && run.time == 0.0);
    // On a guard at the beginning: it fires if the flow goes through, and not if it leaves.
    let run = line(&[0.0], Direction::Rising, 1.0);
    assert_eq!((&run.status, run.events.len()), (&Status::Finished, 1));
    // A few steps of some ulps each.
    assert!((run.state[0] - 1.0).abs() <= 1e-14);
    assert!(line(&[0.0], Direction::Falling, 1.0).events.is_empty());
    assert!(line(&[0.0], Direction::Either, 1.0).events.is_empty());
}

/// Without restitution the ball stays on the guard, for which this system has no mode: that is grazing, not a fall through the ground.
#[test]
fn a_ball_that_stays_is_reported() {
    let start = Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] };
    let run = simulate(&BouncingBall, &[9.81, 0.0], &start, 1.0, &Settings::default()).unwrap();
    assert!(matches!(run.status, Status::Grazing { guard: 0, value, .. } if value.abs() < 1e-14), "{:?}", run.status);
    // From rest a height of rounding, 10⁻¹⁷ m, is a fall of 10⁻⁹ s.
    assert!((run.time - (2.0_f64 / 9.81).sqrt()).abs() < 1e-8 && run.state[1].abs() < 1e-7, "{} {:?}", run.time, run.state);
}
