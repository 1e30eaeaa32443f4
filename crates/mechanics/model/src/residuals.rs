//! The residuals of a description: what the true robot needs beyond the rigid bodies. Friction, compliance, drives that answer late, payload.
//!
//! They are data. A [`Model`](crate::Model) is that of the rigid bodies alone; `featherbench_residuals` computes with them. A residual acts on the
//! joints of the bodies that it names, by index in the description; its lists have the numbers of these joints, one joint after the other.

use crate::{Description, JointType};
use std::collections::HashSet;
use thiserror::Error;

/// A residual of a description.
#[derive(Clone, Debug, PartialEq)]
pub struct DescribedResidual {
    /// Its name, unique among the residuals.
    pub name: String,
    /// The bodies on whose joints it acts; of a payload, the one body that carries it.
    pub bodies: Vec<usize>,
    /// Its law, with the numbers.
    pub law: ResidualLaw,
}

/// The law of a residual, r(q, v, a). n is the number of dofs of its joints, p that of their numbers of q. Units: SI.
#[derive(Clone, Debug, PartialEq)]
pub enum ResidualLaw {
    /// B v.
    Viscous {
        /// B, n numbers.
        coefficient: Vec<f64>,
    },
    /// F tanh(v / w).
    Coulomb {
        /// F, n numbers.
        force: Vec<f64>,
        /// w, n numbers.
        width: Vec<f64>,
    },
    /// F Sgn(v), an interval at rest.
    Dry {
        /// F, n numbers.
        force: Vec<f64>,
    },
    /// (F + (S − F) exp(−(v / u)²)) tanh(v / w) + B v.
    Stribeck {
        /// F, n numbers.
        coulomb: Vec<f64>,
        /// S ≥ F, n numbers.
        stiction: Vec<f64>,
        /// u, n numbers.
        speed: Vec<f64>,
        /// B, n numbers.
        viscous: Vec<f64>,
        /// w, n numbers.
        width: Vec<f64>,
    },
    /// K (q ⊖ q₀) + D v: the compliance of a joint or link.
    Spring {
        /// K, n numbers.
        stiffness: Vec<f64>,
        /// D, n numbers.
        damping: Vec<f64>,
        /// q₀, p numbers.
        rest: Vec<f64>,
    },
    /// A motor that turns the joint through a gear that gives: s = K (θ − q) + D (θ̇ − v), B θ̈ = u − s.
    SeriesElastic {
        /// K, n numbers.
        stiffness: Vec<f64>,
        /// D, n numbers.
        damping: Vec<f64>,
        /// B, seen from the link, n numbers.
        motor: Vec<f64>,
    },
    /// A drive with T ż = u − z, which puts out z.
    Lag {
        /// T, n numbers.
        time: Vec<f64>,
    },
    /// A drive that puts out what was commanded some control periods ago.
    Delay {
        /// How many.
        periods: usize,
    },
    /// A mass that a body carries.
    Payload {
        /// Its mass.
        mass: f64,
        /// Its centre of mass in the body's frame.
        com: [f64; 3],
        /// Its inertia about that, in body axes: xx, xy, xz, yy, yz, zz.
        inertia: [f64; 6],
    },
    /// K q + D v + A a + c. An empty list is zero.
    Linear {
        /// K, n × p numbers, row by row.
        position: Vec<f64>,
        /// D, n × n numbers, row by row.
        velocity: Vec<f64>,
        /// A, n × n numbers, row by row.
        acceleration: Vec<f64>,
        /// c, n numbers.
        constant: Vec<f64>,
    },
}

/// A list of numbers of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualNumbers<'a> {
    /// Its key in a description file.
    pub field: &'static str,
    /// The numbers.
    pub values: &'a [f64],
    /// Whether the list may be empty.
    pub optional: bool,
    length: Length,
    sign: Sign,
}

/// How many numbers a list has.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Length {
    Dofs,
    Coordinates,
    DofsByCoordinates,
    DofsByDofs,
    Fixed(usize),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    Any,
    NotNegative,
    Positive,
}

/// What is wrong with a residual of a description.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ResidualDefect {
    /// Another residual has the same name.
    #[error("another residual has the same name; names must be unique")]
    DuplicateName,
    /// It acts on nothing.
    #[error("bodies: the residual acts on no joint; name one body at least")]
    NoTarget,
    /// A body that does not exist.
    #[error("bodies: body {body} does not exist (there are {count} bodies, counted from 0)")]
    NoBody {
        /// The body.
        body: usize,
        /// How many there are.
        count: usize,
    },
    /// A body is named twice.
    #[error("bodies: body {body} is named twice; name it once")]
    Repeated {
        /// The body.
        body: usize,
    },
    /// A joint that does not move.
    #[error("bodies: body {body} is fixed to its parent, and its joint has no dof to act on; name a moving body")]
    FixedBody {
        /// The body.
        body: usize,
    },
    /// A payload of several bodies.
    #[error("bodies: a payload is carried by one body, and {found} are named; give each a payload of its own")]
    OneCarrier {
        /// How many are named.
        found: usize,
    },
    /// A payload that does not move.
    #[error("bodies: body {body} does not move, so its payload changes no joint force; name a moving body")]
    StillCarrier {
        /// The body.
        body: usize,
    },
    /// A list of another length.
    #[error("law.{field} has {found} numbers; {due} are due for the {dofs} dofs of its joints")]
    WrongLength {
        /// The key of the list.
        field: &'static str,
        /// How many numbers it has.
        found: usize,
        /// How many are due.
        due: usize,
        /// How many dofs the joints have.
        dofs: usize,
    },
    /// A number is NaN or infinite.
    #[error("law.{field}[{index}] is {value}; write a finite number")]
    NotFinite {
        /// The key of the list.
        field: &'static str,
        /// The place of the number, counted from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A number of the wrong sign.
    #[error("law.{field}[{index}] is {value}; it must {demand}")]
    Sign {
        /// The key of the list.
        field: &'static str,
        /// The place of the number, counted from 0.
        index: usize,
        /// The number.
        value: f64,
        /// What it must do.
        demand: &'static str,
    },
    /// The static friction is below the Coulomb friction.
    #[error("law.stiction[{index}] is {stiction}, below law.coulomb[{index}], {coulomb}; static friction is at least that of a fast joint")]
    Stiction {
        /// The place of both numbers, counted from 0.
        index: usize,
        /// The static friction.
        stiction: f64,
        /// The Coulomb friction.
        coulomb: f64,
    },
    /// A motor's angle beside a quaternion.
    #[error(
        "bodies: the {kind} joint of body {body} has {nq} numbers of q for {nv} dofs, and a motor's angle has no place beside them; use 'spring'"
    )]
    NotAVectorSpace {
        /// The body.
        body: usize,
        /// The joint's kind.
        kind: &'static str,
        /// Numbers of q.
        nq: usize,
        /// Dofs.
        nv: usize,
    },
    /// The inertia of a motor is there twice.
    #[error("bodies: the joint of body {body} has armature, and law.motor holds the motor's inertia already; remove the armature")]
    Armature {
        /// The body.
        body: usize,
    },
    /// Two drives of one joint.
    #[error("bodies: the joint of body {body} has another drive ('lag', 'delay' or 'series_elastic') already; one joint has one drive")]
    SecondDrive {
        /// The body.
        body: usize,
    },
}

impl ResidualLaw {
    /// The word for it in a description file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Viscous { .. } => "viscous",
            Self::Coulomb { .. } => "coulomb",
            Self::Dry { .. } => "dry",
            Self::Stribeck { .. } => "stribeck",
            Self::Spring { .. } => "spring",
            Self::SeriesElastic { .. } => "series_elastic",
            Self::Lag { .. } => "lag",
            Self::Delay { .. } => "delay",
            Self::Payload { .. } => "payload",
            Self::Linear { .. } => "linear",
        }
    }

    /// Its lists of numbers, in the order of a file. The periods of a delay are none: they are a count.
    pub fn numbers(&self) -> Vec<ResidualNumbers<'_>> {
        use Length::{Coordinates, Dofs, DofsByCoordinates, DofsByDofs, Fixed};
        use Sign::{Any, NotNegative, Positive};
        fn list<'a>(field: &'static str, values: &'a [f64], length: Length, sign: Sign) -> ResidualNumbers<'a> {
            ResidualNumbers { field, values, optional: false, length, sign }
        }
        match self {
            Self::Viscous { coefficient } => vec![list("coefficient", coefficient, Dofs, NotNegative)],
            Self::Coulomb { force, width } => vec![list("force", force, Dofs, NotNegative), list("width", width, Dofs, Positive)],
            Self::Dry { force } => vec![list("force", force, Dofs, NotNegative)],
            Self::Stribeck { coulomb, stiction, speed, viscous, width } => vec![
                list("coulomb", coulomb, Dofs, NotNegative),
                list("stiction", stiction, Dofs, NotNegative),
                list("speed", speed, Dofs, Positive),
                list("viscous", viscous, Dofs, NotNegative),
                list("width", width, Dofs, Positive),
            ],
            Self::Spring { stiffness, damping, rest } => vec![
                list("stiffness", stiffness, Dofs, NotNegative),
                list("damping", damping, Dofs, NotNegative),
                list("rest", rest, Coordinates, Any),
            ],
            Self::SeriesElastic { stiffness, damping, motor } => vec![
                list("stiffness", stiffness, Dofs, Positive),
                list("damping", damping, Dofs, NotNegative),
                list("motor", motor, Dofs, Positive),
            ],
            Self::Lag { time } => vec![list("time", time, Dofs, Positive)],
            Self::Delay { .. } => Vec::new(),
            Self::Payload { mass, com, inertia } => vec![
                list("mass", std::slice::from_ref(mass), Fixed(1), NotNegative),
                list("com", com, Fixed(3), Any),
                list("inertia", inertia, Fixed(6), Any),
            ],
            Self::Linear { position, velocity, acceleration, constant } => {
                let lists = [
                    list("position", position, DofsByCoordinates, Any),
                    list("velocity", velocity, DofsByDofs, Any),
                    list("acceleration", acceleration, DofsByDofs, Any),
                    list("constant", constant, Dofs, Any),
                ];
                lists.map(|list| ResidualNumbers { optional: true, ..list }).into()
            }
        }
    }

    /// Whether it stands between the command and the joint force.
    fn is_drive(&self) -> bool {
        matches!(self, Self::SeriesElastic { .. } | Self::Lag { .. } | Self::Delay { .. })
    }
}

impl ResidualNumbers<'_> {
    fn check(&self, dofs: usize, coordinates: usize) -> Result<(), ResidualDefect> {
        let (field, found) = (self.field, self.values.len());
        let due = match self.length {
            Length::Dofs => dofs,
            Length::Coordinates => coordinates,
            Length::DofsByCoordinates => dofs * coordinates,
            Length::DofsByDofs => dofs * dofs,
            Length::Fixed(count) => count,
        };
        if found != due && !(self.optional && found == 0) {
            return Err(ResidualDefect::WrongLength { field, found, due, dofs });
        }
        for (index, &value) in self.values.iter().enumerate() {
            if !value.is_finite() {
                return Err(ResidualDefect::NotFinite { field, index, value });
            }
            let demand = match self.sign {
                Sign::NotNegative if value < 0.0 => "not be negative",
                Sign::Positive if value <= 0.0 => "be positive",
                _ => continue,
            };
            return Err(ResidualDefect::Sign { field, index, value, demand });
        }
        Ok(())
    }
}

impl Description {
    /// The first malformed residual, by its index.
    pub(crate) fn validate_residuals(&self) -> Result<(), (usize, ResidualDefect)> {
        let (mut names, mut driven) = (HashSet::new(), HashSet::new());
        for (index, residual) in self.residuals.iter().enumerate() {
            if !names.insert(residual.name.as_str()) {
                return Err((index, ResidualDefect::DuplicateName));
            }
            self.check_residual(residual).map_err(|defect| (index, defect))?;
            if let Some(&body) = residual.bodies.iter().find(|&&body| residual.law.is_drive() && !driven.insert(body)) {
                return Err((index, ResidualDefect::SecondDrive { body }));
            }
        }
        Ok(())
    }

    fn check_residual(&self, DescribedResidual { bodies, law, .. }: &DescribedResidual) -> Result<(), ResidualDefect> {
        let count = self.bodies.len();
        let mut named = HashSet::new();
        let (mut dofs, mut coordinates) = (0, 0);
        for &body in bodies {
            let joint = &self.bodies.get(body).ok_or(ResidualDefect::NoBody { body, count })?.joint;
            if !named.insert(body) {
                return Err(ResidualDefect::Repeated { body });
            }
            let (kind, nq, nv) = (joint.kind.name(), joint.kind.nq(), joint.kind.nv());
            match law {
                ResidualLaw::Payload { .. } if !self.moves(body) => return Err(ResidualDefect::StillCarrier { body }),
                ResidualLaw::Payload { .. } => {}
                _ if nv == 0 => return Err(ResidualDefect::FixedBody { body }),
                ResidualLaw::SeriesElastic { .. } if nq != nv => return Err(ResidualDefect::NotAVectorSpace { body, kind, nq, nv }),
                ResidualLaw::SeriesElastic { .. } if joint.armature.iter().any(|&armature| armature != 0.0) => {
                    return Err(ResidualDefect::Armature { body });
                }
                _ => {}
            }
            (dofs, coordinates) = (dofs + nv, coordinates + nq);
        }
        match (law, bodies.len()) {
            (_, 0) => return Err(ResidualDefect::NoTarget),
            (ResidualLaw::Payload { .. }, found @ 2..) => return Err(ResidualDefect::OneCarrier { found }),
            _ => {}
        }
        law.numbers().iter().try_for_each(|list| list.check(dofs, coordinates))?;
        if let ResidualLaw::Stribeck { coulomb, stiction, .. } = law {
            for (index, (&coulomb, &stiction)) in coulomb.iter().zip(stiction).enumerate() {
                if stiction < coulomb {
                    return Err(ResidualDefect::Stiction { index, stiction, coulomb });
                }
            }
        }
        Ok(())
    }

    /// Whether a joint on the way from the world moves. The description has no cycle.
    fn moves(&self, body: usize) -> bool {
        let mut at = Some(body);
        while let Some(body) = at {
            if self.bodies[body].joint.kind != JointType::Fixed {
                return true;
            }
            at = self.bodies[body].parent;
        }
        false
    }
}
