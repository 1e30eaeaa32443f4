//! The truth: answers in double-double arithmetic from the description's own numbers. And the conditioning bound.
//!
//! The kernels are ours, the arithmetic has 32 digits. Its rounding errors are 1e-32 times the conditioning, far below the digits of f64.
//! The kernels themselves are confirmed by the crate `reference` and `oracles/featherbench_oracles/truth/`. These share no text with
//! them, and agree with them where that was recorded.

pub mod by_duals;
pub(crate) mod derivative_floor;

use crate::by_duals::{ByDuals, Columns, Point};
use crate::{Quantity, Robot, layout};
use featherbench_dynamics::{Aba, Bias, CenterOfMass, Crba, Energy, Jacobian, Kinematics, Momentum, Rnea, TreeSparse};
use featherbench_model::Model;
use featherbench_spatial::{DoubleDouble, Dual, Force, Lift, Real};

/// A model in extended precision; its inertias are formed in that precision from the description.
pub struct TruthModel(Model<DoubleDouble>);

/// Derivatives in extended precision: dual numbers over double-double through the kernels.
///
/// It is not the text of analytic derivatives. A test compares it with differences in double-double.
pub struct TrueDerivatives {
    duals: ByDuals<DoubleDouble>,
    columns: Columns<DoubleDouble>,
}

impl TrueDerivatives {
    /// Those of a robot; `None` when its description cannot be built.
    pub fn new(robot: &Robot) -> Option<Self> {
        let duals = ByDuals::new(Model::build(&robot.description).ok()?);
        Some(Self { duals, columns: Columns::new(Model::build(&robot.description).ok()?) })
    }

    /// The true value of a derivative at state `k`, in the quantity's layout; `None` if there is none, or the quantity is no derivative.
    pub fn answer(&mut self, robot: &Robot, quantity: Quantity, k: usize) -> Option<Vec<f64>> {
        let wide = |values: &[f64]| -> Vec<DoubleDouble> { values.iter().map(|&x| x.lift()).collect() };
        let [q, v, a, tau] = [robot.states.q(k), robot.states.v(k), robot.states.a(k), robot.states.tau(k)].map(wide);
        let at = Point { q: &q, v: &v, a: &a, tau: &tau };
        let mut out = vec![DoubleDouble::zero(); quantity.size(robot)];
        if quantity == Quantity::TorqueRegressor {
            self.columns.run(at, &mut out).ok()?;
        } else if !self.duals.run(quantity, at, &mut out).ok()? {
            return None;
        }
        Some(out.iter().map(|x| x.to_f64()).collect())
    }
}

/// The truth at one state, to the nearest f64.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Inverse dynamics.
    pub inverse_dynamics: Vec<f64>,
    /// The joint-space inertia matrix.
    pub mass: TreeSparse<f64>,
    /// Forward dynamics; `None` where M is singular.
    pub forward_dynamics: Option<Vec<f64>>,
}

impl TruthModel {
    /// The model of a robot; `None` when its description cannot be built.
    pub fn new(robot: &Robot) -> Option<Self> {
        Model::build(&robot.description).ok().map(Self)
    }

    /// The true answer to a quantity at state `k`, in the quantity's layout; `None` if there is none, or no study needs it.
    pub fn answer(&self, robot: &Robot, quantity: Quantity, k: usize) -> Option<Vec<f64>> {
        let (model, states) = (&self.0, &robot.states);
        let topology = &model.topology;
        let wide = |values: &[f64]| -> Vec<DoubleDouble> { values.iter().map(|&x| x.lift()).collect() };
        let (q, v, a) = (wide(states.q(k)), wide(states.v(k)), wide(states.a(k)));
        let mut out = vec![DoubleDouble::zero(); quantity.size(robot)];
        match quantity {
            Quantity::InverseDynamics => Rnea::new(topology).run(model, &q, &v, &a, None, &mut out).ok()?,
            Quantity::InverseDynamicsWrench => {
                let mut wrenches = vec![Force::zero(); topology.bodies()];
                for (&body, w) in model.described.iter().zip(states.wrench(k).chunks_exact(6)) {
                    wrenches[body] = Force::from_array([w[0], w[1], w[2], w[3], w[4], w[5]].map(Real::from_f64));
                }
                Rnea::new(topology).run(model, &q, &v, &a, Some(&wrenches), &mut out).ok()?;
            }
            Quantity::Bias => Bias::new(topology).run(model, &q, &v, None, &mut out).ok()?,
            Quantity::ForwardDynamics => Aba::new(topology).run(model, &q, &v, &wide(states.tau(k)), None, &mut out).ok()?,
            Quantity::MassMatrix | Quantity::MassMatrixProbe => {
                let mut mass = TreeSparse::new(topology);
                Crba::new(topology).run(model, &q, &mut mass).ok()?;
                match quantity {
                    Quantity::MassMatrix => layout::dense(&mass, &mut out),
                    _ => layout::probe(&mass, &wide(&robot.probe()), &mut out).ok()?,
                }
            }
            Quantity::KineticEnergy => out[0] = Energy::new(topology).run(model, &q, &v).ok()?.kinetic,
            Quantity::PotentialEnergy => out[0] = Energy::new(topology).run(model, &q, &v).ok()?.potential,
            Quantity::CenterOfMass => {
                out.copy_from_slice(&CenterOfMass::new(topology).run(model, &q).ok()?.position.to_array());
            }
            Quantity::Momentum => out.copy_from_slice(&Momentum::new(topology).run(model, &q, &v).ok()?.momentum.to_array()),
            Quantity::BodyPlacement | Quantity::BodyVelocity | Quantity::BodyAcceleration => {
                let mut kinematics = Kinematics::new(topology);
                kinematics.run(model, &q, &v, &a).ok()?;
                layout::bodies(quantity, |body| kinematics.body(body), &model.described, &mut out);
            }
            Quantity::BodyJacobian => {
                let body = model.described[robot.deepest_body()];
                layout::jacobian(Jacobian::new(topology).run(model, &q, body).ok()?, &mut out);
            }
            Quantity::BodyJacobians => {
                // J x is the velocity at v = x.
                let (mut kinematics, nv) = (Kinematics::new(topology), states.nv);
                let each = out.len() / model.described.len();
                for (x, place) in robot.probe().chunks_exact(nv).zip((0..each).step_by(6)) {
                    kinematics.run(model, &q, &wide(x), &a).ok()?;
                    for (out, &body) in out.chunks_exact_mut(each).zip(&model.described) {
                        out[place..place + 6].copy_from_slice(&kinematics.body(body)?.velocity.to_array());
                    }
                }
            }
            _ => return None,
        }
        Some(out.iter().map(|x| x.to_f64()).collect())
    }

    /// The truth at state `k`.
    pub fn at(&self, robot: &Robot, k: usize) -> Option<Truth> {
        let (model, states) = (&self.0, &robot.states);
        let topology = &model.topology;
        let wide = |values: &[f64]| -> Vec<DoubleDouble> { values.iter().map(|&x| x.lift()).collect() };
        let narrow = |values: &[DoubleDouble]| -> Vec<f64> { values.iter().map(|x| x.to_f64()).collect() };
        let (q, v) = (wide(states.q(k)), wide(states.v(k)));

        let mut tau = vec![DoubleDouble::zero(); states.nv];
        Rnea::new(topology).run(model, &q, &v, &wide(states.a(k)), None, &mut tau).ok()?;
        let mut mass = TreeSparse::new(topology);
        Crba::new(topology).run(model, &q, &mut mass).ok()?;
        let mut a = vec![DoubleDouble::zero(); states.nv];
        let solved = Aba::new(topology).run(model, &q, &v, &wide(states.tau(k)), None, &mut a).is_ok();
        Some(Truth {
            inverse_dynamics: narrow(&tau),
            mass: TreeSparse::from_fn(topology, |i, j| mass.get(i, j).to_f64()),
            forward_dynamics: solved.then(|| narrow(&a)),
        })
    }
}

/// The conditioning bound of forward dynamics at state `k`. It is the relative change of the true answer when every input changes by half
/// an ulp: `‖ |∂q̈/∂x|·|x|·u ‖₂ / ‖q̈‖₂`, with u = 2⁻⁵³. The inputs x are q, v, τ, armature,
/// gravity, and all masses, lengths and inertias.
///
/// Rotations and axes are constant: changed entry by entry they would not be rotations. It is a worst case: the magnitudes of all changes
/// are added. Random roundings of the inputs change the answer by about a tenth of it.
/// It is computed by forward-mode differentiation through the articulated-body algorithm, input after input: O(n²). `None` where M is
/// singular.
pub fn conditioning_bound(robot: &Robot, k: usize) -> Option<f64> {
    let states = &robot.states;
    let constant = |values: &[f64]| -> Vec<Number> { values.iter().map(|&x| Dual::constant(x)).collect() };
    let mut inputs = Inputs {
        model: robot.model.lift(),
        q: constant(states.q(k)),
        v: constant(states.v(k)),
        tau: constant(states.tau(k)),
        aba: Aba::new(&robot.model.topology),
        a: vec![Dual::zero(); states.nv],
        moved: vec![0.0; states.nv],
    };
    (0..states.nq).try_for_each(|i| inputs.move_by_itself(&|inputs| &mut inputs.q[i]))?;
    (0..states.nv).try_for_each(|i| inputs.move_by_itself(&|inputs| &mut inputs.v[i]))?;
    (0..states.nv).try_for_each(|i| inputs.move_by_itself(&|inputs| &mut inputs.tau[i]))?;
    (0..states.nv).try_for_each(|i| inputs.move_by_itself(&|inputs| &mut inputs.model.armature[i]))?;
    for parameter in parameters::<Number>() {
        (0..robot.model.topology.bodies()).try_for_each(|body| inputs.move_by_itself(&|inputs| parameter(&mut inputs.model, body)))?;
    }
    inputs.move_by_itself(&|inputs| &mut inputs.model.gravity.x)?;
    inputs.move_by_itself(&|inputs| &mut inputs.model.gravity.y)?;
    inputs.move_by_itself(&|inputs| &mut inputs.model.gravity.z)?;
    let square = |x: f64| x * x;
    let moved = inputs.moved.iter().copied().map(square).sum::<f64>().sqrt();
    let answer = inputs.a.iter().map(|a| square(a.value)).sum::<f64>().sqrt();
    Some(0.5 * f64::EPSILON * moved / answer)
}

type Number = Dual<f64>;

/// The inputs of forward dynamics, and the change of the answer so far.
struct Inputs {
    model: Model<Number>,
    q: Vec<Number>,
    v: Vec<Number>,
    tau: Vec<Number>,
    aba: Aba<Number>,
    a: Vec<Number>,
    moved: Vec<f64>,
}

impl Inputs {
    /// Changes one input at the rate of its own magnitude. An input that is zero is exact and does not change.
    fn move_by_itself(&mut self, input: &dyn Fn(&mut Self) -> &mut Number) -> Option<()> {
        let rate = input(self).value.abs();
        if rate == 0.0 {
            return Some(());
        }
        input(self).derivative = rate;
        let Self { model, q, v, tau, aba, a, .. } = self;
        aba.run(model, q, v, tau, None, a).ok()?;
        input(self).derivative = 0.0;
        self.moved.iter_mut().zip(&self.a).for_each(|(moved, a)| *moved += a.derivative.abs());
        Some(())
    }
}

/// The masses, moments, inertias and lengths of a body, one by one.
pub(crate) fn parameters<T>() -> [fn(&mut Model<T>, usize) -> &mut T; 13] {
    [
        |m, i| &mut m.inertias[i].mass,
        |m, i| &mut m.inertias[i].first_moment.x,
        |m, i| &mut m.inertias[i].first_moment.y,
        |m, i| &mut m.inertias[i].first_moment.z,
        |m, i| &mut m.inertias[i].rotational.xx,
        |m, i| &mut m.inertias[i].rotational.xy,
        |m, i| &mut m.inertias[i].rotational.xz,
        |m, i| &mut m.inertias[i].rotational.yy,
        |m, i| &mut m.inertias[i].rotational.yz,
        |m, i| &mut m.inertias[i].rotational.zz,
        |m, i| &mut m.placements[i].translation.x,
        |m, i| &mut m.placements[i].translation.y,
        |m, i| &mut m.placements[i].translation.z,
    ]
}
