//! What ties bodies of a description beside its tree: joints that close loops, held points and distances, and coordinates that follow
//! others.
//!
//! Loops are data. A [`Model`](crate::Model) is the tree alone; `featherbench_constrained` makes constraints of them. Bodies are named by
//! their index in the description, and coordinates by the body whose joint has them.

use crate::orthonormal::not_a_rotation;
use crate::words::words;
use crate::{Description, Placement};
use std::collections::HashSet;
use thiserror::Error;

/// A constraint on the tree, with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Its name, unique among the loops.
    pub name: String,
    /// What it demands.
    pub kind: LoopKind,
}

/// What a loop demands.
#[derive(Clone, Debug, PartialEq)]
pub enum LoopKind {
    /// The second frame moves on the first as by a joint about or along z.
    Joint {
        /// The frame whose axes count, and the frame that is held.
        ends: [LoopEnd; 2],
        /// What is left free.
        motion: LoopMotion,
    },
    /// The origin of the second frame stays on that of the first, along axes of the first.
    Point {
        /// The frame whose axes count, and the frame that is held.
        ends: [LoopEnd; 2],
        /// The axes x, y and z along which it is held.
        axes: [bool; 3],
    },
    /// The origins of two frames stay at a distance.
    Distance {
        /// The two frames.
        ends: [LoopEnd; 2],
        /// The distance, m.
        length: f64,
    },
    /// `Σ c_k q_k = offset` over coordinates of joints with one degree of freedom.
    Gear {
        /// The body whose joint has the coordinate, and its coefficient.
        terms: Vec<(usize, f64)>,
        /// The sum.
        offset: f64,
    },
    /// `q_follower = p(q_leader)`, both of joints with one degree of freedom.
    Mimic {
        /// The body whose joint follows.
        follower: usize,
        /// The body whose joint leads.
        leader: usize,
        /// The coefficients of p, by rising power: offset, multiplier, and those of the square, cube and fourth power.
        polynomial: [f64; 5],
    },
}

/// A frame that a loop holds.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LoopEnd {
    /// The body it is on, or `None` for the world.
    pub body: Option<usize>,
    /// Its placement on that body.
    pub placement: Placement,
}

words! {
    /// The motion that a joint of a loop leaves free. Its axis is z of both frames.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum LoopMotion {
        /// None (a weld): rows of orientation x, y, z, then of position x, y, z.
        #[default]
        Fixed => "fixed",
        /// Rotation about z: rows that z be parallel (x, y), then of position x, y, z.
        Revolute => "revolute",
        /// Translation along z: rows of orientation x, y, z, then of position x, y.
        Prismatic => "prismatic",
        /// Rotation about z and translation along it: rows that z be parallel (x, y), then of position x, y.
        Cylindrical => "cylindrical",
        /// Rotation about the point: rows of position x, y, z.
        Spherical => "spherical",
        /// Rotation about z and translation along x and y: rows that z be parallel (x, y), then of position z.
        Planar => "planar",
    }
}

impl LoopMotion {
    /// How many rotations are held: three, the two that tilt z, or none.
    pub fn held_rotations(self) -> usize {
        match self {
            Self::Fixed | Self::Prismatic => 3,
            Self::Revolute | Self::Cylindrical | Self::Planar => 2,
            Self::Spherical => 0,
        }
    }

    /// The axes along which the origin is held.
    pub fn held_axes(self) -> [bool; 3] {
        match self {
            Self::Fixed | Self::Revolute | Self::Spherical => [true; 3],
            Self::Prismatic | Self::Cylindrical => [true, true, false],
            Self::Planar => [false, false, true],
        }
    }

    /// Degrees of freedom of the joint.
    pub fn freedom(self) -> usize {
        6 - self.held_rotations() - self.held_axes().into_iter().filter(|held| *held).count()
    }
}

/// What is wrong with a loop.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LoopDefect {
    /// Another loop has the same name.
    #[error("another loop has the same name; names must be unique")]
    DuplicateName,
    /// A number is NaN or infinite.
    #[error("{field} is {value}; write a finite number")]
    NotFinite {
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// A body that does not exist.
    #[error("{field}: body {body} does not exist (there are {count} bodies, counted from 0)")]
    NoBody {
        /// The field that names it.
        field: &'static str,
        /// The index that it names.
        body: usize,
        /// How many bodies there are.
        count: usize,
    },
    /// The rotation of an end is not orthonormal, or it is a reflection.
    #[error("{field}: its rotation misses orthonormality by {error:e}; give a rotation matrix in row-major order")]
    NotARotation {
        /// The end.
        field: &'static str,
        /// Largest entry of |RRᵀ − 1|, or of |det R − 1|.
        error: f64,
    },
    /// Both ends are on one body, in the world, or on bodies that are fixed to each other.
    #[error("both ends are on one body (or on bodies fixed to each other), which cannot move in itself; name two bodies")]
    SameBody,
    /// A point that is held along no axis.
    #[error("axes: the point is held along no axis; name one at least")]
    NoAxis,
    /// A distance that is not positive.
    #[error("length is {length} m; a distance is positive (a length of zero is a point)")]
    Length {
        /// The length.
        length: f64,
    },
    /// A gear of fewer than two coordinates.
    #[error("terms: there are {found}; a gear has two at least")]
    FewTerms {
        /// How many.
        found: usize,
    },
    /// A coefficient of zero.
    #[error("terms: the coefficient of body {body} is zero; leave the term out")]
    ZeroCoefficient {
        /// The body whose joint has the coordinate.
        body: usize,
    },
    /// A coordinate that stands twice.
    #[error("{field}: the joint of body {body} is named twice")]
    Repeated {
        /// The field.
        field: &'static str,
        /// The body.
        body: usize,
    },
    /// A joint that does not have one degree of freedom.
    #[error("{field}: the joint of body {body} is {kind}; name a joint with one degree of freedom")]
    NoCoordinate {
        /// The field.
        field: &'static str,
        /// The body.
        body: usize,
        /// The joint's kind.
        kind: &'static str,
    },
}

impl LoopKind {
    /// The word for it in a description file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Joint { motion, .. } => motion.name(),
            Self::Point { .. } => "point",
            Self::Distance { .. } => "distance",
            Self::Gear { .. } => "gear",
            Self::Mimic { .. } => "mimic",
        }
    }
}

impl Loop {
    /// The two frames, of the kinds that have them.
    pub fn ends(&self) -> Option<&[LoopEnd; 2]> {
        match &self.kind {
            LoopKind::Joint { ends, .. } | LoopKind::Point { ends, .. } | LoopKind::Distance { ends, .. } => Some(ends),
            LoopKind::Gear { .. } | LoopKind::Mimic { .. } => None,
        }
    }

    /// The two frames, to be changed.
    pub(crate) fn ends_mut(&mut self) -> Option<&mut [LoopEnd; 2]> {
        match &mut self.kind {
            LoopKind::Joint { ends, .. } | LoopKind::Point { ends, .. } | LoopKind::Distance { ends, .. } => Some(ends),
            LoopKind::Gear { .. } | LoopKind::Mimic { .. } => None,
        }
    }

    /// The bodies whose joints have the coordinates, to be changed.
    pub(crate) fn joints_mut(&mut self) -> Vec<&mut usize> {
        match &mut self.kind {
            LoopKind::Gear { terms, .. } => terms.iter_mut().map(|(body, _)| body).collect(),
            LoopKind::Mimic { follower, leader, .. } => vec![follower, leader],
            LoopKind::Joint { .. } | LoopKind::Point { .. } | LoopKind::Distance { .. } => Vec::new(),
        }
    }

    fn check(&self, robot: &Description) -> Result<(), LoopDefect> {
        if let Some(ends) = self.ends() {
            for (end, field) in ends.iter().zip(["first", "second"]) {
                end.check(field, robot.bodies.len())?;
            }
            if ends[0].body == ends[1].body {
                return Err(LoopDefect::SameBody);
            }
        }
        match &self.kind {
            LoopKind::Joint { .. } => Ok(()),
            LoopKind::Point { axes, .. } => {
                if axes.contains(&true) {
                    Ok(())
                } else {
                    Err(LoopDefect::NoAxis)
                }
            }
            LoopKind::Distance { length, .. } => {
                finite("length", &[*length])?;
                if *length > 0.0 { Ok(()) } else { Err(LoopDefect::Length { length: *length }) }
            }
            LoopKind::Gear { terms, offset } => {
                finite("offset", &[*offset])?;
                if terms.len() < 2 {
                    return Err(LoopDefect::FewTerms { found: terms.len() });
                }
                for (k, &(body, coefficient)) in terms.iter().enumerate() {
                    finite("coefficient", &[coefficient])?;
                    coordinate("terms", body, robot)?;
                    if coefficient == 0.0 {
                        return Err(LoopDefect::ZeroCoefficient { body });
                    }
                    if terms[..k].iter().any(|(other, _)| *other == body) {
                        return Err(LoopDefect::Repeated { field: "terms", body });
                    }
                }
                Ok(())
            }
            LoopKind::Mimic { follower, leader, polynomial } => {
                finite("polynomial", polynomial)?;
                coordinate("follower", *follower, robot)?;
                coordinate("leader", *leader, robot)?;
                if follower == leader { Err(LoopDefect::Repeated { field: "leader", body: *leader }) } else { Ok(()) }
            }
        }
    }
}

impl LoopEnd {
    fn check(&self, field: &'static str, count: usize) -> Result<(), LoopDefect> {
        if let Some(body) = self.body.filter(|body| *body >= count) {
            return Err(LoopDefect::NoBody { field, body, count });
        }
        finite("placement.rotation", &self.placement.rotation)?;
        finite("placement.translation", &self.placement.translation)?;
        not_a_rotation(&self.placement.rotation).map_or(Ok(()), |error| Err(LoopDefect::NotARotation { field, error }))
    }
}

impl Description {
    /// The first malformed loop, by its index.
    pub(crate) fn validate_loops(&self) -> Result<(), (usize, LoopDefect)> {
        let mut names = HashSet::new();
        for (index, tie) in self.loops.iter().enumerate() {
            if !names.insert(tie.name.as_str()) {
                return Err((index, LoopDefect::DuplicateName));
            }
            tie.check(self).map_err(|defect| (index, defect))?;
        }
        Ok(())
    }
}

/// An error unless the body exists and its joint has one degree of freedom.
fn coordinate(field: &'static str, body: usize, robot: &Description) -> Result<(), LoopDefect> {
    let found = robot.bodies.get(body).ok_or(LoopDefect::NoBody { field, body, count: robot.bodies.len() })?;
    let kind = found.joint.kind;
    if kind.nv() == 1 { Ok(()) } else { Err(LoopDefect::NoCoordinate { field, body, kind: kind.name() }) }
}

fn finite(field: &'static str, values: &[f64]) -> Result<(), LoopDefect> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(LoopDefect::NotFinite { field, value }),
        None => Ok(()),
    }
}
