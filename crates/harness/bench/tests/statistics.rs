//! Conclusions from the blocks of a paired experiment, on machines with known noise.

use featherbench_bench::measure::worst;
use featherbench_bench::statistics::{CONTROL_LEVEL, EPOCHS, Estimate, LEVEL, Pace, draw, median, quantile, weighted_median};
use featherbench_robots::Random;
use featherbench_spatial::Real;

/// Rounds of an experiment: ten in each epoch.
const ROUNDS: usize = 10 * EPOCHS;
/// Experiments of each kind; the test counts those that are right.
const TRIALS: usize = 60;

/// The noise of a machine: factors on the two blocks of each round.
type Noise = fn(&mut Random, usize) -> [f64; 2];

/// A standard normal number (Box and Muller).
fn normal(random: &mut Random) -> f64 {
    let (radius, angle) = ((-2.0 * (1.0 - random.unit()).ln()).sqrt(), std::f64::consts::TAU * random.unit());
    radius * Real::sin_cos(angle).1
}

fn jitter(random: &mut Random, _: usize) -> [f64; 2] {
    [(); 2].map(|()| 1.0 + 0.02 * normal(random).abs())
}

/// One block in eight is interrupted, and takes up to three times as long.
fn interruptions(random: &mut Random, round: usize) -> [f64; 2] {
    let block = jitter(random, round);
    block.map(|time| if random.below(8) == 0 { time * random.uniform(1.1, 3.0) } else { time })
}

/// The machine becomes 40 % slower during the run.
fn drift(random: &mut Random, round: usize) -> [f64; 2] {
    jitter(random, round).map(|time| time * (1.0 + 0.4 * round as f64 / ROUNDS as f64))
}

/// Another program starts and stops: every seven rounds the frequency changes, or does not.
fn frequencies(random: &mut Random, round: usize) -> [f64; 2] {
    let slow = Random::new(5, round as u64 / 7).below(2) == 1;
    jitter(random, round).map(|time| if slow { 1.3 * time } else { time })
}

/// Each layout of the memory has its own factor for each of the two.
fn layouts(random: &mut Random, round: usize) -> [f64; 2] {
    let mut layout = Random::new(6, round as u64 / 10);
    jitter(random, round).map(|time| time * (1.0 + 0.01 * layout.unit()))
}

const MACHINES: [(&str, Noise); 5] =
    [("jitter", jitter), ("interruptions", interruptions), ("drift", drift), ("frequencies", frequencies), ("layouts", layouts)];

/// Reference and engine on a noisy machine; the engine is slower by this factor.
fn blocks(noise: Noise, slower: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random::new(seed, 7);
    let rounds = (0..ROUNDS).map(|round| {
        let [reference, engine] = noise(&mut random, round);
        (1000.0 * reference, 1000.0 * slower * engine)
    });
    rounds.unzip()
}

fn ratio(noise: Noise, slower: f64, seed: u64, level: f64) -> Estimate {
    let (reference, engine) = blocks(noise, slower, seed);
    Estimate::ratio(&engine, &reference, level, &mut Random::new(seed, 8))
}

fn count(trial: impl Fn(u64) -> bool) -> usize {
    (0..TRIALS as u64).filter(|&seed| trial(seed)).count()
}

#[test]
fn the_median_of_weights_is_the_median_of_the_samples_that_they_stand_for() {
    let mut random = Random::new(3, 0);
    for epochs in 1..12 {
        for epoch in 1..5 {
            // few values, so that many are equal
            let samples: Vec<f64> = (0..epochs * epoch).map(|_| random.below(9) as f64).collect();
            let mut sorted: Vec<(f64, usize)> = samples.iter().enumerate().map(|(k, &sample)| (sample, k / epoch)).collect();
            sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            for _ in 0..20 {
                let places: Vec<usize> = (0..epochs).map(|_| draw(&mut random, epochs)).collect();
                let mut taken = vec![0; epochs];
                places.iter().for_each(|&place| taken[place] += 1);
                let mut drawn: Vec<f64> = places.iter().flat_map(|&place| samples[epoch * place..epoch * (place + 1)].to_vec()).collect();
                assert_eq!(weighted_median(&sorted, &taken).to_bits(), median(&mut drawn).to_bits(), "{samples:?} {taken:?}");
            }
        }
    }
}

#[test]
fn five_percent_are_convicted_and_half_a_percent_is_not() {
    for (name, noise) in MACHINES {
        let found = |slower: f64, finding| count(|seed| ratio(noise, slower, seed, LEVEL).pace() == finding);
        assert_eq!(found(1.05, Pace::Slower), TRIALS, "{name}");
        assert_eq!(found(1.005, Pace::Alike), TRIALS, "{name}");
        assert_eq!(found(1.0, Pace::Alike), TRIALS, "{name}");
        assert_eq!(found(1.0 / 1.05, Pace::Faster), TRIALS, "{name}");
    }
}

#[test]
fn the_interval_holds_the_true_ratio_as_often_as_it_says() {
    for (name, noise) in MACHINES {
        let held = count(|seed| {
            let Estimate { value, low, high } = ratio(noise, 1.03, seed, LEVEL);
            assert!(low <= value && value <= high);
            low <= 1.03 && 1.03 <= high
        });
        // 95 % of 60 are 57 ± 1.7: three deviations below.
        assert!(held >= 52, "{name}: {held} of {TRIALS}");
    }
}

#[test]
fn chance_alone_does_not_void_a_run_and_a_noisy_machine_does() {
    for (name, noise) in MACHINES {
        let voided = count(|seed| ratio(noise, 1.0, seed, CONTROL_LEVEL).complaint().is_some());
        assert!(voided <= 1, "{name}: {voided} of {TRIALS}");
        let unseen = count(|seed| ratio(noise, 1.03, seed, CONTROL_LEVEL).complaint().is_none());
        assert_eq!(unseen, 0, "{name}: copies that differ by 3 %");
    }
    // Blocks that vary by a factor of two: the interval is wider than the noise allows.
    let wild: Noise = |random, _| [(); 2].map(|()| random.uniform(1.0, 2.0));
    assert_eq!(count(|seed| ratio(wild, 1.0, seed, CONTROL_LEVEL).complaint().is_some()), TRIALS);
}

/// Why ratios are formed within rounds: two medians may belong to different states of the machine.
#[test]
fn the_ratio_of_two_medians_would_be_misled_where_the_median_of_ratios_is_not() {
    let farthest = |of: fn(Vec<f64>, Vec<f64>) -> f64| {
        (0..TRIALS as u64)
            .map(|seed| {
                let (reference, engine) = blocks(frequencies, 1.0, seed);
                (of(engine, reference) - 1.0).abs()
            })
            .fold(0.0, worst)
    };
    let unpaired = farthest(|mut engine, mut reference| median(&mut engine) / median(&mut reference));
    let paired = farthest(|engine, reference| median(&mut engine.iter().zip(&reference).map(|(a, b)| a / b).collect::<Vec<_>>()));
    assert!(paired < 0.006 && unpaired > 2.0 * paired, "paired {paired}, unpaired {unpaired}");
}

#[test]
fn medians_and_intervals_of_few_samples() {
    assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
    assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
    let of = |samples: &[f64]| Estimate::median(samples, LEVEL, &mut Random::new(1, 1));
    assert_eq!(of(&[7.0; 40]), Estimate { value: 7.0, low: 7.0, high: 7.0 });
    assert_eq!(of(&[5.0]), Estimate { value: 5.0, low: 5.0, high: 5.0 });
    assert!(of(&[]).value.is_nan() && of(&[1.0, f64::NAN]).low.is_nan());
    let few = of(&[1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!(few.value == 3.0 && few.low <= 2.0 && few.high >= 4.0, "{few:?}");
    assert_eq!(of(&[1.0, 2.0, 3.0]), of(&[1.0, 2.0, 3.0]), "the same seed, the same interval");
    assert_eq!(Estimate { value: f64::NAN, low: f64::NAN, high: f64::NAN }.pace(), Pace::Alike);
    assert!(Estimate { value: f64::NAN, low: f64::NAN, high: f64::NAN }.complaint().is_some());
}

fn random() -> Random {
    Random::new(3, 9)
}

/// The same by the textbook: whole epochs drawn, medians by sorting, and the ends between the two neighbours.
fn by_the_book(samples: &[f64], epoch: usize, level: f64) -> [f64; 3] {
    let sorted = |mut numbers: Vec<f64>| {
        numbers.sort_by(|a, b| a.partial_cmp(b).unwrap());
        numbers
    };
    let middle = |numbers: Vec<f64>| {
        let (numbers, n) = (sorted(numbers.clone()), numbers.len());
        if n.is_multiple_of(2) { (numbers[n / 2 - 1] + numbers[n / 2]) / 2.0 } else { numbers[n / 2] }
    };
    let (mut random, epochs) = (random(), samples.len() / epoch);
    let mut resampled = Vec::new();
    for _ in 0..2000 {
        let mut drawn = vec![f64::NAN; epochs * epoch];
        for place in 0..epochs {
            let from = (f64::from(random.bits32()) / 4_294_967_296.0 * epochs as f64).floor() as usize;
            drawn[epoch * place..][..epoch].copy_from_slice(&samples[epoch * from..][..epoch]);
        }
        resampled.push(middle(drawn));
    }
    let resampled = sorted(resampled);
    let end = |share: f64| {
        let (whole, part) = ((share * 1999.0).floor(), (share * 1999.0).fract());
        resampled[whole as usize] + part * (resampled[(whole + 1.0).min(1999.0) as usize] - resampled[whole as usize])
    };
    [middle(samples.to_vec()), end((1.0 - level) / 2.0), end((1.0 + level) / 2.0)]
}

#[test]
fn an_interval_is_that_of_the_book() {
    // One round per epoch, two, two with a remainder that fills no epoch, and fewer rounds than epochs.
    for (rounds, epoch) in [(60, 1), (120, 2), (150, 2), (179, 2), (180, 3), (7, 1), (2, 1)] {
        let mut random_samples = Random::new(11, rounds as u64);
        let samples: Vec<f64> = (0..rounds).map(|_| random_samples.uniform(1.0, 2.0)).collect();
        for level in [LEVEL, CONTROL_LEVEL, 0.5] {
            let Estimate { value, low, high } = Estimate::median(&samples, level, &mut random());
            let due = by_the_book(&samples, epoch, level);
            for (found, due) in [value, low, high].into_iter().zip(due) {
                // The position of the ends between two medians is rounded in another order.
                assert!((found - due).abs() <= 1e-12, "{rounds} rounds at {level}: {found} is not {due}");
            }
        }
    }
}

/// Of two samples a and b, a quarter of the resamples has the median a, half of them (a + b)/2, a quarter b.
#[test]
fn the_interval_of_two_samples_is_known() {
    let ends = |level| {
        let Estimate { value, low, high } = Estimate::median(&[1.0, 3.0], level, &mut random());
        [value, low, high]
    };
    assert_eq!(ends(0.95), [2.0, 1.0, 3.0]);
    assert_eq!(ends(0.6), [2.0, 1.0, 3.0], "a fifth in each tail is less than a quarter");
    assert_eq!(ends(0.4), [2.0, 2.0, 2.0], "three tenths are more");
    assert_eq!(ends(0.0), [2.0, 2.0, 2.0]);
}

#[test]
fn a_ratio_is_formed_within_rounds() {
    // 2, 2, 3 and 0.5: the ratio of the medians, 5 over 1.5, is another.
    let ratio = Estimate::ratio(&[2.0, 4.0, 6.0, 6.0], &[1.0, 2.0, 2.0, 12.0], LEVEL, &mut random());
    assert_eq!((ratio.value, ratio.low >= 0.5, ratio.high <= 3.0), (2.0, true, true));
    assert!(Estimate::ratio(&[1.0, 1.0], &[1.0, f64::NAN], LEVEL, &mut random()).high.is_nan());
}

#[test]
fn every_place_is_drawn_alike() {
    let mut drawn = [0; 7];
    let (mut bits, mut draws) = (random(), random());
    for _ in 0..7000 {
        let place = draw(&mut draws, 7);
        assert_eq!(place, (f64::from(bits.bits32()) * 7.0 / 4_294_967_296.0).floor() as usize);
        drawn[place] += 1;
    }
    // 1000 ± 29: four deviations.
    assert!(drawn.iter().all(|&times| (880..=1120).contains(&times)), "{drawn:?}");
}

/// A finding and a complaint begin beyond the noise, on either side of one, not at its limit.
#[test]
fn the_noise_ends_at_two_percent() {
    let ends = |low: f64, high: f64| Estimate { value: 0.5 * (low + high), low, high };
    let (above, below) = (1.02_f64, 1.0 / 1.02);
    assert_eq!(ends(above, 1.1).pace(), Pace::Alike);
    assert_eq!(ends(above.next_up(), 1.1).pace(), Pace::Slower);
    assert_eq!(ends(0.9, below).pace(), Pace::Alike);
    assert_eq!(ends(0.9, below.next_down()).pace(), Pace::Faster);
    assert_eq!(ends(0.5, 2.0).pace(), Pace::Alike, "it cannot tell");
    assert_eq!(ends(1.0, 1.0).pace(), Pace::Alike);
    assert_eq!(ends(0.98, 1.02).complaint(), None);
    assert!(ends(0.98_f64.next_down(), 1.0).complaint().is_some());
    assert!(ends(1.0, 1.02_f64.next_up()).complaint().is_some());
    assert!(ends(f64::NAN, 1.0).complaint().is_some() && ends(1.0, f64::NAN).complaint().is_some());
    let reason = Estimate { value: 1.03, low: 1.01, high: 1.05 }.complaint().unwrap();
    assert_eq!(reason, "the second copy of featherbench over the first is 1.0300 [1.0100, 1.0500]: not 1 within ± 0.02");
}

#[test]
fn quantiles_interpolate() {
    let sorted = [1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!([0.0, 0.1, 0.5, 1.0].map(|f| quantile(&sorted, f)), [1.0, 1.4, 3.0, 5.0]);
    assert!(quantile(&[], 0.5).is_nan());
}
