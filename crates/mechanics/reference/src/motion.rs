//! Positions and velocities of all bodies in world axes, with the columns of all Jacobians and their derivatives in time.
//!
//! Computes R, p, ω and ṗ of each body, from the root outwards. Each degree of freedom k of a joint has two columns: z_k, the axis of the
//! angular velocity that it adds, and l_k, the velocity that it adds to the body's origin:
//!
//! ```text
//! ω_b = ω_p + Σ z_k v_k          ṗ_b = ṗ_p + ω_p × (p_b − p_p) + Σ l_k v_k
//! ```
//!
//! A column that is fixed in a frame of angular velocity Ω changes by ż = Ω × z, l̇ = Ω × l. Source: first principles, as in
//! Kane & Levinson, *Dynamics: Theory and Applications* (1985), chapter 2 (partial velocities). Frame: world.
//! Cost: O(bodies), and the lists of degrees of freedom on each body's path.

use crate::robot::{Body, Kind, Robot};
use crate::space::{Mat3, Vec3};
use crate::{Error, Mp};
use std::array::from_fn;

/// A body's pose and velocity, in world axes.
#[derive(Clone, Debug)]
pub(crate) struct BodyMotion {
    pub rotation: Mat3<Mp>,
    pub origin: Vec3<Mp>,
    pub omega: Vec3<Mp>,
    pub velocity: Vec3<Mp>,
    /// Centre of mass, and its velocity.
    pub com: Vec3<Mp>,
    pub com_velocity: Vec3<Mp>,
    /// Inertia about the centre of mass, in world axes.
    pub inertia: Mat3<Mp>,
    /// The degrees of freedom between the world and this body.
    pub path: Vec<usize>,
}

/// The effect of one degree of freedom on the body of its joint, in world axes.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// The body of the joint.
    pub body: usize,
    /// Angular velocity per unit rate.
    pub z: Vec3<Mp>,
    /// Velocity of the body's origin per unit rate.
    pub l: Vec3<Mp>,
    /// Derivatives of the two.
    pub z_rate: Vec3<Mp>,
    pub l_rate: Vec3<Mp>,
}

/// A robot at a configuration and a velocity.
///
/// Made by [`Robot::moving`] or [`Robot::at`]; the dynamics are its methods.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) bodies: Vec<BodyMotion>,
    pub(crate) columns: Vec<Column>,
    pub(crate) v: Vec<Mp>,
}

/// The frame in which a column is fixed.
#[derive(Clone, Copy)]
enum FixedIn {
    Parent,
    /// The frame that the joint's first degree of freedom moves.
    Between,
    Child,
}

/// A joint at its configuration: rotation and translation in the joint frame, and the columns. A column that is fixed in the child is in
/// the child's axes; the others are in the joint frame's.
struct Across {
    turn: Mat3<Mp>,
    shift: Vec3<Mp>,
    columns: Vec<(FixedIn, Vec3<Mp>, Vec3<Mp>)>,
}

impl Robot {
    /// The robot at a configuration and velocity of doubles, taken exactly (quaternions normalised).
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::NotFinite`], or [`Error::NoDirection`] for a zero quaternion.
    pub fn moving(&self, q: &[f64], v: &[f64]) -> Result<Motion<'_>, Error> {
        self.at(&self.numbers("q", q)?, &self.numbers("v", v)?)
    }

    /// The robot at a configuration and velocity.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::NoDirection`] for a zero quaternion.
    pub fn at(&self, q: &[Mp], v: &[Mp]) -> Result<Motion<'_>, Error> {
        Self::check("q", q.len(), self.nq())?;
        Self::check("v", v.len(), self.nv())?;
        let mut motion =
            Motion { robot: self, bodies: Vec::with_capacity(self.bodies()), columns: Vec::with_capacity(self.nv()), v: v.to_vec() };
        for (index, body) in self.bodies.iter().enumerate() {
            let across = self.across(body, &q[body.q..])?;
            motion.add(index, body, across);
        }
        Ok(motion)
    }

    /// A joint at its configuration `q`.
    fn across(&self, body: &Body, q: &[Mp]) -> Result<Across, Error> {
        let one = self.precision.integer(1);
        let zero = Vec3::<Mp>::zero;
        let unit: [Vec3<Mp>; 3] = from_fn(|i| Vec3(from_fn(|j| if i == j { one.clone() } else { Mp::zero() })));
        let still = Mat3(unit.clone());
        let along = |d: &Vec3<Mp>, q: &Mp| d.times(q);
        let [x, y, z] = &unit;
        Ok(match &body.kind {
            Kind::Revolute(u) => {
                Across { turn: Mat3::turn(u, &q[0], &one), shift: zero(), columns: vec![(FixedIn::Parent, u.clone(), zero())] }
            }
            Kind::Prismatic(u) => Across { turn: still, shift: along(u, &q[0]), columns: vec![(FixedIn::Parent, zero(), u.clone())] },
            Kind::Helical(u, pitch) => {
                let lead = u.times(pitch);
                Across { turn: Mat3::turn(u, &q[0], &one), shift: along(&lead, &q[0]), columns: vec![(FixedIn::Parent, u.clone(), lead)] }
            }
            Kind::Planar => Across {
                turn: Mat3::turn(z, &q[2], &one),
                shift: Vec3([q[0].clone(), q[1].clone(), Mp::zero()]),
                columns: vec![
                    (FixedIn::Parent, zero(), x.clone()),
                    (FixedIn::Parent, zero(), y.clone()),
                    (FixedIn::Parent, z.clone(), zero()),
                ],
            },
            // The second axis is y of the rotated frame, which the second rotation does not change.
            Kind::Universal => Across {
                turn: Mat3::turn(x, &q[0], &one).product(&Mat3::turn(y, &q[1], &one)),
                shift: zero(),
                columns: vec![(FixedIn::Parent, x.clone(), zero()), (FixedIn::Child, y.clone(), zero())],
            },
            Kind::Translation => Across {
                turn: still,
                shift: Vec3(from_fn(|i| q[i].clone())),
                columns: unit.iter().map(|e| (FixedIn::Parent, zero(), e.clone())).collect(),
            },
            Kind::Cylindrical(u) => Across {
                turn: Mat3::turn(u, &q[0], &one),
                shift: along(u, &q[1]),
                columns: vec![(FixedIn::Parent, u.clone(), zero()), (FixedIn::Parent, zero(), u.clone())],
            },
            // The first axis is the joint frame's z, the second the y that the first rotation moved, the third the body's own x.
            Kind::EulerZyx => {
                let first = Mat3::turn(z, &q[0], &one);
                let columns = vec![
                    (FixedIn::Parent, z.clone(), zero()),
                    (FixedIn::Between, first.apply(y), zero()),
                    (FixedIn::Child, x.clone(), zero()),
                ];
                let turn = first.product(&Mat3::turn(y, &q[1], &one)).product(&Mat3::turn(x, &q[2], &one));
                Across { turn, shift: zero(), columns }
            }
            Kind::Spherical => Across {
                turn: quaternion_turn(&q[..4], &one).ok_or_else(|| no_quaternion(body))?,
                shift: zero(),
                columns: unit.iter().map(|e| (FixedIn::Child, e.clone(), zero())).collect(),
            },
            Kind::Free => Across {
                turn: quaternion_turn(&q[3..7], &one).ok_or_else(|| no_quaternion(body))?,
                shift: Vec3(from_fn(|i| q[i].clone())),
                columns: (unit.iter().map(|e| (FixedIn::Child, zero(), e.clone())))
                    .chain(unit.iter().map(|e| (FixedIn::Child, e.clone(), zero())))
                    .collect(),
            },
        })
    }
}

fn no_quaternion(body: &Body) -> Error {
    Error::NoDirection { body: body.name.clone(), what: "the quaternion" }
}

/// R of the quaternion (x, y, z, w) of any length but zero: 1 + 2(w[u]× + [u]×²)/|·|².
fn quaternion_turn(q: &[Mp], one: &Mp) -> Option<Mat3<Mp>> {
    let square = q.iter().map(|x| x * x).sum::<Mp>();
    if square.is_zero() {
        return None;
    }
    let scale = one.twice() / square;
    let pair = |i: usize, j: usize| &scale * (&q[i] * &q[j]);
    let [xx, yy, zz] = from_fn(|i| pair(i, i));
    let (xy, xz, yz, wx, wy, wz) = (pair(0, 1), pair(0, 2), pair(1, 2), pair(3, 0), pair(3, 1), pair(3, 2));
    Some(Mat3([
        Vec3([one - (&yy + &zz), &xy - &wz, &xz + &wy]),
        Vec3([&xy + &wz, one - (&xx + &zz), &yz - &wx]),
        Vec3([&xz - &wy, &yz + &wx, one - (&xx + &yy)]),
    ]))
}

impl Motion<'_> {
    /// Adds the next body; its parent has been added before.
    fn add(&mut self, index: usize, body: &Body, across: Across) {
        let (joint_rotation, joint_origin, omega_p, velocity_p, from_parent, mut path) = match body.parent.map(|p| &self.bodies[p]) {
            Some(parent) => {
                let arm = parent.rotation.apply(&body.translation);
                let rotation = parent.rotation.product(&body.rotation);
                (rotation, parent.origin.plus(&arm), parent.omega.clone(), parent.velocity.clone(), arm, parent.path.clone())
            }
            None => (body.rotation.clone(), body.translation.clone(), Vec3::zero(), Vec3::zero(), body.translation.clone(), Vec::new()),
        };
        let rotation = joint_rotation.product(&across.turn);
        let shift = joint_rotation.apply(&across.shift);
        let origin = joint_origin.plus(&shift);
        let columns: Vec<_> = (across.columns.into_iter())
            .map(|(fixed, z, l)| match fixed {
                FixedIn::Parent | FixedIn::Between => (fixed, joint_rotation.apply(&z), joint_rotation.apply(&l)),
                FixedIn::Child => (fixed, rotation.apply(&z), rotation.apply(&l)),
            })
            .collect();

        // ω = ω_p + Σ z v,  ṗ = ṗ_p + ω_p × (p − p_p) + Σ l v
        let rates = &self.v[body.v..body.v + body.nv];
        let mut omega = omega_p.clone();
        let mut velocity = velocity_p.plus(&omega_p.cross(&from_parent.plus(&shift)));
        for ((_, z, l), rate) in columns.iter().zip(rates) {
            omega = omega.plus(&z.times(rate));
            velocity = velocity.plus(&l.times(rate));
        }
        let between = columns.iter().zip(rates).next().map_or(omega_p.clone(), |((_, z, _), rate)| omega_p.plus(&z.times(rate)));
        for (fixed, z, l) in columns {
            let turning = match fixed {
                FixedIn::Parent => &omega_p,
                FixedIn::Between => &between,
                FixedIn::Child => &omega,
            };
            path.push(self.columns.len());
            self.columns.push(Column { body: index, z_rate: turning.cross(&z), l_rate: turning.cross(&l), z, l });
        }
        let arm = rotation.apply(&body.com);
        self.bodies.push(BodyMotion {
            com: origin.plus(&arm),
            com_velocity: velocity.plus(&omega.cross(&arm)),
            inertia: rotation.product(&body.inertia).product(&rotation.transposed()),
            rotation,
            origin,
            omega,
            velocity,
            path,
        });
    }
}
