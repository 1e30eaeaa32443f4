//! What batches compute, beside the kernels of single states: for all tests of batches.

use featherbench_dynamics::{
    Aba, Batch, BatchError, Bias, Crba, Element, FdDerivatives, FdPartials, IdDerivatives, IdPartials, Ltdl, Number, Refined, Rnea,
    Sharing, centroidal_momentum, coriolis_matrix, forward_kinematics, jacobian, mass_matrix, to_lanes, to_rows, torque_regressor,
};
use featherbench_model::{Model, Topology};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Compensated, Force, Lift, Real};

/// Steps of refinement. In single precision the plain algorithm keeps four digits of some robots.
pub const STEPS: usize = 3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    InverseDynamics,
    Bias,
    ForwardDynamics,
    Refined,
    MassMatrix,
    Factors,
    Solution,
    InverseMassMatrix,
    Motion,
    /// Of the last body.
    Jacobian,
    Momentum,
    IdDerivatives,
    FdDerivatives,
    Coriolis,
    Regressor,
}

use Quantity::*;

/// A quantity, and whether there are external wrenches.
pub type Asked = (Quantity, bool);

/// What every quantity is computed from. The right-hand sides of solutions are τ.
#[derive(Clone)]
pub struct States<E> {
    pub q: Vec<E>,
    pub v: Vec<E>,
    pub a: Vec<E>,
    pub tau: Vec<E>,
    /// External wrenches, six numbers per body.
    pub wrenches: Vec<E>,
    last: usize,
}

impl<S: Number> States<S> {
    pub fn random(model: &Model<f64>, count: usize) -> Self {
        let states = StateBatch::random(model, count, 3);
        let wrenches: Vec<f64> = (0..count as u64).flat_map(|seed| super::wrenches(model, seed)).flat_map(|f| f.to_array()).collect();
        let [q, v, a, tau, wrenches] = [&states.q, &states.v, &states.a, &states.tau, &wrenches]
            .map(|numbers| -> Vec<S> { numbers.iter().map(|&x| S::from_f64(x)).collect() });
        Self { q, v, a, tau, wrenches, last: model.topology.bodies() - 1 }
    }

    /// The same in lane order.
    fn in_lanes(&self, t: &Topology) -> States<S::Lanes> {
        let lanes = |rows: &[S], each| to_lanes(rows, each).unwrap();
        let [v, a, tau] = [&self.v, &self.a, &self.tau].map(|rows| lanes(rows, t.nv()));
        States { q: lanes(&self.q, t.nq()), v, a, tau, wrenches: lanes(&self.wrenches, 6 * t.bodies()), last: self.last }
    }

    /// State k in another scalar: q, v, a, τ, and the wrenches if there are any.
    fn one<T: Real>(&self, t: &Topology, k: usize, forced: bool) -> ([Vec<T>; 4], Option<Vec<Force<T>>>)
    where
        S: Lift<T>,
    {
        let part = |array: &[S], each| -> Vec<T> { array[k * each..][..each].iter().map(|x| x.lift()).collect() };
        let numbers = part(&self.wrenches, 6 * t.bodies());
        let forces = numbers.as_chunks().0.iter().map(|f| Force::from_array(*f)).collect();
        ([part(&self.q, t.nq()), part(&self.v, t.nv()), part(&self.a, t.nv()), part(&self.tau, t.nv())], forced.then_some(forces))
    }
}

/// What was asked, what the call returned, and the results in row order.
pub type Outcome<S> = Vec<(Asked, Result<(), BatchError>, Vec<S>)>;

fn call<S: Number, M: Sharing, E: Element<S>>(
    batch: &mut Batch<'_, S, M>,
    (quantity, forced): Asked,
    states: &States<E>,
    out: &mut [E],
) -> Result<(), BatchError> {
    let States { q, v, a, tau, wrenches, last } = states;
    let f = forced.then_some(&wrenches[..]);
    match quantity {
        InverseDynamics => batch.inverse_dynamics(q, v, a, f, out),
        Quantity::Bias => batch.bias_force(q, v, f, out),
        ForwardDynamics => batch.forward_dynamics(q, v, tau, f, out),
        Quantity::Refined => batch.refined_forward_dynamics(q, v, tau, f, STEPS, out),
        MassMatrix => batch.mass_matrix(q, out),
        Factors => batch.factors(q, out),
        Solution => batch.solve(q, tau, out),
        InverseMassMatrix => batch.inverse_mass_matrix(q, out),
        Motion => batch.kinematics(q, v, a, out),
        Jacobian => batch.body_jacobian(q, *last, out),
        Momentum => batch.momentum(q, v, out),
        Quantity::IdDerivatives => batch.id_derivatives(q, v, a, f, out),
        Quantity::FdDerivatives => batch.fd_derivatives(q, v, tau, f, out),
        Coriolis => batch.coriolis_matrix(q, v, out),
        Regressor => batch.torque_regressor(q, v, a, out),
    }
}

/// The numbers of a quantity per state.
pub fn size<P>(quantity: Quantity, model: &Model<P>) -> usize {
    let (n, stored, bodies) = (model.topology.nv(), model.topology.stored(), model.described.len());
    match quantity {
        InverseDynamics | Quantity::Bias | ForwardDynamics | Quantity::Refined | Solution => n,
        MassMatrix | Factors => stored,
        InverseMassMatrix => n * n,
        Motion => 24 * bodies,
        Jacobian => 6 * n,
        Momentum => 6,
        Quantity::IdDerivatives => 5 * stored,
        Quantity::FdDerivatives => n + 3 * n * n,
        Coriolis => 2 * stored,
        Regressor => featherbench_dynamics::RegressorMatrix::<f64>::new(model).values().len(),
    }
}

pub fn in_rows<S: Number, M: Sharing>(batch: &mut Batch<'_, S, M>, model: &Model<S>, asked: &[Asked], states: &States<S>) -> Outcome<S> {
    let count = states.v.len() / model.topology.nv();
    let with = |&asked: &Asked| {
        let mut out = vec![S::zero(); count * size(asked.0, model)];
        (asked, call(batch, asked, states, &mut out), out)
    };
    asked.iter().map(with).collect()
}

/// The same through arrays in lane order.
pub fn in_lanes<S: Number, M: Sharing>(batch: &mut Batch<'_, S, M>, model: &Model<S>, asked: &[Asked], states: &States<S>) -> Outcome<S> {
    let (count, lanes) = (states.v.len() / model.topology.nv(), states.in_lanes(&model.topology));
    let with = |&asked: &Asked| {
        let each = size(asked.0, model);
        let mut out = vec![S::Lanes::zero(); lanes.v.len() / model.topology.nv() * each];
        let done = call(batch, asked, &lanes, &mut out);
        (asked, done, to_rows(&out, each, count).unwrap())
    };
    asked.iter().map(with).collect()
}

/// Each quantity of one state k after the other.
pub fn one_by_one<S: Number>(states: &States<S>, t: &Topology, single: impl FnMut(usize) -> Vec<f64>) -> Vec<f64> {
    (0..states.v.len() / t.nv()).flat_map(single).collect()
}

/// A quantity of dynamics of state k, in the scalar T.
pub fn dynamics<S: Number + Lift<T>, T: Real>(model: &Model<S>, states: &States<S>, k: usize, (quantity, forced): Asked) -> Vec<f64> {
    let t = &model.topology;
    let ([q, v, a, tau], f) = states.one::<T>(t, k, forced);
    let (f, mut out, mut ltdl) = (f.as_deref(), vec![T::zero(); t.nv()], Ltdl::new(t));
    match quantity {
        InverseDynamics => Rnea::new(t).run(model, &q, &v, &a, f, &mut out).unwrap(),
        Quantity::Bias => Bias::new(t).run(model, &q, &v, f, &mut out).unwrap(),
        ForwardDynamics => Aba::new(t).run(model, &q, &v, &tau, f, &mut out).unwrap(),
        MassMatrix | Factors | Solution => {
            Crba::new(t).run(model, &q, ltdl.matrix_mut()).unwrap();
            if quantity != MassMatrix {
                ltdl.factor().unwrap();
            }
            if quantity == Solution {
                out.copy_from_slice(&tau);
                ltdl.solve(&mut out).unwrap();
            } else {
                out = ltdl.factors().values().to_vec();
            }
        }
        _ => panic!("{quantity:?} is not asked in other scalars"),
    }
    out.iter().map(|x| x.min_lane()).collect()
}

/// Refined forward dynamics of state k.
pub fn refined<S: Number>(model: &Model<S>, states: &States<S>, k: usize, forced: bool) -> Vec<f64> {
    let ([q, v, _, tau], f) = states.one::<S>(&model.topology, k, forced);
    let mut out = vec![S::zero(); model.topology.nv()];
    Refined::<Compensated<S>, S>::new(&model.topology, STEPS).run(model, &q, &v, &tau, f.as_deref(), &mut out).unwrap();
    out.iter().map(|x| x.min_lane()).collect()
}

/// Motions, the inverse of M and derivatives of state k.
pub fn further(model: &Model<f64>, states: &States<f64>, k: usize, (quantity, forced): Asked) -> Vec<f64> {
    let t = &model.topology;
    let ([q, v, a, tau], f) = states.one::<f64>(t, k, forced);
    match quantity {
        InverseMassMatrix => {
            let mut inverse = vec![0.0; t.nv() * t.nv()];
            mass_matrix(model, &q).unwrap().into_ltdl().unwrap().inverse(&mut inverse).unwrap();
            inverse
        }
        Motion => {
            let kinematics = forward_kinematics(model, &q, &v, &a).unwrap();
            let numbers = |&body: &usize| {
                let motion = kinematics.body(body).unwrap();
                let (place, rates) = (motion.placement, [motion.velocity.to_array(), motion.acceleration.to_array()]);
                [place.rotation.to_array().to_vec(), place.translation.to_array().to_vec(), rates.concat()].concat()
            };
            model.described.iter().flat_map(numbers).collect()
        }
        Jacobian => jacobian(model, &q, states.last).unwrap().iter().flat_map(|column| column.to_array()).collect(),
        Momentum => centroidal_momentum(model, &q, &v).unwrap().momentum.to_array().to_vec(),
        Quantity::IdDerivatives => {
            let mut id = IdPartials::new(t);
            IdDerivatives::new(t).run(model, &q, &v, &a, f.as_deref(), &mut id).unwrap();
            [id.q.lower(), id.q.upper(), id.v.lower(), id.v.upper(), id.a.values()].concat()
        }
        Quantity::FdDerivatives => {
            let mut fd = FdPartials::new(t);
            FdDerivatives::new(t).run(model, &q, &v, &tau, f.as_deref(), &mut fd).unwrap();
            [&fd.acceleration[..], &fd.q, &fd.v, &fd.tau].concat()
        }
        Coriolis => {
            let c = coriolis_matrix(model, &q, &v).unwrap();
            [c.lower(), c.upper()].concat()
        }
        Regressor => torque_regressor(model, &q, &v, &a).unwrap().values().to_vec(),
        _ => panic!("{quantity:?} is a quantity of dynamics"),
    }
}

/// The largest difference, relative to the largest number of the `each` numbers of a state.
pub fn relative<S: Number>(each: usize, found: &[S], truth: &[f64]) -> f64 {
    assert_eq!(found.len(), truth.len());
    let found: Vec<f64> = found.iter().map(|x| x.min_lane()).collect();
    let of_state = |(found, truth): (&[f64], &[f64])| super::distance(found, truth) / super::largest(truth);
    found.chunks(each).zip(truth.chunks(each)).map(of_state).fold(0.0, super::larger)
}

/// The bits of results, and which calls succeeded.
pub fn bits<S: Number>(outcome: &Outcome<S>) -> Vec<(bool, Vec<u64>)> {
    outcome.iter().map(|(_, done, out)| (done.is_ok(), out.iter().map(|x| x.min_lane().to_bits()).collect())).collect()
}
