//! Derivatives of the dynamics by dual numbers through the kernels, one dof at a time, over any scalar.
//!
//! Our engine answers by it in `f64`, as the method `dual`. The truth is the same text in double-double.
//!
//! The derivative by dof k of q is on the tangent space of the configurations: q moves as the velocity `v = e_k` moves it, and the numbers
//! in v, a and τ stay. Quaternion joints have the dofs of their velocity, in body axes.
//!
//! Cost per derivative: nv runs of the kernel on duals, O(n²). The Coriolis matrix takes nv mass matrices and O(n³) sums. A run does not
//! allocate.

use crate::{Quantity, layout};
use featherbench_dynamics::{Aba, Crba, Error, Rnea, TreeSparse};
use featherbench_model::{JointKind, Label, Model, Topology};
use featherbench_spatial::{Dual, Quaternion, Real, RigidBodyInertia, Sym3, Vec3};

/// One state: configuration, velocity, acceleration and joint force.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a, T> {
    /// Configuration, of length nq.
    pub q: &'a [T],
    /// Velocity, of length nv.
    pub v: &'a [T],
    /// Acceleration, of length nv.
    pub a: &'a [T],
    /// Joint force, of length nv.
    pub tau: &'a [T],
}

/// The workspace of derivatives by dual numbers.
#[derive(Clone, Debug)]
pub struct ByDuals<T> {
    model: Model<Dual<T>>,
    /// The same without armature, which no Coriolis force has.
    bare: Model<Dual<T>>,
    rnea: Rnea<Dual<T>>,
    aba: Aba<Dual<T>>,
    crba: Crba<Dual<T>>,
    mass: TreeSparse<Dual<T>>,
    q: Vec<Dual<T>>,
    v: Vec<Dual<T>>,
    last: Vec<Dual<T>>,
    answer: Vec<Dual<T>>,
    /// The derivatives of M by each dof, dense, one after the other. Empty until a Coriolis matrix is computed.
    slopes: Vec<T>,
}

impl<T: Real> ByDuals<T> {
    /// A workspace for a model. Its parameters are constants.
    pub fn new(model: Model<Dual<T>>) -> Self {
        let topology = &model.topology;
        let (nq, nv) = (topology.nq(), topology.nv());
        let mut bare = model.clone();
        bare.armature.fill(Dual::zero());
        Self {
            rnea: Rnea::new(topology),
            aba: Aba::new(topology),
            crba: Crba::new(topology),
            mass: TreeSparse::new(topology),
            q: vec![Dual::zero(); nq],
            v: vec![Dual::zero(); nv],
            last: vec![Dual::zero(); nv],
            answer: vec![Dual::zero(); nv],
            slopes: Vec::new(),
            bare,
            model,
        }
    }

    /// The model's parameters of ID and FD, to be changed. The Coriolis matrix keeps those that it was made with.
    pub fn model_mut(&mut self) -> &mut Model<Dual<T>> {
        &mut self.model
    }

    /// The derivative that the quantity names, dense, row after row: ∂ID or ∂FD by q or v, or the Coriolis matrix. Returns whether the
    /// quantity is one of these.
    ///
    /// # Errors
    /// [`Error`] when a slice does not fit the model, or a pivot of M is not positive.
    pub fn run(&mut self, quantity: Quantity, at: Point<T>, out: &mut [T]) -> Result<bool, Error> {
        let inverse = matches!(quantity, Quantity::InverseDynamicsDq | Quantity::InverseDynamicsDv);
        let by_q = matches!(quantity, Quantity::InverseDynamicsDq | Quantity::ForwardDynamicsDq);
        if quantity == Quantity::CoriolisMatrix {
            self.coriolis(at, out)?;
            return Ok(true);
        }
        if !inverse && !matches!(quantity, Quantity::ForwardDynamicsDq | Quantity::ForwardDynamicsDv) {
            return Ok(false);
        }
        still(&mut self.q, at.q);
        still(&mut self.v, at.v);
        still(&mut self.last, if inverse { at.a } else { at.tau });
        let nv = self.v.len();
        for dof in 0..nv {
            if by_q {
                self.move_along(dof, at.q);
            } else {
                self.v[dof].derivative = T::one();
            }
            let Self { model, rnea, aba, q, v, last, answer, .. } = self;
            if inverse {
                rnea.run(model, q, v, last, None, answer)?;
            } else {
                aba.run(model, q, v, last, None, answer)?;
            }
            self.answer.iter().enumerate().for_each(|(row, x)| out[row * nv + dof] = x.derivative);
            if by_q {
                still(&mut self.q, at.q);
            } else {
                self.v[dof].derivative = T::zero();
            }
        }
        Ok(true)
    }

    /// Gives q the rate of the velocity `e_dof`.
    fn move_along(&mut self, dof: usize, q: &[T]) {
        move_along(&self.model.topology, dof, q, &mut self.q);
    }

    /// C by Koszul's formula for the velocities v, of which [E_k, E_j] = Σ c^l_kj E_l:
    /// `C_ij = ½ Σ_k v_k (∂_k M_ij + ∂_j M_ik − ∂_i M_kj + Σ_l (c^l_kj M_li − c^l_ki M_lj − c^l_ji M_lk))`.
    ///
    /// It is the one with Ṁ = C + Cᵀ and without torsion; for coordinates (c = 0) it is that of Christoffel's symbols.
    fn coriolis(&mut self, at: Point<T>, out: &mut [T]) -> Result<(), Error> {
        let nv = self.v.len();
        self.slopes.resize(nv * nv * nv, T::zero());
        still(&mut self.q, at.q);
        for dof in 0..nv {
            self.move_along(dof, at.q);
            self.crba.run(&self.bare, &self.q, &mut self.mass)?;
            let of_dof = &mut self.slopes[dof * nv * nv..(dof + 1) * nv * nv];
            of_dof.iter_mut().enumerate().for_each(|(entry, x)| *x = self.mass.get(entry / nv, entry % nv).derivative);
            still(&mut self.q, at.q);
        }
        let (slopes, mass) = (&self.slopes, &self.mass);
        let slope = |k: usize, i: usize, j: usize| slopes[k * nv * nv + i * nv + j];
        let product = |(l, sign): (usize, f64), i: usize| mass.get(l, i).value * T::from_f64(sign);
        let topology = &self.model.topology;
        for i in 0..nv {
            for j in 0..nv {
                let mut sum = T::zero();
                for (k, &v) in at.v.iter().enumerate() {
                    let mut term = slope(k, i, j) + slope(j, i, k) - slope(i, k, j);
                    for (pair, other, sign) in [((k, j), i, 1.0), ((k, i), j, -1.0), ((j, i), k, -1.0)] {
                        if let Some(bracket) = bracket(topology, pair) {
                            term += product(bracket, other) * T::from_f64(sign);
                        }
                    }
                    sum = v.mul_add(term, sum);
                }
                out[i * nv + j] = sum * T::from_f64(0.5);
            }
        }
        Ok(())
    }
}

/// Gives the configuration `moving`, with the values of `q`, the rate of the velocity `e_dof`.
pub fn move_along<T: Real>(topology: &Topology, dof: usize, q: &[T], moving: &mut [Dual<T>]) {
    let Some(joint) = topology.joints().iter().rev().find(|joint| joint.v <= dof) else { return };
    let (k, at) = (dof - joint.v, joint.q);
    match joint.kind {
        JointKind::Spherical => turn(at, k, q, moving),
        JointKind::Free if k >= 3 => turn(at + 3, k - 3, q, moving),
        JointKind::Free => {
            let rotation = Quaternion::from_array([q[at + 3], q[at + 4], q[at + 5], q[at + 6]]).to_rotation();
            let rate = (rotation * unit(k)).to_array();
            moving[at..at + 3].iter_mut().zip(rate).for_each(|(q, rate)| q.derivative = rate);
        }
        _ => moving[at].derivative = T::one(),
    }
}

/// Gives the quaternion from `at` on the rate of the unit angular velocity about body axis `k`.
fn turn<T: Real>(at: usize, k: usize, q: &[T], moving: &mut [Dual<T>]) {
    let rate = Quaternion::from_array([q[at], q[at + 1], q[at + 2], q[at + 3]]).derivative(unit(k));
    let rates = [rate.v.x, rate.v.y, rate.v.z, rate.w];
    moving[at..at + 4].iter_mut().zip(rates).for_each(|(q, rate)| q.derivative = rate);
}

/// `[E_a, E_b] = ±E_l` of two dofs of one quaternion joint: l and the sign. `None` where the dofs commute.
fn bracket(topology: &Topology, (a, b): (usize, usize)) -> Option<(usize, f64)> {
    let joint = topology.joints().iter().rev().find(|joint| joint.v <= a)?;
    let turns = match joint.kind {
        JointKind::Spherical => joint.v,
        JointKind::Free => joint.v + 3,
        _ => return None,
    };
    if b < joint.v || b >= turns + 3 || (a < turns && b < turns) {
        return None;
    }
    // [ω_a, ω_b] = ε ω_c, [ω_a, v_b] = ε v_c = [v_a, ω_b]: with the index in its triple.
    let index = |dof: usize| if dof < turns { dof - joint.v } else { dof - turns };
    let (one, other) = (index(a), index(b));
    if one == other {
        return None;
    }
    let sign = if (one + 1) % 3 == other { 1.0 } else { -1.0 };
    let first = if a < turns || b < turns { joint.v } else { turns };
    Some((first + 3 - one - other, sign))
}

/// Makes the numbers constants of these values.
pub fn still<T: Real>(numbers: &mut [Dual<T>], values: &[T]) {
    numbers.iter_mut().zip(values).for_each(|(number, &value)| *number = Dual::constant(value));
}

fn unit<T: Real>(k: usize) -> Vec3<T> {
    let one = |of: usize| if of == k { T::one() } else { T::zero() };
    Vec3::new(one(0), one(1), one(2))
}

/// The torque regressor Y with `τ − armature·a = Y π`, one parameter of one body at a time: each column is inverse dynamics of a robot that
/// has this parameter alone.
///
/// The parameters of a body are its mass, first moments x, y, z, and the inertia about its origin xx, xy, xz, yy, yz, zz, in described axes.
/// Y is written as `[nv, bodies, 10]`. Cost: ten runs of inverse dynamics per body. A run does not allocate.
#[derive(Clone, Debug)]
pub struct Columns<T> {
    model: Model<T>,
    rnea: Rnea<T>,
    tau: Vec<T>,
}

impl<T: Real> Columns<T> {
    /// A workspace for a model.
    pub fn new(mut model: Model<T>) -> Self {
        model.armature.fill(T::zero());
        model.inertias.fill(RigidBodyInertia::zero());
        Self { rnea: Rnea::new(&model.topology), tau: vec![T::zero(); model.topology.nv()], model }
    }

    /// The regressor at a state.
    ///
    /// # Errors
    /// [`Error`] when a slice does not fit the model.
    pub fn run(&mut self, at: Point<T>, out: &mut [T]) -> Result<(), Error> {
        let Self { model, rnea, tau } = self;
        let bodies = model.described.len();
        for (index, body) in (0..bodies).map(|index| (index, model.described[index])) {
            for parameter in 0..layout::PARAMETERS {
                model.inertias[body] = unit_inertia(model.labels[body], parameter);
                rnea.run(model, at.q, at.v, at.a, None, tau)?;
                tau.iter().enumerate().for_each(|(row, &x)| out[(row * bodies + index) * layout::PARAMETERS + parameter] = x);
            }
            model.inertias[body] = RigidBodyInertia::zero();
        }
        Ok(())
    }
}

/// One parameter of a body is one, in described axes; the result is in compiled axes.
fn unit_inertia<T: Real>(label: Label, parameter: usize) -> RigidBodyInertia<T> {
    let mut inertia = RigidBodyInertia::zero();
    match parameter {
        0 => inertia.mass = T::one(),
        1..=3 => inertia.first_moment = label.to_compiled(unit(parameter - 1)),
        _ => {
            let mut entries = [T::zero(); 6];
            entries[parameter - 4] = T::one();
            let half = label.rotation_to_compiled(Sym3::from_array(entries).to_mat3()).transpose();
            inertia.rotational = Sym3::from_upper(label.rotation_to_compiled(half));
        }
    }
    inertia
}
