//! The part of an experiment that one process makes: candidates in alternating blocks.
//!
//! Rounds are grouped into *epochs*. At the start of an epoch all candidates relocate their data, in random order, each in its own process.
//! The place of data in memory changes a time by up to some percent, and a ratio from one layout would depend on chance. The stack moves, too:
//! each of its places in a cache line has two epochs.
//! In each round every candidate has one block, in random order, from a random state on. The batch begins again at its end. Before a block
//! its candidate makes a tenth as many calls that are not timed, at the states before. Other candidates ran since its last block, and their
//! data are in the caches. Before and after each round it is measured how crowded the core is. A round waits for the core to be alone, all
//! rounds together at most twice as long as they take.
//!
//! A decision from a time uses the smallest of several: a stall of the machine makes a time longer, never shorter. Times are values, from
//! the candidates' clocks and from a clock that is an argument.

use super::samples::Samples;
use featherbench_bench::statistics::EPOCHS;
use featherbench_bench::{Core, Evaluation, NoAnswer, Relocation, STACK_PLACES, on_stack_at};
use featherbench_robots::Random;
use featherbench_spatial::larger;
use std::time::Duration;

/// The shortest block. It is some thousand times the clock's resolution and the cost of reading it. It is so short that most blocks are not
/// interrupted: the system's timer ticks every 4 ms.
const BLOCK: Duration = Duration::from_micros(150);
/// Most rounds of an epoch: with more time the blocks become longer.
const MOST_ROUNDS: usize = 5;
/// Calls before a block that are not timed: one per this number of calls of the block.
const WARM: usize = 10;
/// Most calls of a block. A call that would need more is shorter than any clock can measure.
const MOST_CALLS: usize = 1 << 24;
/// Rounds wait for the core to be alone, together at most so many times as long as they take. A neighbour stays for some ten milliseconds, which
/// are ten rounds.
const PATIENCE: u32 = 2;
/// A block is long enough if it was so in each of these trials. One alone may include a stall, and then all blocks would be too short.
const TRIALS: usize = 3;

/// Cache lines of a page: the stack begins in any of them.
const LINES: usize = 64;

/// A candidate that is ready to run, or why it is not.
pub(crate) type Ready<'a> = Result<Box<dyn Evaluation + 'a>, NoAnswer>;

/// The time of an experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Budget {
    /// Rounds of each epoch.
    pub rounds: usize,
    /// The shortest block.
    pub block: Duration,
}

impl Budget {
    /// The budget for `seconds` for each candidate in this process.
    pub fn of(seconds: f64) -> Self {
        let epoch = seconds / EPOCHS as f64;
        let rounds = ((epoch / BLOCK.as_secs_f64()) as usize).clamp(1, MOST_ROUNDS);
        Self { rounds, block: Duration::from_secs_f64((epoch / rounds as f64).max(0.0)).max(BLOCK) }
    }

    /// Rounds of an epoch in which `count` candidates need this time for one: fewer if single calls are longer than a block.
    fn rounds_of(&self, round: Duration, count: usize) -> usize {
        let meant = self.block.as_secs_f64() * (self.rounds * count) as f64;
        // Blocks may be up to twice as long as intended; that alone does not reduce the rounds.
        ((2.0 * meant / round.as_secs_f64().max(1e-9)) as usize).clamp(1, self.rounds)
    }

    /// Whether a relocation at each epoch is short enough: no longer than the timing of the candidate, or than twenty blocks if that is
    /// more.
    fn affords(&self, moving: Duration) -> bool {
        moving <= self.block * 20.max(self.rounds as u32)
    }
}

/// Times `count` candidates over a batch of `states` states. `prepare` makes one of them ready; `clock` gives the time since some moment,
/// `core` how crowded the core is. After an error a candidate's times are NaN.
pub(crate) fn experiment<'a>(
    prepare: &dyn Fn(usize) -> Ready<'a>,
    count: usize,
    states: usize,
    budget: Budget,
    clock: &dyn Fn() -> Duration,
    core: &Core,
    random: &mut Random,
) -> Samples {
    // The shortest relocation of each so far; its preparation is the first. One alone may include a stall: then it moves in other processes.
    let (mut calls, mut moves, mut round_time) = (Vec::with_capacity(count), Vec::with_capacity(count), Duration::ZERO);
    let mut candidates: Vec<Ready> = Vec::with_capacity(count);
    for which in 0..count {
        let start = clock();
        let mut candidate = prepare(which);
        moves.push(clock().saturating_sub(start));
        let (of_block, time) = calls_of_a_block(&mut candidate, budget.block);
        calls.push(of_block);
        round_time += time;
        candidates.push(candidate);
    }
    let rounds = budget.rounds_of(round_time, count);
    let mut samples = Samples::new(calls, EPOCHS * rounds);
    let mut patience = Patience { each: PATIENCE * round_time, left: Duration::ZERO };
    let mut order: Vec<usize> = (0..count).collect();
    let mut places: Vec<usize> = (0..EPOCHS).collect();
    shuffle(&mut places, random);
    for (epoch, place) in places.into_iter().enumerate() {
        shuffle(&mut order, random);
        for &which in order.iter().filter(|_| epoch > 0) {
            if budget.affords(moves[which]) {
                let start = clock();
                relocate(&mut candidates[which], &|| prepare(which), random);
                moves[which] = moves[which].min(clock().saturating_sub(start));
            }
        }
        let step = random.below(LINES) * STACK_PLACES + place;
        on_stack_at(step, &mut || {
            for round in epoch * rounds..(epoch + 1) * rounds {
                shuffle(&mut order, random);
                let before = patience.wait(clock, core);
                for &which in &order {
                    let (calls, state) = (samples.calls[which], random.below(states));
                    match block(&mut candidates[which], state, calls) {
                        Ok(time) => samples.set(which, round, time.as_secs_f64() * 1e9 / calls as f64),
                        Err(no_answer) => candidates[which] = Err(no_answer),
                    }
                }
                samples.crowded(round, larger(before, core.contention().0));
            }
        });
    }
    samples
}

/// How long a round may wait: what it has itself, and what the ones before left.
struct Patience {
    each: Duration,
    left: Duration,
}

impl Patience {
    /// Waits for the core to be alone; how crowded it is then.
    fn wait(&mut self, clock: &dyn Fn() -> Duration, core: &Core) -> f64 {
        self.left += self.each;
        let start = clock();
        loop {
            let (contention, alone) = core.contention();
            let waited = clock().saturating_sub(start);
            if alone || waited >= self.left {
                self.left = self.left.saturating_sub(waited);
                return contention;
            }
        }
    }
}

/// Relocates a candidate's data: by itself, or else by preparing it again.
fn relocate<'a>(candidate: &mut Ready<'a>, prepare: &dyn Fn() -> Ready<'a>, random: &mut Random) {
    let Ok(prepared) = candidate else { return };
    match prepared.relocate(random.bits32()) {
        Ok(true) => {}
        Ok(false) => {
            // The old one exists until the new one is made, so that the memory differs.
            let _relocate = Relocation::new(random);
            *candidate = prepare();
        }
        Err(no_answer) => *candidate = Err(no_answer),
    }
}

/// One block from a state on, and the calls before it.
fn block(candidate: &mut Ready, state: usize, calls: usize) -> Result<Duration, NoAnswer> {
    let prepared = candidate.as_mut().map_err(|no_answer| no_answer.clone())?;
    let warm = calls / WARM;
    if warm > 0 {
        prepared.clock(state..state + warm)?;
    }
    prepared.clock(state + warm..state + warm + calls)
}

/// Warms a candidate up. Returns how many calls last as long as a block, and their time; 1 and zero after an error. A candidate that
/// evaluates several states at once has whole multiples of them.
fn calls_of_a_block(candidate: &mut Ready, block: Duration) -> (usize, Duration) {
    let together = candidate.as_ref().map_or(1, |prepared| prepared.together());
    let mut calls = together;
    // A first call may take many times as long as later ones, and would be taken for a whole block.
    let first = candidate.as_mut().ok().and_then(|prepared| prepared.clock(0..1).err());
    if let Some(no_answer) = first {
        *candidate = Err(no_answer);
    }
    while let Ok(prepared) = candidate {
        match least(prepared.as_mut(), calls, block) {
            Ok(time) if time < block && calls < MOST_CALLS => {
                // Approaches the length of a block in few steps.
                let missing = block.as_secs_f64() / time.as_secs_f64().max(1e-9);
                calls = ((calls as f64 * missing.clamp(1.1, 8.0)).ceil() as usize).next_multiple_of(together);
            }
            Ok(time) => return (calls, time),
            Err(no_answer) => *candidate = Err(no_answer),
        }
    }
    (1, Duration::ZERO)
}

/// The smallest time of some trials of a block with this number of calls. It stops at the first trial that is short enough.
fn least(prepared: &mut dyn Evaluation, calls: usize, block: Duration) -> Result<Duration, NoAnswer> {
    let mut least = prepared.clock(0..calls)?;
    for _ in 1..TRIALS {
        if least < block {
            break;
        }
        least = least.min(prepared.clock(0..calls)?);
    }
    Ok(least)
}

/// Every order with the same probability (Fisher and Yates).
fn shuffle(order: &mut [usize], random: &mut Random) {
    for last in (1..order.len()).rev() {
        order.swap(last, random.below(last + 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::{Cell, RefCell};
    use std::ops::Range;
    use std::sync::{Arc, Mutex};

    /// The requests: candidate, first state, calls.
    type Log = Arc<Mutex<Vec<(usize, Range<usize>)>>>;

    /// A candidate whose calls take a given time by its own clock, and that fails after some blocks.
    struct Scripted {
        who: usize,
        call: Duration,
        blocks: usize,
        log: Log,
    }

    impl Evaluation for Scripted {
        fn run(&mut self, _: Range<usize>) -> Result<(), NoAnswer> {
            Ok(())
        }

        fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
            self.log.lock().unwrap().push((self.who, range.clone()));
            self.blocks = self.blocks.checked_sub(1).ok_or_else(|| NoAnswer::Failed("it died".into()))?;
            Ok(self.call * range.len() as u32)
        }

        fn read(&self) -> &[f64] {
            &[]
        }
    }

    /// A core that is alone.
    fn alone() -> Core {
        Core::new(|| 1.0)
    }

    const BUDGET: Budget = Budget { rounds: 40, block: Duration::from_micros(200) };

    /// The samples and the log of candidates with these times of a call, each failing after this number of blocks.
    fn scripted(candidates: &[(Duration, usize)]) -> (Samples, Vec<(usize, Range<usize>)>) {
        let log = Log::default();
        let prepare = |who: usize| -> Ready {
            let (call, blocks) = candidates[who];
            Ok(Box::new(Scripted { who, call, blocks, log: log.clone() }))
        };
        let samples = experiment(&prepare, candidates.len(), 1000, BUDGET, &|| Duration::ZERO, &alone(), &mut Random::new(1, 2));
        let log = log.lock().unwrap().clone();
        (samples, log)
    }

    /// One candidate relocates itself, one must be prepared again, one fails to relocate. The time of a call is the number of relocations.
    #[test]
    fn at_each_epoch_all_candidates_are_relocated() {
        struct Mover(Result<bool, ()>, u32);
        impl Evaluation for Mover {
            fn run(&mut self, _: Range<usize>) -> Result<(), NoAnswer> {
                Ok(())
            }

            fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
                Ok(Duration::from_millis(u64::from(self.1)) * range.len() as u32)
            }

            fn relocate(&mut self, _: u32) -> Result<bool, NoAnswer> {
                self.1 += 1;
                self.0.map_err(|()| NoAnswer::Failed("it lost its robot".into()))
            }

            fn read(&self) -> &[f64] {
                &[]
            }
        }
        let prepared = std::cell::Cell::new([0; 3]);
        let prepare = |who: usize| -> Ready {
            let mut count = prepared.get();
            count[who] += 1;
            prepared.set(count);
            Ok(Box::new(Mover([Ok(true), Ok(false), Err(())][who], count[who])))
        };
        let samples = experiment(&prepare, 3, 1000, BUDGET, &|| Duration::ZERO, &alone(), &mut Random::new(1, 2));
        assert_eq!(prepared.get(), [1, EPOCHS as u32, 1]);
        let epoch = samples.of(0).len() / EPOCHS;
        for (round, (own, anew)) in samples.of(0).iter().zip(samples.of(1)).enumerate() {
            let moves = 1e6 * (1 + round / epoch) as f64;
            assert!((own - moves).abs() < 1e-3 && (anew - moves).abs() < 1e-3, "round {round}: {own} and {anew} ns");
            assert_eq!(samples.of(2)[round].is_nan(), round >= epoch, "one that is lost has no time from then on");
        }
    }

    /// The time of a relocation at an epoch; 0 is the preparation.
    type Script = fn(usize) -> Duration;

    /// The epochs at which candidates relocated; their relocations take scripted times by the experiment's clock.
    fn epochs_of_moves<const N: usize>(scripts: [Script; N]) -> [Vec<usize>; N] {
        let (log, now, moves) = (Log::default(), Cell::new(Duration::ZERO), RefCell::new([const { Vec::new() }; N]));
        let prepare = |who: usize| -> Ready {
            // A call fills a block. Each candidate has one call at first, then those that find its length, and then one in each round.
            let epoch = log.lock().unwrap().len().checked_sub((1 + TRIALS) * N).map_or(0, |blocks| blocks / (N * BUDGET.rounds));
            now.set(now.get() + scripts[who](epoch));
            moves.borrow_mut()[who].push(epoch);
            Ok(Box::new(Scripted { who, call: BUDGET.block, blocks: usize::MAX, log: log.clone() }))
        };
        let samples = experiment(&prepare, N, 1000, BUDGET, &|| now.get(), &alone(), &mut Random::new(1, 2));
        assert_eq!(samples.of(0).len(), EPOCHS * BUDGET.rounds);
        let mut moves = moves.into_inner();
        assert!(moves.iter_mut().all(|moves| moves.remove(0) == 0), "all were made ready first");
        moves
    }

    /// A stall of the machine during a relocation does not end the relocations of a candidate. One whose preparation takes long stays where it is.
    #[test]
    fn a_stall_costs_no_move() {
        const SLOW: Duration = Duration::from_secs(1);
        assert!(!BUDGET.affords(SLOW) && BUDGET.affords(Duration::ZERO));
        let slow: [Script; 4] = [
            |_| Duration::ZERO,
            |epoch| if epoch == 3 { SLOW } else { Duration::ZERO },
            |epoch| if epoch > 0 { SLOW } else { Duration::ZERO },
            |_| SLOW,
        ];
        let all: Vec<usize> = (1..EPOCHS).collect();
        let [quick, once, but_for_the_first, always] = epochs_of_moves(slow);
        assert_eq!([&quick, &once, &but_for_the_first], [&all; 3]);
        assert!(always.is_empty(), "{always:?}");
    }

    /// A stall while the length of a block is determined does not change it.
    #[test]
    fn a_stall_makes_no_short_blocks() {
        /// Ten times the length of a block is lost at these of its calls.
        struct Stalling(Vec<usize>, usize);
        impl Evaluation for Stalling {
            fn run(&mut self, _: Range<usize>) -> Result<(), NoAnswer> {
                Ok(())
            }

            fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
                self.1 += 1;
                let stall = if self.0.contains(&self.1) { 10 * BUDGET.block } else { Duration::ZERO };
                Ok(Duration::from_nanos(100) * range.len() as u32 + stall)
            }

            fn read(&self) -> &[f64] {
                &[]
            }
        }
        let found = |stalls: &[usize]| {
            let mut candidate: Ready = Ok(Box::new(Stalling(stalls.to_vec(), 0)));
            calls_of_a_block(&mut candidate, BUDGET.block)
        };
        let (calls, time) = found(&[]);
        assert!(time == Duration::from_nanos(100) * calls as u32 && time >= BUDGET.block && time < 2 * BUDGET.block, "{calls} in {time:?}");
        for stall in 1..=8 {
            assert_eq!(found(&[stall]), (calls, time), "at call {stall}");
            assert_eq!(found(&[stall, stall + 1]), (calls, time), "at call {stall} and the next");
        }
    }

    /// A part of a batch costs as much as a whole one: so no block ends within one.
    #[test]
    fn a_block_has_whole_batches() {
        /// 64 states at a time, in a microsecond.
        struct Batch;
        impl Evaluation for Batch {
            fn run(&mut self, _: Range<usize>) -> Result<(), NoAnswer> {
                Ok(())
            }

            fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
                Ok(Duration::from_micros(range.len().div_ceil(self.together()) as u64))
            }

            fn together(&self) -> usize {
                64
            }

            fn read(&self) -> &[f64] {
                &[]
            }
        }
        let samples = experiment(&|_| Ok(Box::new(Batch)), 1, 1000, BUDGET, &|| Duration::ZERO, &alone(), &mut Random::new(1, 2));
        let calls = samples.calls[0];
        assert!(calls.is_multiple_of(64) && (200 * 64..400 * 64).contains(&calls), "{calls} calls");
        assert!(samples.of(0).iter().all(|ns| (ns - 1000.0 / 64.0).abs() < 1e-9), "a time is that of a batch over its states");
    }

    #[test]
    fn every_round_has_a_block_of_each_from_any_state_in_changing_order() {
        let (fast, slow) = (Duration::from_nanos(100), Duration::from_micros(300));
        let (samples, log) = scripted(&[(fast, usize::MAX), (fast * 2, usize::MAX), (slow, usize::MAX)]);
        assert_eq!(samples.calls[2], 1);
        let length = samples.calls[0] as u32 * fast;
        assert!(length >= BUDGET.block && length < 2 * BUDGET.block, "{:?}", samples.calls);
        for (which, call) in [fast, fast * 2, slow].into_iter().enumerate() {
            assert_eq!(samples.of(which).len(), EPOCHS * BUDGET.rounds);
            assert!(samples.of(which).iter().all(|ns| (ns - call.as_nanos() as f64).abs() < 1e-6), "{:?}", samples.of(which));
        }
        // After the first calls of all candidates come the blocks, each after its warm-up, except that of the slow one.
        let rounds = 5 * EPOCHS * BUDGET.rounds;
        let blocks: Vec<_> = log[log.len() - rounds..].iter().filter(|(who, range)| range.len() == samples.calls[*who]).collect();
        let mut orders: Vec<Vec<usize>> = Vec::new();
        for round in blocks.chunks(3) {
            orders.push(round.iter().map(|(who, _)| *who).collect());
            let mut all_candidates = orders[orders.len() - 1].clone();
            all_candidates.sort_unstable();
            assert_eq!(all_candidates, [0, 1, 2]);
        }
        orders.sort();
        orders.dedup();
        assert_eq!(orders.len(), 6, "every order comes");
        let mut starts: Vec<usize> = blocks.iter().map(|(_, range)| range.start % 1000).collect();
        starts.sort_unstable();
        starts.dedup();
        assert!(starts.len() > 200, "{} of 1000 states begin a block", starts.len());
        for pair in log.windows(2).filter(|pair| pair[0].1.len() * WARM == pair[1].1.len() && pair[0].1.start > 0) {
            assert_eq!(pair[0].1.end, pair[1].1.start, "the calls before a block are at the states before it");
        }
    }

    /// A program is on the core's other thread at some of the measurements.
    fn visited(during: Range<usize>, clock: &dyn Fn() -> Duration) -> (Samples, usize) {
        thread_local!(static MEASURED: Cell<usize> = const { Cell::new(0) });
        thread_local!(static VISIT: RefCell<Range<usize>> = const { RefCell::new(0..0) });
        MEASURED.set(0);
        VISIT.set(during);
        let core = Core::new(|| {
            MEASURED.set(MEASURED.get() + 1);
            if VISIT.with_borrow(|visit| visit.contains(&MEASURED.get())) { 1.3 } else { 1.0 }
        });
        let prepare = |who: usize| -> Ready { Ok(Box::new(Scripted { who, call: BUDGET.block, blocks: usize::MAX, log: Log::default() })) };
        let samples = experiment(&prepare, 2, 1000, BUDGET, clock, &core, &mut Random::new(1, 2));
        (samples, MEASURED.get())
    }

    /// Rounds whose core was crowded.
    fn crowded(samples: &Samples) -> Vec<usize> {
        (0..EPOCHS * BUDGET.rounds).filter(|&round| samples.contention()[round] != 1.0).collect()
    }

    /// Measured before and after each round. The visit begins after the third round: the fourth waits until it ends.
    #[test]
    fn a_round_waits_for_the_core_to_be_alone() {
        let (samples, measured) = visited(6..20, &|| Duration::ZERO);
        assert_eq!((crowded(&samples), measured), (vec![2], 2 * EPOCHS * BUDGET.rounds + 13));
    }

    /// Every reading of the clock is a tenth of a round later: what all rounds may wait, they wait once.
    #[test]
    fn rounds_wait_so_long_and_no_longer() {
        let now = Cell::new(Duration::ZERO);
        let clock = || {
            now.set(now.get() + 2 * BUDGET.block / 10);
            now.get()
        };
        let rounds = EPOCHS * BUDGET.rounds;
        let (samples, measured) = visited(10..usize::MAX, &clock);
        assert_eq!(crowded(&samples), (4..rounds).collect::<Vec<_>>());
        let waited = measured - 2 * rounds;
        assert!((16 * rounds..=20 * rounds).contains(&waited), "{waited} for {rounds} rounds");
    }

    #[test]
    fn one_that_dies_leaves_the_others_their_rounds() {
        let call = Duration::from_micros(50);
        // Two calls and three trials determine the length of a block; two more are its rounds.
        let (samples, _) = scripted(&[(call, usize::MAX), (call, 7), (call, 0)]);
        assert!(samples.of(0).iter().all(|ns| ns.is_finite()));
        assert!(samples.of(1)[1].is_finite() && samples.of(1)[2..].iter().all(|ns| ns.is_nan()));
        assert!(samples.of(2).iter().all(|ns| ns.is_nan()));
    }

    #[test]
    fn seconds_become_rounds_and_then_longer_blocks() {
        assert_eq!(Budget::of(0.0), Budget { rounds: 1, block: BLOCK });
        assert_eq!(Budget::of(0.002), Budget { rounds: 1, block: Duration::from_secs_f64(0.002 / 8.0) });
        assert_eq!(Budget::of(0.04), Budget { rounds: MOST_ROUNDS, block: Duration::from_millis(1) });
        let rounds = |millis, count| Budget::of(0.04).rounds_of(Duration::from_millis(millis), count);
        assert_eq!([rounds(4, 4), rounds(8, 4), rounds(16, 4), rounds(1000, 4)], [5, 5, 2, 1]);
        assert!(Budget::of(0.04).affords(Duration::from_millis(20)) && !Budget::of(0.04).affords(Duration::from_millis(21)));
    }
}
