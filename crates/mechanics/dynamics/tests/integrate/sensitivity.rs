//! Sensitivities and adjoints: against differences in 32 digits, against each other, and against the flow at the integrator's order.

use crate::common;

use common::{ROBOTS, build, distance, generated, larger, largest, within};
use featherbench_dynamics::integrate::{
    Adjoint, Analytic, ByDuals, Cost, CostGradient, DormandPrince, Forward, ImplicitMidpoint, Instant, IntegrationError, Integrator,
    Linearisation, Linearise, Rollout, RungeKutta4, SymplecticEuler, System, Visit, rollout, sensitivity,
};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement, difference, integrate};
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::{Angle, DoubleDouble, Force, Real, Vec3};

/// Motors at these dofs. The parameters are a damping, and the mass of the last body. A wrench that changes with time acts on the first.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    pub(super) motors: Vec<usize>,
}

impl System for Driven {
    fn controls(&self) -> usize {
        self.motors.len()
    }

    fn parameters(&self) -> usize {
        2
    }

    fn has_wrenches(&self) -> bool {
        true
    }

    fn forces<T: Angle>(&self, at: &Instant<'_, T>, tau: &mut [T], wrenches: &mut [Force<T>]) {
        for (&dof, &control) in self.motors.iter().zip(at.controls) {
            tau[dof] += control;
        }
        for (tau, v) in tau.iter_mut().zip(at.v) {
            *tau -= at.parameters[0] * *v;
        }
        let (sin, cos) = (at.time + at.q[0]).sin_cos();
        wrenches[0] += Force::new(Vec3::new(sin, T::zero(), cos) * T::from_f64(0.2), Vec3::new(cos, sin, T::one()));
    }

    fn adjust<T: Angle>(&self, parameters: &[T], model: &mut Model<T>) {
        if let Some(last) = model.inertias.last_mut() {
            last.mass = parameters[1];
        }
    }
}

/// A robot with the numbers of a trajectory.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) model: Model<f64>,
    pub(super) system: Driven,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) steps: Vec<f64>,
    pub(super) controls: Vec<f64>,
    pub(super) parameters: Vec<f64>,
}

fn arm(links: usize) -> Model<f64> {
    let link = |k: usize| BodyDescription {
        name: format!("link{k}"),
        parent: k.checked_sub(1),
        mass: 1.0 + k as f64,
        com: [0.0, 0.0, -0.5],
        inertia: [0.1, 0.0, 0.0, 0.1, 0.0, 0.01],
        joint: JointDescription {
            kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] },
            placement: Placement { translation: [0.0, 0.0, if k == 0 { 0.0 } else { -1.0 }], ..Placement::default() },
            ..JointDescription::default()
        },
    };
    Model::build(&Description { gravity: [0.0, 0.0, -9.81], bodies: (0..links).map(link).collect(), ..Description::default() }).unwrap()
}

fn cases() -> Vec<Case> {
    [("pendulum", arm(1), 0), ("2R arm", arm(2), 0), ("floating quadruped", generated("quadruped"), 6)]
        .into_iter()
        .map(|(name, model, passive)| Case::new(name, model, passive))
        .collect()
}

impl Case {
    /// Six steps of a robot with motors at all dofs but the first ones.
    pub(super) fn new(name: &'static str, model: Model<f64>, passive: usize) -> Self {
        let states = StateBatch::random(&model, 1, 4);
        let (nv, count) = (model.topology.nv(), 6);
        let mut random = Random::new(9, nv as u64);
        let motors: Vec<usize> = (passive..nv).collect();
        let mut numbers = |count: usize, reach: f64| (0..count).map(|_| random.uniform(-reach, reach)).collect::<Vec<_>>();
        let last = model.inertias[model.inertias.len() - 1].mass;
        Self {
            name,
            q: states.q(0).to_vec(),
            v: states.v(0).to_vec(),
            // Steps of unequal lengths, as an adaptive integration makes them.
            steps: (0..count).map(|k| 0.01 + 0.002 * f64::from(k)).collect(),
            controls: numbers(count as usize * motors.len(), 2.0),
            parameters: vec![0.1, last],
            system: Driven { motors },
            model,
        }
    }

    pub(super) fn rollout(&self) -> Rollout<'_, f64> {
        let Self { q, v, steps, controls, parameters, .. } = self;
        Rollout { start: 0.3, steps, q, v, controls, parameters }
    }

    pub(super) fn inputs(&self) -> usize {
        self.system.motors.len() + 2
    }

    pub(super) fn by_duals(&self) -> ByDuals<Driven, f64> {
        ByDuals::new(&self.model, self.system.clone(), &self.parameters).unwrap()
    }

    /// A random direction of all variables.
    pub(super) fn direction(&self, seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed, 1);
        (0..self.rollout().variables()).map(|_| random.uniform(-1.0, 1.0)).collect()
    }
}

/// What is asked of each integrator.
trait Ask {
    fn ask<I: Integrator<f64>, W: Integrator<DoubleDouble>>(&self, name: &str, case: &Case, integrator: I, extended: W);
}

fn each(question: &impl Ask) {
    for case in cases() {
        let (t, inputs) = (&case.model.topology, case.inputs());
        macro_rules! ask {
            ($($method:ident),+) => {$(
                let name = format!("{}, {}", stringify!($method), case.name);
                question.ask(&name, &case, $method::with_derivatives(t, inputs), $method::<DoubleDouble>::new(t));
            )+};
        }
        ask!(SymplecticEuler, ImplicitMidpoint, RungeKutta4, DormandPrince);
    }
}

/// The state at the end, in 32 digits, from a start moved along a direction.
fn moved_end<W: Integrator<DoubleDouble>>(
    case: &Case,
    integrator: &mut W,
    direction: &[f64],
    by: f64,
) -> (Vec<DoubleDouble>, Vec<DoubleDouble>) {
    let (by, t) = (DoubleDouble::from_f64(by), &case.model.topology);
    let nv = t.nv();
    let moved = |x: &[f64], dx: &[f64]| -> Vec<DoubleDouble> {
        x.iter().zip(dx).map(|(x, dx)| by.mul_add(DoubleDouble::from_f64(*dx), DoubleDouble::from_f64(*x))).collect()
    };
    let way = moved(&vec![0.0; nv], direction);
    let q = integrate(t, &moved(&case.q, &vec![0.0; case.q.len()]), &way).unwrap();
    let v = moved(&case.v, &direction[nv..]);
    let controls = moved(&case.controls, &direction[2 * nv..]);
    let parameters = moved(&case.parameters, &direction[2 * nv + controls.len()..]);
    let steps: Vec<_> = case.steps.iter().map(|h| DoubleDouble::from_f64(*h)).collect();
    let trajectory =
        Rollout { start: DoubleDouble::from_f64(0.3), steps: &steps, q: &q, v: &v, controls: &controls, parameters: &parameters };
    let mut f = ByDuals::new(&case.model, case.system.clone(), &parameters).unwrap();
    let (qs, vs) = rollout(t, integrator, &mut f, &trajectory).unwrap();
    (qs[qs.len() - q.len()..].to_vec(), vs[vs.len() - nv..].to_vec())
}

/// The derivative of the end along a direction, by differences.
pub(super) fn differences<W: Integrator<DoubleDouble>>(case: &Case, integrator: &mut W, direction: &[f64]) -> Vec<f64> {
    // The difference of 32-digit ends errs by the square of this, and by 1e-31 over it.
    const BY: f64 = 1e-9;
    let [forward, backward] = [BY, -BY].map(|by| moved_end(case, integrator, direction, by));
    let mut all: Vec<f64> = difference(&case.model.topology, &backward.0, &forward.0).unwrap().iter().map(|x| x.to_f64()).collect();
    all.extend(forward.1.iter().zip(&backward.1).map(|(forward, backward)| (*forward - *backward).to_f64()));
    all.iter_mut().for_each(|x| *x /= 2.0 * BY);
    all
}

#[test]
fn forward_sensitivities_are_those_of_differences() {
    struct Differences;
    impl Ask for Differences {
        fn ask<I: Integrator<f64>, W: Integrator<DoubleDouble>>(&self, name: &str, case: &Case, mut integrator: I, mut extended: W) {
            let t = &case.model.topology;
            let nv = t.nv();
            let direction = case.direction(3);
            let found = sensitivity(t, &mut integrator, &mut case.by_duals(), &case.rollout(), &direction).unwrap();
            let expected = differences(case, &mut extended, &direction);
            assert_eq!(expected.len(), 2 * nv);
            // Six steps of some hundred operations in f64, whose roundings partly cancel.
            within(&format!("{name}: against differences"), distance(&found, &expected) / (1.0 + largest(&expected)), 2e-14);
        }
    }
    each(&Differences);
}

/// A cost of every variable: of states on the way, of controls and parameters.
struct Everything {
    seed: u64,
}

impl Everything {
    fn weights(&self, at: &Visit<'_, f64>, count: usize) -> Vec<f64> {
        let mut random = Random::new(self.seed, at.index as u64);
        (0..count).map(|_| random.uniform(-1.0, 1.0)).collect()
    }
}

impl Cost<f64> for Everything {
    // Only its gradient is asked for here: it is a linear form in the tangent spaces.
    fn value(&mut self, at: &Visit<'_, f64>) -> f64 {
        let weights = self.weights(at, at.v.len());
        at.v.iter().zip(weights).map(|(v, w)| w * v * v).sum()
    }

    fn add_gradient(&mut self, at: &Visit<'_, f64>, gradient: &mut CostGradient<'_, f64>) {
        let weights = self.weights(at, at.v.len());
        for ((gradient, v), w) in gradient.v.iter_mut().zip(at.v).zip(weights) {
            *gradient += 2.0 * w * v;
        }
    }
}

/// Only the end counts: λ there is given.
struct End {
    gradient: Vec<f64>,
}

impl Cost<f64> for End {
    fn value(&mut self, _: &Visit<'_, f64>) -> f64 {
        0.0
    }

    fn add_gradient(&mut self, at: &Visit<'_, f64>, gradient: &mut CostGradient<'_, f64>) {
        if at.last {
            let (q, v) = self.gradient.split_at(at.v.len());
            gradient.q.iter_mut().zip(q).for_each(|(sum, x)| *sum += x);
            gradient.v.iter_mut().zip(v).for_each(|(sum, x)| *sum += x);
        }
    }
}

pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// λ·(S δ) = (Sᵀ λ)·δ to rounding, with Sᵀλ by the way back and Sδ by the way forward.
#[test]
fn the_adjoint_is_the_transpose() {
    struct Transpose;
    impl Ask for Transpose {
        fn ask<I: Integrator<f64>, W: Integrator<DoubleDouble>>(&self, name: &str, case: &Case, mut integrator: I, _: W) {
            let t = &case.model.topology;
            let mut f = case.by_duals();
            for seed in 0..4 {
                let direction = case.direction(seed);
                let end = sensitivity(t, &mut integrator, &mut f, &case.rollout(), &direction).unwrap();
                let mut cost = End { gradient: case.direction(100 + seed)[..2 * t.nv()].to_vec() };
                let mut gradient = vec![0.0; direction.len()];
                let mut adjoint = Adjoint::new(t, case.steps.len(), 3, case.inputs());
                adjoint.run(&mut integrator, &mut f, &case.rollout(), &mut cost, &mut gradient).unwrap();
                let (forward, backward) = (dot(&cost.gradient, &end), dot(&gradient, &direction));
                // A sum of 2·nv products, each of which has gone through some hundred operations.
                let scale = cost.gradient.iter().zip(&end).map(|(x, y)| (x * y).abs()).sum::<f64>()
                    + gradient.iter().zip(&direction).map(|(x, y)| (x * y).abs()).sum::<f64>();
                within(&format!("{name}: transpose"), (forward - backward).abs() / scale, 1e-14);
            }
        }
    }
    each(&Transpose);
}

/// The gradient does not depend on how many states are kept, to the bit; and it is that of differences of the cost.
#[test]
fn checkpoints_change_nothing_but_the_memory() {
    struct Spacings;
    impl Ask for Spacings {
        fn ask<I: Integrator<f64>, W: Integrator<DoubleDouble>>(&self, name: &str, case: &Case, mut integrator: I, _: W) {
            let t = &case.model.topology;
            let mut f = case.by_duals();
            let mut run = |spacing: usize| {
                let mut gradient = vec![0.0; case.rollout().variables()];
                let mut adjoint = Adjoint::new(t, case.steps.len(), spacing, case.inputs());
                let value = adjoint.run(&mut integrator, &mut f, &case.rollout(), &mut Everything { seed: 1 }, &mut gradient).unwrap();
                (value, gradient, adjoint.states_kept())
            };
            let (value, gradient, all) = run(1);
            assert_eq!(all, case.steps.len() + 1);
            for (spacing, kept) in [(0, 7), (2, 5), (3, 5), (4, 6), (6, 7), (100, 7)] {
                let other = run(spacing);
                assert_eq!((value, &gradient, kept), (other.0, &other.1, other.2), "{name}: spacing {spacing}");
            }
        }
    }
    each(&Spacings);
}

#[test]
fn the_gradient_of_a_running_cost_is_that_of_differences() {
    let case = &cases()[2];
    let t = &case.model.topology;
    let direction = case.direction(5);
    let mut integrator = ImplicitMidpoint::with_derivatives(t, case.inputs());
    let mut f = case.by_duals();
    let mut gradient = vec![0.0; direction.len()];
    let mut adjoint = Adjoint::new(t, case.steps.len(), 2, case.inputs());
    adjoint.run(&mut integrator, &mut f, &case.rollout(), &mut Everything { seed: 1 }, &mut gradient).unwrap();
    let nv = t.nv();
    let mut value = |by: f64| {
        let moved = |x: &[f64], dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + by * dx).collect::<Vec<_>>();
        let q = integrate(t, &case.q, &moved(&vec![0.0; nv], &direction)).unwrap();
        let (v, controls) = (moved(&case.v, &direction[nv..]), moved(&case.controls, &direction[2 * nv..]));
        let parameters = moved(&case.parameters, &direction[2 * nv + controls.len()..]);
        let moved = Rollout { q: &q, v: &v, controls: &controls, parameters: &parameters, ..case.rollout() };
        let mut ignored = vec![0.0; direction.len()];
        adjoint.run(&mut integrator, &mut f, &moved, &mut Everything { seed: 1 }, &mut ignored).unwrap()
    };
    const BY: f64 = 1e-5;
    let expected = (value(BY) - value(-BY)) / (2.0 * BY);
    // Differences in f64: 1e-16 over 1e-5, and the square of that times third derivatives of up to a hundred.
    within("gradient of a running cost", (dot(&gradient, &direction) - expected).abs() / expected.abs(), 1e-8);
}

/// Two routes to the derivatives of the right-hand side: recursions with duals for the forces, and duals through everything.
#[test]
fn recursions_and_duals_agree() {
    let driven = |model: Model<f64>, name| {
        let last = model.inertias[model.inertias.len() - 1].mass;
        (name, Driven { motors: vec![0, model.topology.nv() - 1] }, vec![0.3, last], model)
    };
    let all = ROBOTS.iter().map(|(name, recipe)| driven(build(recipe), *name));
    for (name, system, parameters, model) in all.chain(cases().into_iter().map(|case| driven(case.model, case.name))) {
        let nv = model.topology.nv();
        let mut duals = ByDuals::new(&model, system.clone(), &parameters).unwrap();
        let mut recursions = Analytic::new(&model, system.clone(), &parameters).unwrap();
        let states = StateBatch::random(&model, 3, 2);
        for k in 0..states.count() {
            duals.set_controls(&[0.7, -0.4]).unwrap();
            recursions.set_controls(&[0.7, -0.4]).unwrap();
            let (mut expected, mut found) = (Linearisation::new(nv, 4), Linearisation::new(nv, 4));
            let (mut a, mut b) = (vec![0.0; nv], vec![0.0; nv]);
            duals.linearise(0.3, states.q(k), states.v(k), &mut a, &mut expected).unwrap();
            recursions.linearise(0.3, states.q(k), states.v(k), &mut b, &mut found).unwrap();
            for (what, expected, found) in [
                ("a", &a, &b),
                ("∂a/∂q", &expected.by_q, &found.by_q),
                ("∂a/∂v", &expected.by_v, &found.by_v),
                ("∂a/∂u", &expected.by_input, &found.by_input),
            ] {
                // M has eigenvalues from 10⁻² to 10: a thousand roundings, partly cancelling.
                within(&format!("{name}: {what}"), distance(found, expected) / (1.0 + largest(expected)), 5e-14);
            }
        }
    }
    let model = &cases()[1].model;
    assert!(Analytic::<_, f64>::new(model, Driven { motors: Vec::new() }, &[1.0]).is_err());
    let mut f = Analytic::new(model, Driven { motors: Vec::new() }, &[1.0, 2.0]).unwrap();
    let (mut fits, mut short) = (Linearisation::new(2, 2), Linearisation::new(2, 1));
    assert!(f.linearise(0.0, &[0.0], &[0.0; 2], &mut [0.0; 2], &mut fits).is_err());
    assert!(f.linearise(0.0, &[0.0; 2], &[0.0; 2], &mut [0.0; 2], &mut short).is_err());
    assert!(f.linearise(0.0, &[0.0; 2], &[0.0; 2], &mut [0.0; 2], &mut fits).is_ok());
}

/// The derivative of the steps goes to that of the flow at the order of the integrator.
/// What an integrator gives for a rollout.
type Flow<'a> = dyn FnMut(&mut ByDuals<Driven, f64>, &Rollout<'_, f64>) -> Vec<f64> + 'a;

#[test]
fn sensitivities_converge_at_the_order() {
    struct Orders;
    impl Ask for Orders {
        fn ask<I: Integrator<f64>, W: Integrator<DoubleDouble>>(&self, name: &str, case: &Case, mut integrator: I, _: W) {
            let (t, nv) = (&case.model.topology, case.model.topology.nv());
            let direction = case.direction(7);
            let direction = [&direction[..2 * nv], &direction[direction.len() - 2..]].concat();
            // Without motors: with them the inputs would change with the steps.
            let mut f = ByDuals::new(&case.model, Driven { motors: Vec::new() }, &case.parameters).unwrap();
            let mut flow = |integrator: &mut Flow, count: usize| {
                let steps = vec![0.1 / count as f64; count];
                integrator(&mut f, &Rollout { steps: &steps, controls: &[], ..case.rollout() })
            };
            let mut exact = DormandPrince::with_derivatives(t, 2);
            let truth = flow(&mut |f, rollout| sensitivity(t, &mut exact, f, rollout, &direction).unwrap(), 128);
            let count = if I::ORDER > 3 { 8 } else { 64 };
            let errors = [count, 2 * count].map(|count| {
                let mut integrator = |f: &mut ByDuals<Driven, f64>, rollout: &Rollout<'_, f64>| {
                    let mut result = vec![0.0; 2 * nv];
                    let mut forward = Forward::new(t, 2);
                    forward.run(&mut integrator, f, rollout, &direction, &mut result).unwrap();
                    result
                };
                distance(&flow(&mut integrator, count), &truth)
            });
            let slope = (errors[0] / errors[1]).log2();
            within(&format!("{name}: order of sensitivities by {errors:?}"), (slope - f64::from(I::ORDER)).abs(), 0.2);
        }
    }
    // The workspaces of `each` have room for the motors' derivatives: here the others suffice.
    for case in cases() {
        let t = &case.model.topology;
        macro_rules! ask {
            ($($method:ident),+) => {$(
                let name = format!("{}, {}", stringify!($method), case.name);
                Orders.ask(&name, &case, $method::with_derivatives(t, 2), $method::<DoubleDouble>::new(t));
            )+};
        }
        ask!(SymplecticEuler, ImplicitMidpoint, RungeKutta4, DormandPrince);
    }
}

#[test]
fn what_does_not_fit_is_an_error() {
    let case = &cases()[1];
    let t = &case.model.topology;
    let mut f = case.by_duals();
    let fits = case.rollout();
    let direction = case.direction(1);
    fn complains<T: std::fmt::Debug>(result: Result<T, IntegrationError>) -> bool {
        matches!(result, Err(IntegrationError::Dynamics(_)))
    }
    assert!(complains(sensitivity(t, &mut RungeKutta4::new(t), &mut f, &fits, &direction)), "no room for derivatives");
    assert!(complains(sensitivity(t, &mut SymplecticEuler::new(t), &mut f, &fits, &direction)));
    assert!(complains(sensitivity(t, &mut ImplicitMidpoint::new(t), &mut f, &fits, &direction)));
    let mut integrator = RungeKutta4::with_derivatives(t, case.inputs());
    for wrong in [
        Rollout { q: &fits.q[1..], ..fits },
        Rollout { v: &fits.v[1..], ..fits },
        Rollout { controls: &fits.controls[1..], ..fits },
        Rollout { parameters: &[], ..fits },
    ] {
        assert!(complains(rollout(t, &mut integrator, &mut f, &wrong)), "{wrong:?}");
        let mut gradient = vec![0.0; wrong.variables()];
        let mut cost = Everything { seed: 1 };
        assert!(complains(Adjoint::new(t, 6, 2, case.inputs()).run(&mut integrator, &mut f, &wrong, &mut cost, &mut gradient)));
    }
    let mut cost = Everything { seed: 1 };
    let mut gradient = vec![0.0; direction.len()];
    assert!(complains(Adjoint::new(t, 4, 2, case.inputs()).run(&mut integrator, &mut f, &fits, &mut cost, &mut gradient)), "too long");
    assert!(complains(Adjoint::new(t, 6, 2, 1).run(&mut integrator, &mut f, &fits, &mut cost, &mut gradient)));
    assert!(complains(Adjoint::new(t, 6, 2, case.inputs()).run(&mut integrator, &mut f, &fits, &mut cost, &mut gradient[1..])));
    assert!(complains(Forward::new(t, case.inputs()).run(&mut integrator, &mut f, &fits, &direction[1..], &mut [0.0; 4])));
    assert!(complains(Forward::new(t, case.inputs()).run(&mut integrator, &mut f, &fits, &direction, &mut [0.0; 3])));
    assert!(complains(Forward::new(t, 0).run(&mut integrator, &mut f, &fits, &direction, &mut [0.0; 4])));
    let states = rollout(t, &mut integrator, &mut f, &fits).unwrap();
    let moved = larger(distance(&states.0[..2], &states.0[2..4]), distance(&states.1[..2], &states.1[2..4]));
    assert!(moved > 0.0);
}
