//! Our own second derivatives as kernels of the registry: those of μ·ID and λ·FD, with the weights that the quantity names.

use crate::kernel::{Failure, Kernel, kept, written};
use featherbench_bench::by_duals::{move_along, still};
use featherbench_bench::{Quantity, Robot};
use featherbench_dynamics::{
    FdDerivatives, FdHessian, FdPartials, FdSecondPartials, IdDerivatives, IdHessian, IdPartials, IdSecondPartials, State,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::Dual;

/// Of μ·ID by closed recursions.
pub(crate) fn inverse_dynamics<'a>(robot: &'a Robot, states: &'a StateBatch) -> Kernel<'a> {
    let model = &robot.model;
    let mut hessian = IdHessian::new(&model.topology);
    let evaluate = move |second: &mut IdSecondPartials<f64>, k| {
        let state = State { q: states.q(k), v: states.v(k), given: states.a(k), wrenches: None };
        Ok(hessian.run(model, state, states.tau(k), second)?)
    };
    let n = model.topology.nv();
    let read = move |second: &IdSecondPartials<f64>, out: &mut [f64]| {
        for (place, entry) in out.iter_mut().enumerate() {
            let (j, k) = (place / n % n, place % n);
            *entry = match place / (n * n) {
                0 => second.qq.get(j, k),
                1 => second.qv.get(j, k),
                2 => second.vv.get(j, k),
                _ => second.qa.get(j, k),
            };
        }
    };
    kept(IdSecondPartials::new(&model.topology), evaluate, read)
}

/// Of λ·FD by closed recursions; first derivatives and M⁻¹ are computed with them.
pub(crate) fn forward_dynamics<'a>(robot: &'a Robot, states: &'a StateBatch) -> Kernel<'a> {
    let model = &robot.model;
    let mut hessian = FdHessian::new(&model.topology);
    let evaluate = move |(first, second): &mut (FdPartials<f64>, FdSecondPartials<f64>), k| {
        let state = State { q: states.q(k), v: states.v(k), given: states.tau(k), wrenches: None };
        Ok(hessian.run(model, state, states.a(k), first, second)?)
    };
    let read = |(_, second): &(FdPartials<f64>, FdSecondPartials<f64>), out: &mut [f64]| {
        let blocks = [&second.qq, &second.qv, &second.vv, &second.qtau];
        out.iter_mut().zip(blocks.into_iter().flatten()).for_each(|(out, entry)| *out = *entry);
    };
    kept((FdPartials::new(&model.topology), FdSecondPartials::new(&model.topology)), evaluate, read)
}

/// What is moved along a dof: the block of the derivative by q, or that of the derivative by v, follows.
#[derive(Clone, Copy)]
enum Along {
    Configuration,
    Velocity,
    /// The acceleration of ID, the joint force of FD.
    Last,
}

/// First derivatives in dual numbers, one dof at a time.
struct Duals<'a> {
    model: &'a Model<f64>,
    id: IdDerivatives<Dual<f64>>,
    fd: FdDerivatives<Dual<f64>>,
    id_first: IdPartials<Dual<f64>>,
    fd_first: FdPartials<Dual<f64>>,
    q: Vec<Dual<f64>>,
    v: Vec<Dual<f64>>,
    last: Vec<Dual<f64>>,
}

/// The same by dual numbers through the first derivatives: nv runs each along q, v, and a or τ.
pub(crate) fn by_duals<'a>(robot: &'a Robot, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let topology = &robot.model.topology;
    let zeros = |count: usize| vec![Dual::constant(0.0); count];
    let mut duals = Duals {
        model: &robot.model,
        id: IdDerivatives::new(topology),
        fd: FdDerivatives::new(topology),
        id_first: IdPartials::new(topology),
        fd_first: FdPartials::new(topology),
        q: zeros(topology.nq()),
        v: zeros(topology.nv()),
        last: zeros(topology.nv()),
    };
    let inverse = quantity == Quantity::InverseDynamicsSecond;
    written(quantity.size(robot), move |k, out| {
        let (last, weights) = if inverse { (states.a(k), states.tau(k)) } else { (states.tau(k), states.a(k)) };
        duals.run(inverse, [states.q(k), states.v(k), last], weights, out)
    })
}

impl Duals<'_> {
    fn run(&mut self, inverse: bool, [q, v, last]: [&[f64]; 3], weights: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        let n = v.len();
        for along in [Along::Configuration, Along::Velocity, Along::Last] {
            for dof in 0..n {
                still(&mut self.q, q);
                still(&mut self.v, v);
                still(&mut self.last, last);
                match along {
                    Along::Configuration => move_along(&self.model.topology, dof, q, &mut self.q),
                    Along::Velocity => self.v[dof].derivative = 1.0,
                    Along::Last => self.last[dof].derivative = 1.0,
                }
                let Self { model, id, fd, id_first, fd_first, q, v, last } = self;
                if inverse {
                    id.run(model, q, v, last, None, id_first)?;
                } else {
                    fd.run(model, q, v, last, None, fd_first)?;
                }
                let slope = |by_v: bool, i: usize, j: usize| match (inverse, by_v) {
                    (true, false) => id_first.q.get(i, j).derivative,
                    (true, true) => id_first.v.get(i, j).derivative,
                    (false, false) => fd_first.q[i * n + j].derivative,
                    (false, true) => fd_first.v[i * n + j].derivative,
                };
                let mut write = |block: usize, by_v: bool| {
                    for j in 0..n {
                        out[(block * n + j) * n + dof] = weights.iter().enumerate().map(|(i, weight)| weight * slope(by_v, i, j)).sum();
                    }
                };
                match along {
                    Along::Configuration => write(0, false),
                    Along::Velocity => {
                        write(1, false);
                        write(2, true);
                    }
                    Along::Last => write(3, false),
                }
            }
        }
        Ok(())
    }
}
