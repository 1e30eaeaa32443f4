//! Constraints between bodies, between a body and the world, and between coordinates.

use crate::attachment::Attachment;
use crate::malformed::{BadConstraint, Defect};
use featherbench_model::{JointKind, LoopMotion, Topology};
use featherbench_spatial::Mat3;
use featherbench_spatial::largest;

/// A constraint with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// The name, unique among the constraints of a robot.
    pub name: String,
    /// What it demands.
    pub law: Law,
}

/// What a constraint demands. Rows along axes are in the axes of the first frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// The origin of the second frame on that of the first, along the named axes: one row per axis, m.
    Point {
        /// The frame whose axes the rows have.
        first: Attachment,
        /// The frame that is held.
        second: Attachment,
        /// The axes x, y and z along which it is held.
        axes: [bool; 3],
    },
    /// The second frame moves on the first as by a joint about or along z.
    Joint {
        /// The frame whose axes the rows have.
        first: Attachment,
        /// The frame that is held.
        second: Attachment,
        /// What is left free.
        motion: LoopMotion,
    },
    /// The origins of two frames at a distance: one row, m.
    Distance {
        /// One end.
        first: Attachment,
        /// The other end.
        second: Attachment,
        /// The distance, m.
        length: f64,
    },
    /// `Σ c_k q_k = offset` over coordinates of one-dof joints: one row. Of two wheels it is a gear, of three a planetary train.
    Gear {
        /// The dof and the coefficient of each coordinate.
        terms: Vec<(usize, f64)>,
        /// The sum.
        offset: f64,
    },
    /// `q_follower = p(q_leader)`: one row.
    Mimic {
        /// The dof that follows.
        follower: usize,
        /// The dof that leads.
        leader: usize,
        /// The coefficients of p, by rising power: offset, multiplier, and those of the square, cube and fourth power.
        polynomial: [f64; 5],
    },
}

fn count(axes: [bool; 3]) -> usize {
    axes.into_iter().filter(|held| *held).count()
}

impl Law {
    /// The number of rows.
    pub fn rows(&self) -> usize {
        match self {
            Self::Point { axes, .. } => count(*axes),
            Self::Joint { motion, .. } => 6 - motion.freedom(),
            Self::Distance { .. } | Self::Gear { .. } | Self::Mimic { .. } => 1,
        }
    }

    /// The two frames, of the laws that have them.
    pub fn frames(&self) -> Option<[&Attachment; 2]> {
        match self {
            Self::Point { first, second, .. } | Self::Joint { first, second, .. } | Self::Distance { first, second, .. } => {
                Some([first, second])
            }
            Self::Gear { .. } | Self::Mimic { .. } => None,
        }
    }
}

impl Constraint {
    /// A point held along all axes.
    pub fn point(name: &str, first: Attachment, second: Attachment) -> Self {
        Self { name: name.into(), law: Law::Point { first, second, axes: [true; 3] } }
    }

    /// A weld.
    pub fn weld(name: &str, first: Attachment, second: Attachment) -> Self {
        Self { name: name.into(), law: Law::Joint { first, second, motion: LoopMotion::Fixed } }
    }

    fn check(&self, topology: &Topology) -> Result<(), Defect> {
        if let Some(frames) = self.law.frames() {
            for (frame, side) in frames.into_iter().zip(["first", "second"]) {
                check_attachment(frame, side, topology)?;
            }
            if frames[0].body == frames[1].body {
                return Err(Defect::SameBody);
            }
        }
        match &self.law {
            Law::Point { axes, .. } if count(*axes) == 0 => Err(Defect::NoAxis),
            Law::Distance { length, .. } if !(length.is_finite() && *length > 0.0) => Err(Defect::Length { length: *length }),
            Law::Point { .. } | Law::Joint { .. } | Law::Distance { .. } => Ok(()),
            Law::Gear { terms, offset } => {
                expect_finite("offset", *offset)?;
                if terms.len() < 2 {
                    return Err(Defect::FewTerms { found: terms.len() });
                }
                for (k, &(dof, coefficient)) in terms.iter().enumerate() {
                    expect_finite("coefficient", coefficient)?;
                    check_dof(dof, topology)?;
                    if coefficient == 0.0 {
                        return Err(Defect::ZeroCoefficient { dof });
                    }
                    if terms[..k].iter().any(|(other, _)| *other == dof) {
                        return Err(Defect::RepeatedDof { dof });
                    }
                }
                Ok(())
            }
            Law::Mimic { follower, leader, polynomial } => {
                polynomial.iter().try_for_each(|coefficient| expect_finite("polynomial", *coefficient))?;
                check_dof(*follower, topology)?;
                check_dof(*leader, topology)?;
                if follower == leader { Err(Defect::RepeatedDof { dof: *leader }) } else { Ok(()) }
            }
        }
    }
}

fn check_attachment(frame: &Attachment, side: &'static str, topology: &Topology) -> Result<(), Defect> {
    if let Some(body) = frame.body.filter(|body| *body >= topology.bodies()) {
        return Err(Defect::NoBody { side, body, bodies: topology.bodies() });
    }
    let rotation = frame.placement.rotation;
    frame.placement.translation.to_array().into_iter().chain(rotation.to_array()).try_for_each(|x| expect_finite("placement", x))?;
    let product: Mat3<f64> = rotation * rotation.transpose();
    let miss = product.to_array().into_iter().zip(Mat3::identity().to_array()).map(|(found, due): (f64, f64)| found - due);
    let miss = largest(miss);
    let determinant = rotation.x.dot(rotation.y.cross(rotation.z));
    // As the model accepts rotations: written with ten digits or more.
    let good = miss <= 1e-9 && determinant > 0.0;
    if good { Ok(()) } else { Err(Defect::NotARotation { side, miss, determinant }) }
}

fn expect_finite(field: &'static str, value: f64) -> Result<(), Defect> {
    if value.is_finite() { Ok(()) } else { Err(Defect::NotFinite { field, value }) }
}

fn check_dof(dof: usize, topology: &Topology) -> Result<(), Defect> {
    let joint = coordinate(dof, topology).ok_or(Defect::NoDof { dof, dofs: topology.nv() })?;
    if joint.0.nv() == 1 { Ok(()) } else { Err(Defect::NoCoordinate { dof }) }
}

/// The kind of the joint that has a dof, and where its part of q begins.
pub(crate) fn coordinate(dof: usize, topology: &Topology) -> Option<(JointKind, usize)> {
    if dof >= topology.nv() {
        return None;
    }
    let joints = topology.joints();
    let joint = &joints[joints.partition_point(|joint| joint.v <= dof) - 1];
    Some((joint.kind, joint.q))
}

/// The constraints of a robot, checked against its tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraints {
    list: Vec<Constraint>,
    /// The row with which each constraint begins, and the number of all.
    starts: Vec<usize>,
    topology: Topology,
}

impl Constraints {
    /// The constraints of a robot with this tree; rows in this order.
    ///
    /// # Errors
    /// [`BadConstraint`], which names the constraint:
    ///
    /// - a body or dof that does not exist,
    /// - a number that is not finite,
    /// - a placement that is no rotation,
    /// - both ends on one body,
    /// - no axis held,
    /// - a length that is not positive,
    /// - a gear of fewer than two wheels, with a dof twice or a coefficient of zero,
    /// - a joint without a coordinate,
    /// - two constraints of one name.
    ///
    /// ```
    /// use featherbench_constrained::{Attachment, Constraint, Constraints};
    /// use featherbench_model::{Axis, JointKind, Topology};
    /// let arm = Topology::new(&[(None, JointKind::Revolute(Axis::Z)), (Some(0), JointKind::Revolute(Axis::Z))]).unwrap();
    /// let tip = Attachment::point(1, [1.0, 0.0, 0.0]);
    /// let held = Constraints::new(&arm, vec![Constraint::point("tip", Attachment::world([1.5, 0.0, 0.0]), tip)])?;
    /// assert_eq!(held.rows(), 3);
    /// assert!(Constraints::new(&arm, vec![Constraint::point("tip", Attachment::point(7, [0.0; 3]), tip)]).is_err());
    /// # Ok::<(), featherbench_constrained::BadConstraint>(())
    /// ```
    pub fn new(topology: &Topology, list: Vec<Constraint>) -> Result<Self, BadConstraint> {
        let mut starts = vec![0];
        for (k, constraint) in list.iter().enumerate() {
            let named = |defect| BadConstraint { name: constraint.name.clone(), defect };
            constraint.check(topology).map_err(named)?;
            if list[..k].iter().any(|other| other.name == constraint.name) {
                return Err(named(Defect::DuplicateName));
            }
            starts.push(starts[k] + constraint.law.rows());
        }
        Ok(Self { list, starts, topology: topology.clone() })
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.starts[self.list.len()]
    }

    /// The constraints, in the order of their rows.
    pub fn list(&self) -> &[Constraint] {
        &self.list
    }

    /// The rows of constraint `k`, which must exist.
    pub fn rows_of(&self, k: usize) -> std::ops::Range<usize> {
        self.starts[k]..self.starts[k + 1]
    }

    /// The name of the constraint that a row belongs to; empty if there is no such row.
    pub fn name_of_row(&self, row: usize) -> &str {
        let at = self.starts.partition_point(|start| *start <= row);
        self.list.get(at.wrapping_sub(1)).map_or("", |constraint| &constraint.name)
    }

    /// The tree.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }
}
