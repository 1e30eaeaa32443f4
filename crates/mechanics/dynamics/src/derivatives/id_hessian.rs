//! Second derivatives of inverse dynamics, weighted: those of `μ·ID(q, v, a)` by (q,q), (v,v), (q,v) and (q,a), for constant weights μ.
//!
//! Sources: S. Singh, R. Russell & P. Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra* (2022):
//! what a rigid motion of a sub-tree leaves. The same authors, *On second-order derivatives of rigid-body dynamics: theory and implementation*
//! (2023): the weights. The tensor is never formed. Weights enter as a velocity field `u = Σ μ_m S_m`, with
//! u_p at the parent, and as sums over sub-trees. With the words of `id.rs`, and for a dof k that supports dof i:
//!
//! ```text
//! U_k = u_p × S_k      f'_i = Iᶜ_i u_p + 𝔽_i      R_i = S_i ×* f'_i + Iᶜ_i U_i
//! 𝔽_i = Σ μ_m F_m      𝔤_i = Σ μ_m 2 Bᶜ_mᵀ S_m      𝔑_i w = Σ μ_m 2 B[Iᶜ_m; w]ᵀ S_m      over the dofs m that i supports, its joint's included
//! C_i = 2 (δB_i)ᵀ u_p + s_i × 𝔤_i      δB_i = S_i ×* Bᶜ_i − Bᶜ_i S_i × + B[Iᶜ_i; Ψ̇_i]
//! E_i = 2 B[Iᶜ_i; S_i]ᵀ u_p + 𝔑_i S_i
//! Z_i = 2 Bᶜ_i Ψ̇_i + Iᶜ_i Ψ̈_i + S_i ×* fᶜ_i      W_i = 2 Bᶜ_i S_i + Iᶜ_i (Ψ̇_i + Φ̇_i)
//!
//! (q_i, q_k)  Ψ̇_k · (C_i + 𝔑_iᵀ ψ̇_i + 2 Ψ̇_i ×* 𝔽_i) + Ψ̈_k · R_i + U_k · Z_i
//! (v_i, v_k)  s_k · E_i                                       within a joint − (S_k × S_i) · f'_i in addition
//! (q_i, v_k)  s_k · (C_i + 𝔑_i Ψ̇_i) + (Ψ̇_k + Φ̇_k) · R_i       not within a joint
//! (q_k, v_i)  ψ̇_k · E_i + U_k · W_i                           within a joint for every pair
//! (q_i, a_k)  S_k · R_i                                       not within a joint
//! (q_k, a_i)  U_k · Iᶜ_i S_i                                  within a joint for every pair
//! ```
//!
//! s and ψ̇ are the angular parts of S and Ψ̇. B[I; w] is the Coriolis operator of inertia I at velocity w; its transpose has an angular part only.
//!
//! Frames, tangent space and external wrenches: as in `id.rs`. Shapes: q has `nq` numbers; v, a and μ have `nv`. Each result is
//! `nv`×`nv`, tree-sparse. Units: SI. Cost: O(n + Σ d_k); 51 multiply-adds per stored pair of dofs. A call does not allocate.

use super::columns::{Columns, PaddedRow, deepest};
use super::sweep::{Link, Sweep, coriolis_moment};
use crate::error::expect;
use crate::step::by_kind;
use crate::{DimensionError, State, TreePair, TreeSparse};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Force, Lift, Mat3, Motion, Real, RigidBodyInertia, Vec3};

/// Second derivatives of weighted inverse dynamics, `μ·ID(q, v, a)`. Those by (v,a) and (a,a) are zero.
#[derive(Clone, Debug, PartialEq)]
pub struct IdSecondPartials<T> {
    /// By q twice: entry (j, k) is the derivative along dof k of that along dof j. It is symmetric, but for pairs within a quaternion joint:
    /// rotations do not commute, and the entries (j, k) and (k, j) differ by the derivative along the rotation `e_j × e_k`.
    pub qq: TreePair<T>,
    /// By v twice; symmetric.
    pub vv: TreeSparse<T>,
    /// By q_j and v_k, in entry (j, k).
    pub qv: TreePair<T>,
    /// By q_j and a_k, in entry (j, k): `∂(M μ)_k/∂q_j`.
    pub qa: TreePair<T>,
}

impl<T: Real> IdSecondPartials<T> {
    /// Zero derivatives for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let pair = || TreePair::new(topology);
        Self { qq: pair(), vv: TreeSparse::new(topology), qv: pair(), qa: pair() }
    }
}

/// The workspace of weighted second derivatives of inverse dynamics.
///
/// ```
/// use featherbench_dynamics::{IdHessian, IdSecondPartials, State, id_derivatives};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("chain:n=5,layout=spatial")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v, a, weights) = (states.q(0), states.v(0), states.a(0), states.tau(0));
/// let mut second = IdSecondPartials::new(&model.topology);
/// IdHessian::new(&model.topology).run(&model, State { q, v, given: a, wrenches: None }, weights, &mut second)?;
///
/// // What a step of 1e-6 in v₂ does to the weighted derivatives by q.
/// let moved = |step: f64| {
///     let (mut v, mut sum) = (v.to_vec(), [0.0; 5]);
///     v[2] += step;
///     id_derivatives(&model, q, &v, a)?.q.mul_transposed(weights, &mut sum).map(|()| sum)
/// };
/// let (ahead, behind) = (moved(1e-6)?, moved(-1e-6)?);
/// assert!((0..5).all(|j| (second.qv.get(j, 2) - (ahead[j] - behind[j]) / 2e-6).abs() < 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct IdHessian<T> {
    sweep: Sweep<T>,
    /// Per body: u_p, and sums over the sub-tree.
    weighted: Vec<Weighted<T>>,
    path: Path<T>,
}

/// What the weights make of a body.
#[derive(Clone, Copy, Debug)]
struct Weighted<T> {
    /// The velocity field at the parent and at the body.
    parent_u: Motion<T>,
    u: Motion<T>,
    /// 𝔽 and 𝔤.
    force: Force<T>,
    coriolis: Vec3<T>,
    /// 𝔑 w = `turn` w_ang + 2 w_lin × 𝔽_lin.
    turn: Mat3<T>,
}

impl<T: Real> Weighted<T> {
    fn zero() -> Self {
        Self { parent_u: Motion::zero(), u: Motion::zero(), force: Force::zero(), coriolis: Vec3::zero(), turn: Mat3::zero() }
    }

    /// `𝔑 w`.
    #[inline(always)]
    fn bilinear(&self, w: Motion<T>) -> Vec3<T> {
        (w.lin * T::from_f64(2.0)).cross_add(self.force.lin, self.turn * w.ang)
    }

    /// `𝔑ᵀ x`.
    #[inline(always)]
    fn bilinear_transposed(&self, x: Vec3<T>) -> Force<T> {
        Force::new(self.turn.transpose_mul(x), (self.force.lin * T::from_f64(2.0)).cross(x))
    }
}

/// Columns of the dofs on the path to the root.
#[derive(Clone, Debug)]
struct Path<T> {
    /// S.
    s: Columns<T>,
    /// Ψ̇.
    psi: Columns<T>,
    /// Ψ̇ + Φ̇.
    v: Columns<T>,
    /// Ψ̈.
    a: Columns<T>,
    /// U.
    u: Columns<T>,
}

/// What the rows of a dof are made of.
#[derive(Clone, Copy, Debug)]
struct Dof<T> {
    s: Motion<T>,
    psi: Motion<T>,
    psi_dot: Motion<T>,
    u: Motion<T>,
    /// The factor of Ψ̇_k in (q_i, q_k).
    p: Force<T>,
    r: Force<T>,
    z: Force<T>,
    w: Force<T>,
    f: Force<T>,
    e: Vec3<T>,
}

impl<T: Real> IdHessian<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let deepest = deepest(topology);
        let columns = || Columns::new(deepest);
        let path = Path { s: columns(), psi: columns(), v: columns(), a: columns(), u: columns() };
        Self { sweep: Sweep::new(topology), weighted: vec![Weighted::zero(); topology.bodies()], path }
    }

    /// The second derivatives of `μ·ID` at a state with accelerations; `weights` is μ.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `second` does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        state: State<'_, T>,
        weights: &[T],
        second: &mut IdSecondPartials<T>,
    ) -> Result<(), DimensionError> {
        expect("weights", model.topology.nv(), weights.len())?;
        for matrix in [&second.qq, &second.qv, &second.qa] {
            matrix.expect_topology(&model.topology)?;
        }
        second.vv.expect_topology(&model.topology)?;
        self.sweep.run::<P, true, true>(model, state)?;
        let Self { sweep, weighted, path } = self;
        let joints = model.topology.joints();

        // outward: u = u_p + S μ
        for (i, joint) in joints.iter().enumerate() {
            let parent_u = joint.parent.map_or(Motion::zero(), |parent| weighted[parent].u);
            let across = sweep.links[i].in_frame(joint.kind, joint.kind.motion(&model.subspaces[i], &weights[joint.v..]));
            weighted[i] = Weighted { parent_u, u: parent_u + across, ..Weighted::zero() };
        }
        // inward: 𝔽, 𝔤 and 𝔑
        for (i, joint) in joints.iter().enumerate().rev() {
            let link = &sweep.links[i];
            let across = Motion { ang: weighted[i].u.ang - weighted[i].parent_u.ang, lin: weighted[i].u.lin - weighted[i].parent_u.lin };
            add_joint(&mut weighted[i], link, across);
            if let Some(parent) = joint.parent {
                let share = weighted[i];
                let sum = &mut weighted[parent];
                sum.force += share.force;
                sum.coriolis += share.coriolis;
                sum.turn = sum.turn + share.turn;
            }
        }
        for (i, joint) in joints.iter().enumerate() {
            by_kind!(T, joint.kind, rows, model, i, &sweep.links[i], &weighted[i], path, second);
        }
        second.qq.clear_padding();
        second.qv.clear_padding();
        second.qa.clear_padding();
        second.vv.clear_padding();
        Ok(())
    }
}

/// Adds the shares of a joint's dofs to 𝔽, 𝔤 and 𝔑. All are linear in `Σ μ_m S_m` over the joint's dofs, which is `across`.
#[inline(always)]
fn add_joint<T: Real>(sum: &mut Weighted<T>, link: &Link<T>, across: Motion<T>) {
    let two = T::from_f64(2.0);
    let inertia = link.sum.inertia;
    sum.force += inertia.mul(across);
    sum.coriolis += link.sum.coriolis_transposed(across) * two;
    // the angular part of 2 B[I; w]ᵀ S as a matrix of w_ang: 2 (s_lin× h× − Σ s×), and row k of Σ s× is (row k of Σ) × s
    let (h, second) = (inertia.first_moment, second_moment(&inertia));
    let row = |row: Vec3<T>| -row.cross(across.ang);
    let turned = Mat3::from_rows(row(second.x), row(second.y), row(second.z));
    // a× b× = b aᵀ − (a·b)·1
    let dot = across.lin.dot(h);
    let a = across.lin;
    let product = Mat3::from_rows(a * h.x, a * h.y, a * h.z)
        - Mat3::from_array([dot, T::zero(), T::zero(), T::zero(), dot, T::zero(), T::zero(), T::zero(), dot]);
    let added = turned + product;
    sum.turn = sum.turn + Mat3::from_rows(added.x * two, added.y * two, added.z * two);
}

/// The second moment of mass `Σ = ½ tr(Ī)·1 − Ī`.
#[inline(always)]
fn second_moment<T: Real>(inertia: &RigidBodyInertia<T>) -> Mat3<T> {
    let i = inertia.rotational;
    let half = (i.xx + i.yy + i.zz) * T::from_f64(0.5);
    Mat3::from_array([half - i.xx, -i.xy, -i.xz, -i.xy, half - i.yy, -i.yz, -i.xz, -i.yz, half - i.zz])
}

/// The angular part of `2 B[I; w]ᵀ y`; the linear part is zero.
#[inline(always)]
fn twice_coriolis_transposed<T: Real>(inertia: &RigidBodyInertia<T>, w: Motion<T>, y: Motion<T>) -> Vec3<T> {
    let momentum = inertia.mul(w).lin;
    momentum.cross_add(y.lin, coriolis_moment(inertia, w).transpose_mul(y.ang)) * T::from_f64(2.0)
}

/// What the rows of one dof are made of.
#[inline(always)]
fn dof_of<T: Real>(kind: JointKind, link: &Link<T>, weighted: &Weighted<T>, s: Motion<T>) -> (Dof<T>, Motion<T>, Vec3<T>) {
    let two = T::from_f64(2.0);
    let (body, inertia) = (&link.sum, &link.sum.inertia);
    let u_p = weighted.parent_u;
    let psi = link.parent_v.cross_motion(s);
    let sum = if kind.nv() == 1 { psi * two } else { psi + link.v.cross_motion(s) };
    let psi_dot = link.parent_a.cross_motion(s) + link.parent_v.cross_motion(psi);
    let u = u_p.cross_motion(s);
    // R = S ×* f' + Iᶜ U
    let r = s.cross_force(inertia.mul(u_p) + weighted.force) + inertia.mul(u);
    // C = 2 (δB)ᵀ u_p + s × 𝔤, and S × u_p = −U
    let turned = s.ang.cross_add(body.coriolis_transposed(u_p), body.coriolis_transposed(u)) * two;
    let c = turned + twice_coriolis_transposed(inertia, psi, u_p) + s.ang.cross(weighted.coriolis);
    let p = Force::new(c, Vec3::zero()) + weighted.bilinear_transposed(psi.ang) + psi.cross_force(weighted.force) * two;
    let e = twice_coriolis_transposed(inertia, s, u_p) + weighted.bilinear(s);
    let z = body.coriolis(psi.ang) * two + inertia.mul(psi_dot) + s.cross_force(body.force);
    let w = body.coriolis(s.ang) * two + inertia.mul(sum);
    (Dof { s, psi, psi_dot, u, p, r, z, w, f: inertia.mul(s), e }, sum, c + weighted.bilinear(psi))
}

/// The rows of one joint's dofs.
#[inline(always)]
fn rows<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    link: &Link<T>,
    weighted: &Weighted<T>,
    path: &mut Path<T>,
    second: &mut IdSecondPartials<T>,
) {
    let first = model.topology.joints()[i].v;
    let top = model.topology.dof_depth(first) - 1;
    let mut dofs: [Option<Dof<T>>; 6] = [None; 6];
    for k in 0..kind.nv() {
        let (dof, sum, q) = dof_of(kind, link, weighted, link.in_frame(kind, kind.column(&model.subspaces[i], k)));
        let position = top + k;
        path.s.set(position, dof.s);
        path.psi.set(position, dof.psi);
        path.v.set(position, sum);
        path.a.set(position, dof.psi_dot);
        path.u.set(position, dof.u);
        dofs[k] = Some(dof);

        let IdSecondPartials { qq, vv, qv, qa } = second;
        let row = PaddedRow::of(vv, first + k);
        path.s.ang.dot(dof.e, row.of_matrix(vv));
        let (lower, upper) = qq.triangles_mut();
        path.psi.dot(dof.p, row.of_matrix(lower));
        path.a.add_dot(dof.r, row.of_matrix(lower));
        path.u.add_dot(dof.z, row.of_matrix(lower));
        row.exact(upper).copy_from_slice(row.exact(lower));
        let (qv_lower, qv_upper) = qv.triangles_mut();
        path.v.dot(dof.r, row.of_matrix(qv_lower));
        path.s.ang.add_dot(q, row.of_matrix(qv_lower));
        path.u.dot(dof.w, row.of_matrix(qv_upper));
        path.psi.ang.add_dot(dof.e, row.of_matrix(qv_upper));
        let (qa_lower, qa_upper) = qa.triangles_mut();
        path.s.dot(dof.r, row.of_matrix(qa_lower));
        path.u.dot(dof.f, row.of_matrix(qa_upper));

        // within the joint
        let [vv, upper, qv_lower, qa_lower] = [vv, upper, qv_lower, qa_lower].map(|matrix| &mut row.exact(matrix)[top..]);
        let carried = link.sum.inertia.mul(weighted.parent_u) + weighted.force;
        for (l, other) in dofs.iter().enumerate().filter_map(|(l, other)| Some((l, other.as_ref()?))) {
            if l < k {
                vv[l] -= other.s.cross_motion(dof.s).dot(carried);
                upper[l] = dof.psi.dot(other.p) + dof.psi_dot.dot(other.r) + dof.u.dot(other.z);
            }
            qv_lower[l] = dof.psi.ang.dot(other.e) + dof.u.dot(other.w);
            qa_lower[l] = dof.u.dot(other.f);
        }
    }
}

/// The second derivatives of `μ·ID` in a workspace of the call, without external wrenches; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn id_hessian<T: Real, P: Real + Lift<T>>(
    model: &Model<P>,
    q: &[T],
    v: &[T],
    a: &[T],
    weights: &[T],
) -> Result<IdSecondPartials<T>, DimensionError> {
    let mut second = IdSecondPartials::new(&model.topology);
    IdHessian::new(&model.topology).run(model, State { q, v, given: a, wrenches: None }, weights, &mut second)?;
    Ok(second)
}
