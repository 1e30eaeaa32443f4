//! Our batched kernels as a method of a quantity: a state per lane of a register, on one core.
//!
//! The arrays are in row order, as users have them: bringing states into lanes and results out of them is part of the method.

use crate::kernel::{Evaluate, Failure, Kernel, not_offered};
use featherbench_bench::{BATCH, NoAnswer, Quantity, Robot};
use featherbench_dynamics::{Batch, BatchError, Number, RegressorMatrix};
use featherbench_model::{Model, Topology};
use featherbench_robots::StateBatch;
use featherbench_spatial::Lift;

/// The most bytes of the results of one call, if it is more than one group of states: they stay in the first cache, as those of single
/// states do.
const RESULTS: usize = 32 << 10;
/// The most groups of a call. A call costs some ten nanoseconds, a group some hundred and more.
const GROUPS: usize = 8;

/// A batch with its states and the results of its last call.
struct Batched<'a, S: Number> {
    batch: Batch<'a, S>,
    call: Call<S>,
    /// q, v, and a or τ, state after state, with the numbers of each. After the last state the first ones stand again, as many as a call
    /// takes: so a call may begin at any state.
    inputs: [(Vec<S>, usize); 3],
    results: Vec<S>,
    /// The numbers of one result.
    each: usize,
    /// Where the numbers of the quantity's value are in a result; the others are zero.
    places: Places,
    /// The states of a call.
    together: usize,
    /// The compiled body of a body Jacobian.
    body: usize,
}

/// Answers a quantity for states with these q, v, and a or τ. The body is that of a Jacobian.
type Call<S> = for<'a> fn(&mut Batch<'a, S>, usize, [&[S]; 3], &mut [S]) -> Result<(), BatchError>;

/// In double precision.
pub(crate) fn double<'a>(robot: &'a Robot, states: &'a StateBatch, quantity: Quantity) -> Result<Kernel<'a>, NoAnswer> {
    let call: Call<f64> = match quantity {
        Quantity::InverseDynamics => |batch, _, [q, v, a], out| batch.inverse_dynamics(q, v, a, None, out),
        Quantity::Bias => |batch, _, [q, v, _], out| batch.bias_force(q, v, None, out),
        Quantity::MassMatrixSparse => |batch, _, [q, ..], out| batch.mass_matrix(q, out),
        Quantity::MassMatrixInverse => |batch, _, [q, ..], out| batch.inverse_mass_matrix(q, out),
        Quantity::Momentum => |batch, _, [q, v, _], out| batch.momentum(q, v, out),
        Quantity::BodyAcceleration => |batch, _, [q, v, a], out| batch.kinematics(q, v, a, out),
        Quantity::BodyJacobian => |batch, body, [q, ..], out| batch.body_jacobian(q, body, out),
        Quantity::ForwardDynamics => |batch, _, [q, v, tau], out| batch.forward_dynamics(q, v, tau, None, out),
        Quantity::InverseDynamicsDq | Quantity::InverseDynamicsDv => |batch, _, [q, v, a], out| batch.id_derivatives(q, v, a, None, out),
        Quantity::ForwardDynamicsDq | Quantity::ForwardDynamicsDv => {
            |batch, _, [q, v, tau], out| batch.fd_derivatives(q, v, tau, None, out)
        }
        Quantity::CoriolisMatrix => |batch, _, [q, v, _], out| batch.coriolis_matrix(q, v, out),
        Quantity::TorqueRegressor => |batch, _, [q, v, a], out| batch.torque_regressor(q, v, a, out),
        _ => return Err(not_offered(quantity, BATCH)),
    };
    Ok(Box::new(Batched::new(Batch::new(&robot.model), call, robot, states, quantity)))
}

/// Forward dynamics in single precision throughout, states and parameters rounded to it before.
pub(crate) fn single<'a>(robot: &'a Robot, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let call: Call<f32> = |batch, _, [q, v, tau], a| batch.forward_dynamics(q, v, tau, None, a);
    Box::new(Batched::new(Batch::of_model(robot.model.lift()), call, robot, states, quantity))
}

impl<'a, S: Number + Lift<S::Lanes>> Batched<'a, S> {
    fn new(batch: Batch<'a, S>, call: Call<S>, robot: &Robot, states: &StateBatch, quantity: Quantity) -> Self {
        let topology = &robot.model.topology;
        let body = robot.model.described[robot.deepest_body()];
        let (each, places) = shape(&robot.model, quantity);
        let group = each.max(1) * S::LANES * size_of::<S>();
        let together = S::LANES * (RESULTS / group).clamp(1, GROUPS);
        let third = match quantity {
            Quantity::InverseDynamics
            | Quantity::InverseDynamicsDq
            | Quantity::InverseDynamicsDv
            | Quantity::TorqueRegressor
            | Quantity::BodyAcceleration => StateBatch::a,
            _ => StateBatch::tau,
        };
        let row = |of: fn(&StateBatch, usize) -> &[f64], each: usize| {
            let places = (0..states.count() + together).map(|place| place % states.count());
            (places.flat_map(|k| of(states, k).iter().map(|&x| S::from_f64(x))).collect(), each)
        };
        let inputs = [row(StateBatch::q, topology.nq()), row(StateBatch::v, topology.nv()), row(third, topology.nv())];
        Self { batch, call, inputs, results: vec![S::zero(); each * together], each, places, together, body }
    }

    /// Evaluates `count` states from `k` on.
    fn run(&mut self, k: usize, count: usize) -> Result<(), BatchError> {
        let [q, v, third] = self.inputs.each_ref().map(|(numbers, each)| &numbers[k * each..(k + count) * each]);
        let results = &mut self.results[..count * self.each];
        (self.call)(&mut self.batch, self.body, [q, v, third], results)
    }
}

/// Where the numbers of a value are in a result.
enum Places {
    /// From this one on, in the value's order.
    From(usize),
    /// Of each number of the value; where there is none, it is zero.
    Each(Vec<Option<usize>>),
}

/// The numbers of a body's motion in [`Batch::kinematics`], and where its acceleration begins.
const MOTION: usize = 24;
const ACCELERATION: usize = 18;

/// The numbers of one result of a batch, and where those of the quantity are.
fn shape(model: &Model<f64>, quantity: Quantity) -> (usize, Places) {
    let topology = &model.topology;
    let (nv, stored) = (topology.nv(), topology.stored());
    match quantity {
        Quantity::MassMatrixSparse => (stored, Places::From(0)),
        Quantity::InverseDynamicsDq => (5 * stored, pair(topology, 0)),
        Quantity::InverseDynamicsDv => (5 * stored, pair(topology, 2 * stored)),
        Quantity::CoriolisMatrix => (2 * stored, pair(topology, 0)),
        Quantity::ForwardDynamicsDq => (nv + 3 * nv * nv, Places::From(nv)),
        Quantity::ForwardDynamicsDv => (nv + 3 * nv * nv, Places::From(nv + nv * nv)),
        Quantity::TorqueRegressor => regressor(model),
        Quantity::MassMatrixInverse => (nv * nv, Places::From(0)),
        Quantity::Momentum => (6, Places::From(0)),
        Quantity::BodyAcceleration => {
            let bodies = model.described.len();
            (MOTION * bodies, Places::Each((0..6 * bodies).map(|entry| Some(entry / 6 * MOTION + ACCELERATION + entry % 6)).collect()))
        }
        // Column after column; an answer is row after row.
        Quantity::BodyJacobian => (6 * nv, Places::Each((0..6 * nv).map(|entry| Some(entry % nv * 6 + entry / nv)).collect())),
        _ => (nv, Places::From(0)),
    }
}

/// A matrix row after row, of which the lower and the upper triangle stand from a place on.
fn pair(topology: &Topology, from: usize) -> Places {
    let n = topology.nv();
    let mut places = vec![None; n * n];
    for i in 0..n {
        for (&j, entry) in topology.row_dofs(i).iter().zip(topology.row(i)) {
            places[j * n + i] = Some(from + topology.stored() + entry);
            places[i * n + j] = Some(from + entry);
        }
    }
    Places::Each(places)
}

/// A regressor row after row; its stored numbers stand column after column.
fn regressor(model: &Model<f64>) -> (usize, Places) {
    let matrix = RegressorMatrix::<f64>::new(model);
    let mut places = vec![None; matrix.rows() * matrix.columns()];
    let entries = matrix.iter().flat_map(|(column, dofs, _)| dofs.iter().map(move |dof| (dof, column)));
    for (place, (dof, column)) in entries.enumerate() {
        places[dof * matrix.columns() + column] = Some(place);
    }
    (matrix.values().len(), Places::Each(places))
}

impl<S: Number + Lift<S::Lanes>> Evaluate for Batched<'_, S> {
    /// Alone, so that no other state's failure is this one's.
    fn evaluate(&mut self, k: usize) -> Result<(), Failure> {
        Ok(self.run(k, 1)?)
    }

    fn together(&self) -> usize {
        self.together
    }

    fn sweep(&mut self, k: usize) -> Result<(), Failure> {
        Ok(self.run(k, self.together)?)
    }

    fn read(&self, out: &mut [f64]) {
        match &self.places {
            Places::From(first) => out.iter_mut().zip(&self.results[*first..]).for_each(|(out, x)| *out = x.min_lane()),
            Places::Each(places) => {
                out.iter_mut().zip(places).for_each(|(out, place)| *out = place.map_or(0.0, |place| self.results[place].min_lane()));
            }
        }
    }
}
