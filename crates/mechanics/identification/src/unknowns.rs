//! What is identified: the parameters that enter the torques linearly, and their names.

use featherbench_dynamics::PARAMETERS;
use featherbench_model::{Description, JointType};

/// What is identified beside the inertial parameters. Each gives one unknown per dof whose position is a plain number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Terms {
    /// Reflected rotor inertia: `τ ∋ I_a v̇`.
    pub armature: bool,
    /// Viscous friction: `τ ∋ f_v v`.
    pub viscous: bool,
    /// Coulomb friction: `τ ∋ f_c sign v`, with sign 0 = 0.
    pub coulomb: bool,
    /// A constant offset of the torque: `τ ∋ f_0`.
    pub offset: bool,
}

impl Terms {
    /// The inertial parameters alone.
    pub const NONE: Self = Self { armature: false, viscous: false, coulomb: false, offset: false };
    /// Armature, friction and offset.
    pub const ALL: Self = Self { armature: true, viscous: true, coulomb: true, offset: true };
}

/// The kind of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// One of the ten inertial parameters of a body, in the order of [`inertial_parameters`](featherbench_dynamics::inertial_parameters).
    Inertial(usize),
    /// Reflected rotor inertia, kg·m² or kg.
    Armature,
    /// Viscous friction, N·m·s/rad or N·s/m.
    Viscous,
    /// Coulomb friction, N·m or N.
    Coulomb,
    /// Offset, N·m or N.
    Offset,
}

/// An unknown: its kind, and the body or dof that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// What it is.
    pub kind: Kind,
    /// The body of an inertial parameter, in canonical order; else the dof.
    pub of: usize,
}

/// The short names of the ten inertial parameters.
const INERTIAL: [&str; PARAMETERS] = ["m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"];

impl Unknown {
    /// A short name: `m2` is the mass of the second body, `Ia3` the armature of the third dof.
    pub fn name(self) -> String {
        let word = match self.kind {
            Kind::Inertial(which) => INERTIAL[which % PARAMETERS],
            Kind::Armature => "Ia",
            Kind::Viscous => "fv",
            Kind::Coulomb => "fc",
            Kind::Offset => "f0",
        };
        format!("{word}{}", self.of + 1)
    }

    /// Its unit, of a revolute joint.
    pub fn unit(self) -> &'static str {
        match self.kind {
            Kind::Inertial(0) => "kg",
            Kind::Inertial(1..=3) => "kg·m",
            Kind::Inertial(_) | Kind::Armature => "kg·m²",
            Kind::Viscous => "N·m·s/rad",
            Kind::Coulomb | Kind::Offset => "N·m",
        }
    }
}

/// A degree of freedom as a log names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Dof {
    /// The joint's name, or that of its body if it has none; with `.k` behind it where the joint has several dofs.
    pub name: String,
    /// Its body in canonical order.
    pub body: usize,
    /// Which dof of the joint it is.
    pub within: usize,
    /// Where its position is in q, if that is a plain number whose rate is v.
    pub position: Option<usize>,
    /// Its joint is free: no motor acts on it.
    pub free: bool,
    /// Largest torque, N·m or N; infinite where there is no limit.
    pub effort: f64,
    /// Largest speed; infinite where there is no limit.
    pub speed: f64,
}

/// The name of a joint in a log.
fn joint_name(description: &Description, body: usize) -> &str {
    let body = &description.bodies[body];
    if body.joint.name.is_empty() { &body.name } else { &body.joint.name }
}

/// A name with the place behind it where there are several.
fn numbered(name: &str, count: usize, k: usize) -> String {
    if count == 1 { name.to_owned() } else { format!("{name}.{k}") }
}

/// The dofs of a canonical description.
pub(crate) fn dofs(description: &Description) -> Vec<Dof> {
    let mut dofs = Vec::with_capacity(description.nv());
    let mut q = 0;
    for (body, described) in description.bodies.iter().enumerate() {
        let joint = &described.joint;
        let (nq, nv) = (joint.kind.nq(), joint.kind.nv());
        for k in 0..nv {
            let limit = |limits: &[f64]| limits.get(k).copied().unwrap_or(f64::INFINITY);
            dofs.push(Dof {
                name: numbered(joint_name(description, body), nv, k),
                body,
                within: k,
                position: (nq == nv).then_some(q + k),
                free: joint.kind == JointType::Free,
                effort: limit(&joint.effort),
                speed: limit(&joint.velocity),
            });
        }
        q += nq;
    }
    dofs
}

/// The names of the numbers of q.
pub(crate) fn positions(description: &Description) -> Vec<String> {
    let of = |body: usize| {
        let nq = description.bodies[body].joint.kind.nq();
        (0..nq).map(move |k| numbered(joint_name(description, body), nq, k))
    };
    (0..description.bodies.len()).flat_map(of).collect()
}

/// The unknowns of a robot: ten per body, then armature, viscous, Coulomb and offset, each dof after dof.
pub(crate) fn unknowns(bodies: usize, dofs: &[Dof], terms: Terms) -> Vec<Unknown> {
    let inertial = (0..bodies).flat_map(|of| (0..PARAMETERS).map(move |which| Unknown { kind: Kind::Inertial(which), of }));
    let asked =
        [(terms.armature, Kind::Armature), (terms.viscous, Kind::Viscous), (terms.coulomb, Kind::Coulomb), (terms.offset, Kind::Offset)];
    let kinds = asked.into_iter().filter(|(asked, _)| *asked).map(|(_, kind)| kind);
    let plain = move |kind| dofs.iter().enumerate().filter(|(_, dof)| dof.position.is_some()).map(move |(of, _)| Unknown { kind, of });
    inertial.chain(kinds.flat_map(plain)).collect()
}
