//! The registry of our own kernels: which algorithm answers which quantity.
//!
//! A kernel owns its workspace. Evaluating leaves the answer of one state where the algorithm puts it, as in any engine. Reading it into a
//! slice is a separate step. Studies, the timing of runs and `cargo bench` all use this registry: so what is timed is what is checked.

use crate::method::{self, Method};
use crate::{batch, derivatives, factors, parallel, second_derivatives};
use featherbench_bench::{DENSE_LIMIT, NoAnswer, Quantity, Robot, layout};
use featherbench_dynamics::{
    Aba, Batch, Bias, Crba, Energy, Ltdl, PackedAba, PackedCenterOfMass, PackedCrba, PackedJacobian, PackedKinematics, PackedModel,
    PackedMomentum, PackedRnea, Refined, TreeSparse,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{DoubleDouble, Force};

/// Why a kernel has no answer.
pub(crate) type Failure = Box<dyn std::error::Error>;

/// An algorithm over a batch of states.
pub(crate) trait Evaluate: Send {
    /// Evaluates state `k`.
    fn evaluate(&mut self, k: usize) -> Result<(), Failure>;

    /// The number of states that [`Evaluate::sweep`] evaluates.
    fn together(&self) -> usize {
        1
    }

    /// Evaluates as many states from `k` on. Beyond the end of the batch its states begin again.
    fn sweep(&mut self, k: usize) -> Result<(), Failure> {
        self.evaluate(k)
    }

    /// Writes the answer of the last evaluation into a slice as long as the quantity's value.
    fn read(&self, out: &mut [f64]);
}

/// The kernel of a quantity and method.
pub(crate) type Kernel<'a> = Box<dyn Evaluate + 'a>;

/// A kernel of closures that share a workspace; the answer stays in it.
struct Closures<W, E, R> {
    work: W,
    evaluate: E,
    read: R,
}

impl<W, E, R> Evaluate for Closures<W, E, R>
where
    W: Send,
    E: FnMut(&mut W, usize) -> Result<(), Failure> + Send,
    R: Fn(&W, &mut [f64]) + Send,
{
    fn evaluate(&mut self, k: usize) -> Result<(), Failure> {
        (self.evaluate)(&mut self.work, k)
    }

    fn read(&self, out: &mut [f64]) {
        (self.read)(&self.work, out);
    }
}

/// A kernel whose answer stays in its workspace.
pub(crate) fn kept<'a, W: Send + 'a>(
    work: W,
    evaluate: impl FnMut(&mut W, usize) -> Result<(), Failure> + Send + 'a,
    read: impl Fn(&W, &mut [f64]) + Send + 'a,
) -> Kernel<'a> {
    Box::new(Closures { work, evaluate, read })
}

/// A kernel that writes its answer, of this number of values, into a slice itself.
pub(crate) fn written<'a>(size: usize, mut evaluate: impl FnMut(usize, &mut [f64]) -> Result<(), Failure> + Send + 'a) -> Kernel<'a> {
    kept(vec![0.0; size], move |out, k| evaluate(k, out), |answer, out| out.copy_from_slice(answer))
}

/// That the method is none of ours for the quantity.
pub(crate) fn not_offered(quantity: Quantity, method: &str) -> NoAnswer {
    NoAnswer::NotOffered(format!("there is no own method of {} by {method}", quantity.name()))
}

/// The kernel of a quantity and method over a batch of states.
pub(crate) fn kernel<'a>(robot: &'a Robot, quantity: Quantity, method: Method, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    use {Method as M, Quantity as Q};
    let model = &robot.model;
    Ok(match (quantity, method) {
        (Q::InverseDynamics, M::RneaPacked) => inverse_dynamics(model, states),
        (Q::InverseDynamics, M::RneaParallel) => parallel::inverse_dynamics(model, states)?,
        (Q::InverseDynamicsWrench, M::RneaPacked) => inverse_dynamics_wrench(model, states),
        (Q::Bias, M::RneaPacked) => bias(model, states),
        (Q::MassMatrix, M::CrbaPacked | M::Crba | M::Batch) => mass_matrix(model, crba(model, states, method)),
        (Q::MassMatrixProbe, M::CrbaPacked | M::Crba | M::Batch) => mass_matrix_probe(model, crba(model, states, method), robot.probe()),
        (Q::MassMatrixSparse, M::CrbaPacked | M::Crba) => mass_matrix_sparse(model, crba(model, states, method)),
        (Q::MassMatrixSparse, M::CrbaParallel) => mass_matrix_sparse(model, parallel::crba(model, states)?),
        (Q::ForwardDynamics, M::Aba) => forward_dynamics(model, states),
        (Q::ForwardDynamics, M::AbaPacked) => packed_forward_dynamics(model, states),
        (Q::ForwardDynamics, M::AbaParallel) => parallel::forward_dynamics(model, states)?,
        (Q::ForwardDynamics, M::Ltdl) => forward_dynamics_by_factorization(model, states),
        (Q::ForwardDynamics, M::LtdlParallel) => parallel::by_factorization(model, states)?,
        (Q::ForwardDynamics, M::Refined1) => refined_forward_dynamics(robot, states, 1)?,
        (Q::ForwardDynamics, M::Refined2) => refined_forward_dynamics(robot, states, 2)?,
        (Q::ForwardDynamics, M::Twisted) => parallel::from_both_ends(model, states)?,
        (Q::ForwardDynamicsSingle, M::Aba) => forward_dynamics_single(model, states, false),
        (Q::ForwardDynamicsSingle, M::Ltdl) => forward_dynamics_single(model, states, true),
        (Q::ForwardDynamicsSingle, M::Batch) => batch::single(robot, states, quantity),
        (Q::Factorization, M::Ltdl) => factorization(model, states)?,
        (Q::Factorization, M::LtdlParallel) => parallel::factorization(model, states)?,
        (Q::Factorization, M::Batch) => factors::factorization(model, states)?,
        (Q::Solve, M::Ltdl) => solve(model, states)?,
        (Q::Solve, M::Batch) => factors::solve(model, states)?,
        (Q::MassMatrixInverse, M::Ltdl) => mass_matrix_inverse(model, states),
        (Q::KineticEnergy | Q::PotentialEnergy, M::Kinematics) => energy(model, states, quantity),
        (Q::CenterOfMass, M::KinematicsPacked) => center_of_mass(model, states),
        (Q::Momentum, M::KinematicsPacked) => momentum(model, states),
        (Q::BodyPlacement | Q::BodyVelocity | Q::BodyAcceleration, M::KinematicsPacked) => kinematics(model, states, quantity),
        (Q::BodyJacobian, M::KinematicsPacked) => jacobian(model, states, model.described[robot.deepest_body()]),
        (Q::BodyJacobians, M::KinematicsPacked) => jacobians(robot, states),
        (Q::InverseDynamicsDq | Q::InverseDynamicsDv, M::Analytic) => derivatives::inverse_dynamics(robot, states, quantity),
        (Q::ForwardDynamicsDq | Q::ForwardDynamicsDv, M::Analytic) => derivatives::forward_dynamics(robot, states, quantity),
        (Q::CoriolisMatrix, M::Analytic) => derivatives::coriolis(robot, states),
        (Q::TorqueRegressor, M::Analytic) => derivatives::regressor(robot, states),
        (Q::TorqueRegressor, M::Columns) => derivatives::columns(robot, states),
        (Q::InverseDynamicsDq | Q::InverseDynamicsDv | Q::ForwardDynamicsDq | Q::ForwardDynamicsDv | Q::CoriolisMatrix, M::Dual) => {
            derivatives::by_duals(robot, states, quantity)
        }
        (Q::InverseDynamicsSecond, M::Analytic) => second_derivatives::inverse_dynamics(robot, states),
        (Q::ForwardDynamicsSecond, M::Analytic) => second_derivatives::forward_dynamics(robot, states),
        (Q::InverseDynamicsSecond | Q::ForwardDynamicsSecond, M::Dual) => second_derivatives::by_duals(robot, states, quantity),
        // No fill-in: the factors stand in the places of M.
        (Q::StoredEntries, M::Topology) | (Q::FactorEntries, M::Ltdl) => constant(vec![model.topology.stored() as f64]),
        (Q::Readback, M::Build) => constant(robot.readback()),
        (_, M::Batch) => batch::double(robot, states, quantity)?,
        _ => return Err(not_offered(quantity, method.name())),
    })
}

/// The quantities of the timing study, the usual method first. Derivatives of a big robot have nv² numbers, and the check of their answers takes
/// longer than they do.
pub fn timed(robot: &Robot) -> Vec<(Quantity, &'static str)> {
    let small = robot.states.nv <= DENSE_LIMIT;
    counted(robot).into_iter().filter(|(quantity, _)| small || !quantity.is_derivative()).collect()
}

/// The quantities whose instructions are counted, the usual method first: one pass of one algorithm each, from q, v, a or τ to its result.
pub fn counted(robot: &Robot) -> Vec<(Quantity, &'static str)> {
    let quantities = [
        Quantity::InverseDynamics,
        Quantity::Bias,
        Quantity::MassMatrixSparse,
        Quantity::Factorization,
        Quantity::Solve,
        Quantity::MassMatrixInverse,
        Quantity::ForwardDynamics,
        Quantity::ForwardDynamicsSingle,
        Quantity::KineticEnergy,
        Quantity::CenterOfMass,
        Quantity::Momentum,
        Quantity::BodyAcceleration,
        Quantity::BodyJacobian,
    ];
    // A body Jacobian has 6·nv numbers, most of them zero on big robots. Only its nonzero columns would be worth timing. An inverse is dense:
    // the check of its answers takes O(nv³) for each state of the stream, as second derivatives by dual numbers do.
    let dense = |quantity: &Quantity| {
        matches!(quantity, Quantity::BodyJacobian | Quantity::MassMatrixInverse) || Quantity::SECOND_DERIVATIVES.contains(quantity)
    };
    let quantities = quantities.into_iter().chain(Quantity::DERIVATIVES).chain(Quantity::SECOND_DERIVATIVES);
    quantities
        .filter(|quantity| !dense(quantity) || robot.states.nv <= DENSE_LIMIT)
        .flat_map(|quantity| method::timed(quantity).iter().map(move |method| (quantity, method.name())))
        .collect()
}

fn inverse_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let mut rnea = PackedRnea::new(&packed);
    written(model.topology.nv(), move |k, tau| Ok(rnea.run(&packed, states.q(k), states.v(k), states.a(k), None, tau)?))
}

fn inverse_dynamics_wrench<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let mut rnea = PackedRnea::new(&packed);
    let mut wrenches = vec![Force::zero(); model.topology.bodies()];
    written(model.topology.nv(), move |k, tau| {
        for (&body, w) in model.described.iter().zip(states.wrench(k).chunks_exact(6)) {
            wrenches[body] = Force::from_array([w[0], w[1], w[2], w[3], w[4], w[5]]);
        }
        Ok(rnea.run(&packed, states.q(k), states.v(k), states.a(k), Some(&wrenches), tau)?)
    })
}

fn bias<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let mut rnea = PackedRnea::new(&packed);
    written(model.topology.nv(), move |k, h| Ok(rnea.bias(&packed, states.q(k), states.v(k), None, h)?))
}

/// What writes the mass matrix of state k into a tree-sparse matrix.
pub(crate) type Fill<'a> = Box<dyn FnMut(&mut TreeSparse<f64>, usize) -> Result<(), Failure> + Send + 'a>;

/// The mass matrices of a batch of states, one at a time.
fn crba<'a>(model: &'a Model<f64>, states: &'a StateBatch, method: Method) -> Fill<'a> {
    match method {
        Method::Crba => {
            let mut crba = Crba::new(&model.topology);
            Box::new(move |matrix, k| Ok(crba.run(model, states.q(k), matrix)?))
        }
        Method::Batch => {
            let mut batch = Batch::<f64>::new(model);
            Box::new(move |matrix, k| Ok(batch.mass_matrix(states.q(k), matrix.values_mut())?))
        }
        _ => {
            let packed = PackedModel::new(model);
            let mut crba = PackedCrba::new(&packed);
            Box::new(move |matrix, k| Ok(crba.run(&packed, states.q(k), matrix)?))
        }
    }
}

fn mass_matrix<'a>(model: &'a Model<f64>, fill: Fill<'a>) -> Kernel<'a> {
    let read = |matrix: &TreeSparse<f64>, dense: &mut [f64]| {
        let n = model.topology.nv();
        dense.fill(0.0);
        for i in 0..n {
            for (&j, &m) in model.topology.row_dofs(i).iter().zip(&matrix.values()[model.topology.row(i)]) {
                dense[i * n + j] = m;
                dense[j * n + i] = m;
            }
        }
    };
    kept(TreeSparse::new(&model.topology), fill, read)
}

fn mass_matrix_probe<'a>(model: &'a Model<f64>, mut fill: Fill<'a>, probe: Vec<f64>) -> Kernel<'a> {
    let mut matrix = TreeSparse::new(&model.topology);
    written(6 * model.topology.nv(), move |k, out| {
        fill(&mut matrix, k)?;
        Ok(layout::probe(&matrix, &probe, out)?)
    })
}

fn mass_matrix_sparse<'a>(model: &'a Model<f64>, fill: Fill<'a>) -> Kernel<'a> {
    kept(TreeSparse::new(&model.topology), fill, |matrix, out| out.copy_from_slice(matrix.values()))
}

fn forward_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let mut aba = Aba::new(&model.topology);
    written(model.topology.nv(), move |k, a| Ok(aba.run(model, states.q(k), states.v(k), states.tau(k), None, a)?))
}

/// Several joints at a time, in the axes of the base.
fn packed_forward_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let mut aba = PackedAba::new(&packed);
    written(model.topology.nv(), move |k, a| Ok(aba.run(&packed, states.q(k), states.v(k), states.tau(k), None, a)?))
}

fn forward_dynamics_by_factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let (mut crba, mut rnea, mut ltdl) = (PackedCrba::new(&packed), PackedRnea::new(&packed), Ltdl::new(&model.topology));
    written(model.topology.nv(), move |k, a| {
        crba.run(&packed, states.q(k), ltdl.matrix_mut())?;
        ltdl.factor()?;
        rnea.bias(&packed, states.q(k), states.v(k), None, a)?;
        for (a, tau) in a.iter_mut().zip(states.tau(k)) {
            *a = tau - *a;
        }
        Ok(ltdl.solve(a)?)
    })
}

/// In single precision throughout, states and parameters rounded to it.
fn forward_dynamics_single<'a>(model: &'a Model<f64>, states: &'a StateBatch, factorizing: bool) -> Kernel<'a> {
    let model: Model<f32> = model.lift();
    let topology = model.topology.clone();
    let (mut aba, mut crba, mut bias, mut ltdl) = (Aba::new(&topology), Crba::new(&topology), Bias::new(&topology), Ltdl::new(&topology));
    let read = |a: &Vec<f32>, out: &mut [f64]| out.iter_mut().zip(a).for_each(|(out, a)| *out = f64::from(*a));
    let evaluate = move |a: &mut Vec<f32>, k| {
        let [q, v, tau] = [states.q(k), states.v(k), states.tau(k)].map(|values| values.iter().map(|&x| x as f32).collect::<Vec<_>>());
        if factorizing {
            crba.run(&model, &q, ltdl.matrix_mut())?;
            ltdl.factor()?;
            bias.run(&model, &q, &v, None, a)?;
            a.iter_mut().zip(&tau).for_each(|(a, tau)| *a = tau - *a);
            ltdl.solve(a)?;
        } else {
            aba.run(&model, &q, &v, &tau, None, a)?;
        }
        Ok(())
    };
    kept(vec![0.0; topology.nv()], evaluate, read)
}

/// Whether a method needs the robot's description beside its model.
pub fn reads_description(method: &str) -> bool {
    matches!(Method::parse(method), Some(Method::Refined1 | Method::Refined2))
}

/// Refined with the residual in double-double, of the robot as its description says it.
fn refined_forward_dynamics<'a>(robot: &'a Robot, states: &'a StateBatch, steps: usize) -> Result<Kernel<'a>, NoAnswer> {
    let model: Model<DoubleDouble> = Model::build(&robot.description).map_err(|error| NoAnswer::Failed(error.to_string()))?;
    let mut refined = Refined::<DoubleDouble>::new(&model.topology, steps);
    Ok(written(robot.model.topology.nv(), move |k, a| Ok(refined.run(&model, states.q(k), states.v(k), states.tau(k), None, a)?)))
}

/// The stored numbers of the mass matrices of a batch, computed before: the time of factorizing and solving excludes computing them.
pub(crate) fn matrices(model: &Model<f64>, states: &StateBatch) -> Result<Vec<Vec<f64>>, NoAnswer> {
    let (mut crba, mut matrix) = (crba(model, states, Method::CrbaPacked), TreeSparse::new(&model.topology));
    // Big robots use a few matrices in turn: thousands of them would not fit the memory.
    let count = states.count().min(1 + (32 << 20) / (8 * model.topology.stored().max(1)));
    (0..count)
        .map(|k| {
            crba(&mut matrix, k).map_err(|error| NoAnswer::Failed(error.to_string()))?;
            Ok(matrix.values().to_vec())
        })
        .collect()
}

fn factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let matrices = matrices(model, states)?;
    let evaluate = move |ltdl: &mut Ltdl<f64>, k: usize| {
        ltdl.matrix_mut().values_mut().copy_from_slice(&matrices[k % matrices.len()]);
        Ok(ltdl.factor()?)
    };
    Ok(kept(Ltdl::new(&model.topology), evaluate, |ltdl, out| out.copy_from_slice(ltdl.factors().values())))
}

fn solve<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let mut ltdl = Ltdl::new(&model.topology);
    let factored = |matrix: &Vec<f64>| {
        ltdl.matrix_mut().values_mut().copy_from_slice(matrix);
        ltdl.factor().map_err(|error| NoAnswer::Failed(error.to_string()))?;
        Ok(ltdl.factors().clone())
    };
    let mut factors = matrices(model, states)?.iter().map(factored).collect::<Result<Vec<_>, NoAnswer>>()?;
    Ok(written(model.topology.nv(), move |k, x| {
        x.copy_from_slice(states.tau(k));
        let at = k % factors.len();
        ltdl.matrix_mut().exchange(&mut factors[at])?;
        let solved = ltdl.solve(x);
        ltdl.matrix_mut().exchange(&mut factors[at])?;
        Ok(solved?)
    }))
}

/// Factors, then the inverse from them.
fn mass_matrix_inverse<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let (mut crba, mut ltdl) = (crba(model, states, Method::CrbaPacked), Ltdl::new(&model.topology));
    written(model.topology.nv() * model.topology.nv(), move |k, inverse| {
        crba(ltdl.matrix_mut(), k)?;
        ltdl.factor()?;
        Ok(ltdl.inverse(inverse)?)
    })
}

fn energy<'a>(model: &'a Model<f64>, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let mut energy = Energy::new(&model.topology);
    written(1, move |k, out| {
        let energies = energy.run(model, states.q(k), states.v(k))?;
        out[0] = if quantity == Quantity::KineticEnergy { energies.kinetic } else { energies.potential };
        Ok(())
    })
}

fn center_of_mass<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let mut center = PackedCenterOfMass::new(&packed);
    written(3, move |k, out| {
        out.copy_from_slice(&center.run(&packed, states.q(k))?.position.to_array());
        Ok(())
    })
}

fn momentum<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let mut momentum = PackedMomentum::new(&packed);
    written(6, move |k, out| {
        out.copy_from_slice(&momentum.run(&packed, states.q(k), states.v(k))?.momentum.to_array());
        Ok(())
    })
}

fn kinematics<'a>(model: &'a Model<f64>, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let work = PackedKinematics::new(&packed);
    let evaluate = move |kinematics: &mut PackedKinematics, k| Ok(kinematics.run(&packed, states.q(k), states.v(k), states.a(k))?);
    let read = move |kinematics: &PackedKinematics, out: &mut [f64]| {
        layout::bodies(quantity, |body| kinematics.body(body), &model.described, out);
    };
    kept(work, evaluate, read)
}

fn jacobian<'a>(model: &'a Model<f64>, states: &'a StateBatch, body: usize) -> Kernel<'a> {
    let packed = PackedModel::new(model);
    let work = PackedJacobian::new(&packed);
    let evaluate = move |jacobian: &mut PackedJacobian, k| Ok(jacobian.run(&packed, states.q(k), body).map(|_| ())?);
    let read = |jacobian: &PackedJacobian, out: &mut [f64]| layout::jacobian(jacobian.columns(), out);
    kept(work, evaluate, read)
}

/// Products of each body's Jacobian with vectors of the probe.
fn jacobians<'a>(robot: &'a Robot, states: &'a StateBatch) -> Kernel<'a> {
    let (model, probe) = (&robot.model, robot.probe());
    let packed = PackedModel::new(model);
    let mut work = PackedJacobian::new(&packed);
    let size = Quantity::BodyJacobians.size(robot);
    let each = size / model.described.len();
    written(size, move |k, out| {
        for (out, &body) in out.chunks_exact_mut(each).zip(&model.described) {
            let columns = work.run(&packed, states.q(k), body)?;
            layout::jacobian_products(|row, dof| columns[dof].to_array()[row], &probe, states.nv, out);
        }
        Ok(())
    })
}

fn constant<'a>(values: Vec<f64>) -> Kernel<'a> {
    kept(values, |_, _| Ok(()), |values, out| out.copy_from_slice(values))
}
