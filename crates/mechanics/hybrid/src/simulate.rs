//! A run of a hybrid system: adaptive steps, events located in time, chains of resets, and an end that says what it is.
//!
//! A segment is what lies between two instants of events:
//!
//! 1. Guards that are met now fire, one after another; several at once in both orders.
//! 2. Steps are taken until a guard is crossed on the dense output of one.
//! 3. The step is taken again, up to the time of the crossing.
//!
//! Integrator: [`crate::extrapolation`], of order 2κ, with the step size of the elementary controller, 0.9·e^(−1/(2κ−1)) (Hairer, Nørsett
//! and Wanner, *Solving Ordinary Differential Equations I*, §II.4). The scalar is one number: f64, dual or double-double, not lanes.

use crate::crossing::{Begin, Cut, Found, Located, SLACK, search, unresolved};
use crate::dense::Dense;
use crate::error::{HybridError, expect, expect_finite};
use crate::extrapolation::{Extrapolation, Trial};
use crate::instant::{Moment, both_orders, fire, met, value_and_rate};
use crate::run::{Cap, Event, Record, Run, Start, Status, Step};
use crate::settings::Settings;
use crate::system::{Bound, Direction, Hybrid, expect_mode};
use crate::zeno::recognise;
use featherbench_spatial::{Real, larger, largest};

/// Runs a system from a start to a time.
///
/// ```
/// use featherbench_hybrid::systems::BouncingBall;
/// use featherbench_hybrid::{Settings, Start, Status, simulate};
/// let ball = Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] };
/// let run = simulate(&BouncingBall, &[9.81, 0.8], &ball, 10.0, &Settings::default())?;
/// let Status::Zeno(tail) = run.status else { panic!("the ball comes to rest") };
/// let known: f64 = BouncingBall::zeno_time(1.0, 9.81, 0.8);
/// assert!((tail.time.value - known).abs() < 1e-12 * known);
/// # Ok::<(), featherbench_hybrid::HybridError>(())
/// ```
///
/// # Errors
/// [`HybridError`]: the start, the parameters or a setting is no such thing; a number is not finite; an event time is not found. Ends that
/// are none of these, caps too, are a [`Status`].
pub fn simulate<S: Hybrid, T: Real>(system: &S, theta: &[T], start: &Start<T>, to: T, settings: &Settings) -> Result<Run<T>, HybridError> {
    settings.check()?;
    expect("state", &start.state, system.states())?;
    expect("parameters", theta, system.parameters())?;
    expect("time", &[start.time, to], 2)?;
    expect_mode(system, start.mode)?;
    if (to - start.time).min_lane() < 0.0 {
        return Err(HybridError::Backward { from: start.time.min_lane(), to: to.min_lane() });
    }
    let span = (to - start.time).min_lane();
    let mut driver = Driver {
        system,
        theta,
        settings,
        method: Extrapolation::new(settings.columns),
        size: (1e-2 * span).min(settings.longest_step),
        tried: 0,
        now: Moment { mode: start.mode, time: start.time, state: start.state.clone() },
        run: Run {
            status: Status::Finished,
            mode: start.mode,
            time: start.time,
            state: Vec::new(),
            events: Vec::new(),
            simultaneous: Vec::new(),
            records: Vec::new(),
            rejected: 0,
            columns: settings.columns,
        },
    };
    let status = driver.go(to)?;
    let Moment { mode, time, state } = driver.now;
    Ok(Run { status, mode, time, state, ..driver.run })
}

/// The state of a run in progress.
struct Driver<'a, S, T> {
    system: &'a S,
    theta: &'a [T],
    settings: &'a Settings,
    method: Extrapolation<T>,
    /// The next step to try.
    size: f64,
    /// Steps tried.
    tried: usize,
    now: Moment<T>,
    run: Run<T>,
}

/// A guard of a segment: `sign` makes g positive before the event.
struct Watch {
    guard: usize,
    sign: f64,
    begin: Begin,
}

/// An accepted step with what the search for events needs.
struct Accepted<T> {
    length: T,
    last: bool,
    first: Vec<T>,
    end: Vec<T>,
    dense: Dense<T>,
}

/// A guard that was found in a step.
struct Hit<T> {
    guard: usize,
    point: Located<T>,
    touch: bool,
}

impl<S: Hybrid, T: Real> Driver<'_, S, T> {
    fn go(&mut self, to: T) -> Result<Status<T>, HybridError> {
        loop {
            if let Some(status) = self.chain()? {
                return Ok(status);
            }
            if let Some(status) = self.segment(to)? {
                return Ok(status);
            }
        }
    }

    /// Fires the guards that are met now.
    fn chain(&mut self) -> Result<Option<Status<T>>, HybridError> {
        for _ in 0..self.settings.chain {
            let guards = self.met();
            let Some(first) = guards.first().copied() else { return Ok(None) };
            if let Some(status) = self.several(guards)? {
                return Ok(Some(status));
            }
            if let Some(status) = self.fire(first, 0.0)? {
                return Ok(Some(status));
            }
        }
        Ok(if self.met().is_empty() { None } else { Some(Status::Capped(Cap::Chain)) })
    }

    /// The guards that are met now.
    fn met(&self) -> Vec<usize> {
        let last = self.last().map(|event| (event.mode, event.guard));
        met(self.system, self.theta, &self.now, last, self.settings)
    }

    /// The last event, if it was at this instant.
    fn last(&self) -> Option<&Event<T>> {
        self.run.events.last().filter(|event| (self.now.time - event.time).min_lane() == 0.0)
    }

    /// Reports guards that are met at one time; the run ends if their order matters.
    fn several(&mut self, guards: Vec<usize>) -> Result<Option<Status<T>>, HybridError> {
        if guards.len() < 2 {
            return Ok(None);
        }
        let both = both_orders(self.system, self.theta, &self.now, guards, self.settings)?;
        let agree = both.disagreement <= self.settings.order;
        self.run.simultaneous.push(both);
        Ok(if agree { None } else { Some(Status::Ambiguous) })
    }

    /// One event. The run ends if it is recognised as one of infinitely many, or at the cap.
    fn fire(&mut self, guard: usize, correction: f64) -> Result<Option<Status<T>>, HybridError> {
        if self.run.events.len() >= self.settings.events {
            return Ok(Some(Status::Capped(Cap::Events)));
        }
        let event: Event<T> = fire(self.system, self.theta, &mut self.now, guard, correction)?;
        self.run.records.push(Record::Event(self.run.events.len()));
        self.run.events.push(event);
        let tail = self.settings.zeno.and_then(|zeno| recognise(&zeno, &self.run.events));
        Ok(tail.map(Status::Zeno))
    }

    /// Steps up to the next event, which fires, or to the end.
    fn segment(&mut self, to: T) -> Result<Option<Status<T>>, HybridError> {
        let mut watches = self.watches()?;
        loop {
            if (to - self.now.time).min_lane() <= 0.0 {
                return Ok(Some(Status::Finished));
            }
            let Some(accepted) = self.accept(to)? else { return Ok(Some(Status::Capped(Cap::Steps))) };
            let hits = self.hits(&accepted, &watches)?;
            if hits.is_empty() {
                self.advance(accepted.length, accepted.end);
                if accepted.last {
                    self.now.time = to;
                    // An event at the end of the time belongs to the run.
                    return Ok(self.chain()?.or(Some(Status::Finished)));
                }
                watches.iter_mut().for_each(|watch| watch.begin = Begin::Plain);
                continue;
            }
            return self.event(hits);
        }
    }

    /// The guards of this mode, each with the sign that it has before its event.
    fn watches(&self) -> Result<Vec<Watch>, HybridError> {
        let bound = Bound { system: self.system, theta: self.theta, mode: self.now.mode };
        let last = self.last();
        let of = |guard: usize| {
            let (value, rate) = value_and_rate(&bound, guard, &self.now);
            if !value.is_finite() || !rate.is_finite() {
                return Err(HybridError::Overflow { what: "guard", time: self.now.time.min_lane() });
            }
            // After its own event a guard is zero to the rounding of its location, which the rate before the event measures.
            let own = last.filter(|event| event.guard == guard && event.mode == self.now.mode).map(|event| event.rate);
            let noise = bound.noise(guard, self.now.time, &self.now.state);
            let is_zero = value.abs() <= rate.abs().max(own.map_or(0.0, f64::abs)) * self.settings.time + noise;
            let sign = match self.system.direction(self.now.mode, guard) {
                Direction::Falling => 1.0,
                Direction::Rising => -1.0,
                Direction::Either if is_zero => 1.0_f64.copysign(rate),
                Direction::Either => 1.0_f64.copysign(value),
            };
            let closing = sign * rate < -self.settings.grazing_rate;
            let begin = match (is_zero, own.is_some() && closing) {
                (false, _) => Begin::Plain,
                (true, false) => Begin::Leaving,
                (true, true) => Begin::Passed,
            };
            Ok(Watch { guard, sign, begin })
        };
        (0..self.system.guards(self.now.mode)).map(of).collect()
    }

    /// The next step whose errors are within the tolerances; `None` at the cap of steps.
    fn accept(&mut self, to: T) -> Result<Option<Accepted<T>>, HybridError> {
        let bound = Bound { system: self.system, theta: self.theta, mode: self.now.mode };
        let (time, state) = (self.now.time, &self.now.state);
        let first = bound.rate(time, state);
        expect_finite("flow", time, &first)?;
        loop {
            if self.tried >= self.settings.steps {
                return Ok(None);
            }
            self.tried += 1;
            let rest = (to - time).min_lane();
            let size = self.size.min(self.settings.longest_step);
            let resolved = size > 16.0 * f64::EPSILON * time.min_lane().abs() && size > 0.0;
            if !resolved && rest > size {
                return Err(HybridError::StepTooSmall { time: time.min_lane(), step: size });
            }
            // A rest that is hardly longer than a step is taken whole: no tiny step follows.
            let last = size * (1.0 + 1e-3) >= rest;
            let length = if last { to - time } else { T::from_f64(size) };
            let trial = self.method.step(|t, x, rate| bound.flow(t, x, rate), time, length, state, &first);
            let error = self.error(&trial);
            let (dense, defect) = self.dense(&bound, length, &first, &trial);
            let guards = (0..self.system.guards(self.now.mode)).map(|guard| unresolved(&bound, guard, &dense, self.settings));
            let defect = largest(guards.chain([defect]));
            let taken = length.min_lane();
            if error <= 1.0 && defect <= 1.0 {
                // The last step is short for another reason, and a step may be longer than what is tried here.
                self.size = (taken * self.factor(error, defect)).max(if last { self.size } else { 0.0 });
                return Ok(Some(Accepted { length, last, first, end: trial.end, dense }));
            }
            self.run.rejected += 1;
            self.size = taken * self.factor(error, defect).min(0.9);
        }
    }

    /// The factor of the next step; the smallest one if a measure is not finite.
    fn factor(&self, error: f64, defect: f64) -> f64 {
        // The defect of a polynomial of degree 5 is h times a rate of order 5.
        let (by_error, by_defect) = (error.powf(-1.0 / self.method.estimate_order()), defect.powf(-1.0 / 6.0));
        let finite = error.is_finite() && defect.is_finite();
        if finite { (0.9 * by_error.min(by_defect)).clamp(0.1, 5.0) } else { 0.1 }
    }

    /// The estimate of the step's error by the tolerance; NaN if a number is.
    fn error(&self, trial: &Trial<T>) -> f64 {
        let of = |k: usize| {
            let scale = self.now.state[k].min_lane().abs().max(trial.end[k].min_lane().abs());
            trial.error[k].min_lane().abs() / (self.settings.absolute + self.settings.relative * scale)
        };
        largest((0..trial.end.len()).map(of))
    }

    /// The dense output, and its defect h(ṗ − f(p)) at both quarters by the tolerance.
    fn dense(&self, bound: &Bound<S, T>, length: T, first: &[T], trial: &Trial<T>) -> (Dense<T>, f64) {
        let time = self.now.time;
        let middle = bound.rate(length.mul_add(T::from_f64(0.5), time), &trial.middle);
        let end = bound.rate(time + length, &trial.end);
        let dense = Dense::new(time, length, [(&self.now.state, first), (&trial.middle, &middle), (&trial.end, &end)]);
        let at = |s: f64| {
            let (t, x, rate) = dense.at(s);
            let flow = bound.rate(t, &x);
            let of = |k: usize| {
                let defect = length * (rate[k] - flow[k]);
                defect.min_lane().abs() / (self.settings.dense * (1.0 + x[k].min_lane().abs()))
            };
            largest((0..x.len()).map(of))
        };
        let defect = larger(at(0.25), at(0.75));
        (dense, defect)
    }

    /// The guards that are crossed or touched in a step, each at its own time.
    fn hits(&self, accepted: &Accepted<T>, watches: &[Watch]) -> Result<Vec<Hit<T>>, HybridError> {
        let bound = Bound { system: self.system, theta: self.theta, mode: self.now.mode };
        let (time, state) = (self.now.time, &self.now.state[..]);
        let cut = Cut { bound: &bound, method: &self.method, time, length: accepted.length, state, first: &accepted.first };
        let mut found = Vec::new();
        for &Watch { guard, sign, begin } in watches {
            found.extend(search(&bound, guard, sign, begin, &accepted.dense, self.settings).map(|found| (guard, sign, found)));
        }
        // What lies clearly behind the first of them may never happen.
        let earliest = found.iter().map(|(_, _, found)| found.at()).fold(f64::INFINITY, f64::min);
        let mut hits = Vec::new();
        for (guard, sign, found) in found {
            if found.at() > earliest + 2.0 * SLACK {
                continue;
            }
            let touch = matches!(found, Found::Touch { .. });
            let point = if touch { cut.touch(guard, found.at()) } else { cut.locate(guard, sign, found, self.settings)? };
            hits.push(Hit { guard, point, touch });
        }
        Ok(hits)
    }

    /// Goes to the first of the guards, and fires it or ends the run.
    fn event(&mut self, mut hits: Vec<Hit<T>>) -> Result<Option<Status<T>>, HybridError> {
        hits.sort_by(|a, b| (a.point.length - b.point.length).min_lane().total_cmp(&0.0));
        let earliest = hits[0].point.length;
        hits.retain(|hit| (hit.point.length - earliest).min_lane() <= self.settings.time);
        let mode = self.now.mode;
        let guards: Vec<usize> = hits.iter().map(|hit| hit.guard).collect();
        let grazing = hits.iter().find(|hit| hit.touch || hit.point.rate.abs() <= self.settings.grazing_rate);
        let grazing = grazing.map(|hit| Status::Grazing { mode, guard: hit.guard, value: hit.point.value, rate: hit.point.rate });
        let Hit { point, .. } = hits.swap_remove(0);
        self.advance(point.length, point.state);
        if grazing.is_some() {
            return Ok(grazing);
        }
        let mut ordered = guards.clone();
        ordered.sort_unstable();
        let first = ordered[0];
        if let Some(status) = self.several(ordered)? {
            return Ok(Some(status));
        }
        self.fire(first, point.correction)
    }

    /// Takes a step into the records.
    fn advance(&mut self, length: T, end: Vec<T>) {
        let state = std::mem::replace(&mut self.now.state, end);
        let time = self.now.time;
        if length.min_lane() != 0.0 {
            self.run.records.push(Record::Step(Step { mode: self.now.mode, time, length, state }));
        }
        self.now.time = time + length;
    }
}
