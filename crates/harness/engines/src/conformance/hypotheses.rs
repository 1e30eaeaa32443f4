//! Common mistakes of convention, as hypotheses: the answers of an oracle that makes this mistake and is right otherwise.

use super::coordinate_change::{
    CoordinateChange, ONE, SWAP, State, blocks, cross, of_free, of_order, of_planar, of_spherical, places, product, put_back, rotated_back,
    transposed,
};
use super::orders;
use featherbench_bench::{Quantity, Robot};
use featherbench_model::{Description, JointType};
use std::f64::consts::TAU;

/// What a mistake makes of a right answer at one state.
type Rewrite = fn(&Robot, Quantity, &State, &mut [f64]);

/// A mistaken convention: how the oracle interprets the description and a state, and how it writes an answer.
pub(super) struct Hypothesis {
    /// What the oracle seems to do.
    pub(super) seems: &'static str,
    /// What to do about it.
    pub(super) advice: &'static str,
    pub(super) robot: fn(&mut Description),
    pub(super) state: fn(&Description, &mut State),
    pub(super) velocities: Option<fn(&Description, &State) -> CoordinateChange>,
    pub(super) answer: Option<Rewrite>,
}

const NONE: Hypothesis = Hypothesis { seems: "", advice: "", robot: |_| (), state: |_, _| (), velocities: None, answer: None };

/// The mistaken conventions that the test knows.
pub(super) const HYPOTHESES: [Hypothesis; 41] = [
    // ---- configurations
    Hypothesis {
        seems: "quaternions are read as (w, x, y, z)",
        advice: "they are (x, y, z, w)",
        state: |robot, state| quaternions(robot, &mut state.q, |quaternion| quaternion.rotate_left(1)),
        ..NONE
    },
    Hypothesis {
        seems: "quaternions are inverted: they rotate parent axes to body axes",
        advice: "a quaternion's rotation takes body axes to joint-frame axes",
        state: |robot, state| quaternions(robot, &mut state.q, |quaternion| quaternion[..3].iter_mut().for_each(|x| *x = -*x)),
        ..NONE
    },
    // ---- velocities
    Hypothesis {
        seems: "a free joint's velocity is taken as [angular; linear]",
        advice: "it is [linear; angular]; T swaps the halves of v, a, tau and M",
        velocities: Some(|robot, state| of_free(robot, state, |_| (SWAP, false))),
        ..NONE
    },
    Hypothesis {
        seems: "a free joint's linear velocity is taken in world axes: T = diag(R, 1), R from body to world",
        advice: "give the engine v_e = T v and a_e = T a + b with b = [R(ω × v); 0]; back come tau = T' tau_e, M = T' M_e T, a = T'(a_e − b)",
        velocities: Some(|robot, state| of_free(robot, state, |r| (blocks(&r.world, &ONE), true))),
        ..NONE
    },
    Hypothesis {
        seems: "a free joint's linear velocity is taken in joint-frame axes: T = diag(R, 1), R from body to joint frame",
        advice: "give the engine v_e = T v and a_e = T a + b with b = [R(ω × v); 0]; back come tau = T' tau_e, M = T' M_e T, a = T'(a_e − b)",
        velocities: Some(|robot, state| of_free(robot, state, |r| (blocks(&r.joint, &ONE), true))),
        ..NONE
    },
    Hypothesis {
        seems: "a free joint's velocity is taken as [linear; angular] in world axes: T = diag(R, R), R from body to world",
        advice: "give the engine v_e = T v and a_e = T a + b with b = [R(ω × v); 0]",
        velocities: Some(|robot, state| of_free(robot, state, |r| (blocks(&r.world, &r.world), true))),
        ..NONE
    },
    Hypothesis {
        seems: "a free joint's velocity is taken as [angular; linear] in world axes: T = [[0, R], [R, 0]], R from body to world",
        advice: "give the engine v_e = T v and a_e = T a + b with b = [0; R(ω × v)]",
        velocities: Some(|robot, state| of_free(robot, state, |r| (product(&SWAP, &blocks(&r.world, &r.world)), true))),
        ..NONE
    },
    Hypothesis {
        seems: "a free joint's velocity is taken as [angular; linear] in joint-frame axes: T = [[0, R], [R, 0]], R from body to joint frame",
        advice: "give the engine v_e = T v and a_e = T a + b with b = [0; R(ω × v)]",
        velocities: Some(|robot, state| of_free(robot, state, |r| (product(&SWAP, &blocks(&r.joint, &r.joint)), true))),
        ..NONE
    },
    Hypothesis {
        seems: "the term b is missing: a free joint's acceleration is taken as the classical one of its origin",
        advice: "a is the time derivative of the numbers in v: between a and the classical acceleration lies ω × v (a_e = T a + b)",
        velocities: Some(|robot, state| of_free(robot, state, |_| (blocks(&ONE, &ONE), true))),
        ..NONE
    },
    Hypothesis {
        seems: "a spherical joint's velocity is taken in joint-frame axes: T = R",
        advice: "it is the angular velocity in body axes; v_e = R v, a_e = R a, tau = R' tau_e",
        velocities: Some(of_spherical),
        ..NONE
    },
    Hypothesis {
        seems: "a planar joint's linear velocity is taken in body axes: T = diag(R(θ)', 1)",
        advice: "it is in joint-frame axes; v_e = T v, a_e = T a + b with b = [−θ̇ ẑ × R(θ)'(ẋ, ẏ); 0]",
        velocities: Some(of_planar),
        ..NONE
    },
    Hypothesis {
        seems: "the terms of velocity are left out",
        advice: "h(q, v) holds the Coriolis and centrifugal forces as well as gravity",
        state: |_, state| state.v.fill(0.0),
        ..NONE
    },
    // ---- orders
    Hypothesis {
        seems: "a cylindrical joint's numbers are taken as [distance, angle]",
        advice: "they are [angle, distance]",
        state: |robot, state| put_back(&orders::joints_reversed(robot, is_cylindrical).q, &mut state.q),
        velocities: Some(|robot, _| of_order(&orders::joints_reversed(robot, is_cylindrical).v)),
        ..NONE
    },
    Hypothesis {
        seems: "Euler angles are taken as those about x, y and z",
        advice: "they rotate about z first, then about the moved y, then about the moved x",
        state: |robot, state| put_back(&orders::joints_reversed(robot, |kind| kind == JointType::EulerZyx).q, &mut state.q),
        velocities: Some(|robot, _| of_order(&orders::joints_reversed(robot, |kind| kind == JointType::EulerZyx).v)),
        ..NONE
    },
    Hypothesis {
        seems: "degrees of freedom are taken depth-first with siblings by name",
        advice: "q, v and what is dual to v stand in the order of the description's bodies",
        state: |robot, state| put_back(&orders::siblings_by_name(robot).q, &mut state.q),
        velocities: Some(|robot, _| of_order(&orders::siblings_by_name(robot).v)),
        ..NONE
    },
    Hypothesis {
        seems: "degrees of freedom are taken depth-first with siblings from the last to the first",
        advice: "q, v and what is dual to v stand in the order of the description's bodies",
        state: |robot, state| put_back(&orders::siblings_reversed(robot).q, &mut state.q),
        velocities: Some(|robot, _| of_order(&orders::siblings_reversed(robot).v)),
        ..NONE
    },
    Hypothesis {
        seems: "degrees of freedom are taken level by level",
        advice: "q, v and what is dual to v stand in the order of the description's bodies",
        state: |robot, state| put_back(&orders::breadth_first(robot).q, &mut state.q),
        velocities: Some(|robot, _| of_order(&orders::breadth_first(robot).v)),
        ..NONE
    },
    Hypothesis {
        seems: "degrees of freedom are taken by the names of their joints",
        advice: "q, v and what is dual to v stand in the order of the description's bodies",
        state: |robot, state| put_back(&orders::by_name(robot).q, &mut state.q),
        velocities: Some(|robot, _| of_order(&orders::by_name(robot).v)),
        ..NONE
    },
    // ---- the description
    Hypothesis {
        seems: "the pitch of a helical joint is taken per revolution",
        advice: "it is in metres per radian; an engine that wants it per revolution gets 2π·pitch",
        robot: |robot| {
            joints(robot, |joint| {
                if let JointType::Helical { pitch, .. } = &mut joint.kind {
                    *pitch /= TAU
                }
            })
        },
        ..NONE
    },
    Hypothesis {
        seems: "armature is left out",
        advice: "add it to the diagonal of M, and armature·a to tau",
        robot: |robot| joints(robot, |joint| joint.armature.fill(0.0)),
        ..NONE
    },
    Hypothesis {
        seems: "the armature of revolute and helical joints is left out where the axis is no coordinate axis",
        advice: "joints of any axis have armature; Pinocchio 4.1.0's computeKineticEnergy is known for this",
        robot: |robot| {
            joints(robot, |joint| {
                if rotates_about_skew_axis(joint.kind) {
                    joint.armature.fill(0.0)
                }
            })
        },
        ..NONE
    },
    Hypothesis {
        seems: "gravity has the wrong sign",
        advice: "`gravity` is the acceleration of free fall: a world that accelerates by −gravity stands for it",
        robot: |robot| robot.gravity = robot.gravity.map(|x| -x),
        ..NONE
    },
    Hypothesis {
        seems: "gravity is left out",
        advice: "tau and h contain gravity; set it from `gravity`",
        robot: |robot| robot.gravity = [0.0; 3],
        ..NONE
    },
    Hypothesis {
        seems: "inertias are taken about the body's origin",
        advice: "`inertia` is about the centre of mass: add m(c·c 1 − c c') for the origin",
        robot: |robot| shift_inertia(robot, -1.0),
        ..NONE
    },
    Hypothesis {
        seems: "inertias are shifted to the body's origin twice",
        advice: "`inertia` is about the centre of mass: an engine that wants it so shall not get it shifted",
        robot: |robot| shift_inertia(robot, 1.0),
        ..NONE
    },
    Hypothesis {
        seems: "inertias are read as xx, yy, zz, xy, xz, yz",
        advice: "their order is xx, xy, xz, yy, yz, zz",
        robot: |robot| inertias(robot, |[xx, yy, zz, xy, xz, yz]| [xx, xy, xz, yy, yz, zz]),
        ..NONE
    },
    Hypothesis {
        seems: "products of inertia are left out",
        advice: "xy, xz and yz are entries of the tensor like the others",
        robot: |robot| inertias(robot, |[xx, _, _, yy, _, zz]| [xx, 0.0, 0.0, yy, 0.0, zz]),
        ..NONE
    },
    Hypothesis {
        seems: "products of inertia have the wrong sign",
        advice: "xy, xz and yz are entries of the tensor (xy = −∫xy dm), not the integrals",
        robot: |robot| inertias(robot, |[xx, xy, xz, yy, yz, zz]| [xx, -xy, -xz, yy, -yz, zz]),
        ..NONE
    },
    Hypothesis {
        seems: "placements are transposed: read column by column",
        advice: "`rotation` is row-major and takes joint axes to parent axes",
        robot: |robot| joints(robot, |joint| joint.placement.rotation = transposed(&joint.placement.rotation)),
        ..NONE
    },
    Hypothesis {
        seems: "axes are taken in the parent's frame",
        advice: "`axis` is in the joint's frame, behind the placement",
        robot: axes_in_parent,
        ..NONE
    },
    Hypothesis {
        seems: "joint damping is included",
        advice: "leave `damping` out: it is carried for information",
        state: |robot, state| {
            let force = resistance(robot, |joint| &joint.damping, &state.v, |v| v);
            state.tau.iter_mut().zip(force).for_each(|(tau, force)| *tau -= force);
        },
        answer: Some(|robot, quantity, state, value| {
            if is_inverse(quantity) {
                let force = resistance(&robot.description, |joint| &joint.damping, &state.v, |v| v);
                value.iter_mut().zip(force).for_each(|(tau, force)| *tau += force);
            }
        }),
        ..NONE
    },
    Hypothesis {
        seems: "dry friction is included",
        advice: "leave `friction` out: it is carried for information",
        answer: Some(|robot, quantity, state, value| {
            if is_inverse(quantity) {
                let force = resistance(&robot.description, |joint| &joint.friction, &state.v, f64::signum);
                value.iter_mut().zip(force).for_each(|(tau, force)| *tau += force);
            }
        }),
        ..NONE
    },
    // ---- wrenches
    Hypothesis {
        seems: "wrenches are read as [force; moment]",
        advice: "a wrench is [moment about the body's origin; force], in body axes",
        state: |_, state| state.wrench.chunks_exact_mut(6).for_each(|wrench| wrench.rotate_left(3)),
        ..NONE
    },
    Hypothesis {
        seems: "wrenches are taken in world axes",
        advice: "they are in body axes: rotate them by the body's rotation for an engine that wants the world's",
        state: |_, state| {
            for (wrench, place) in state.wrench.chunks_exact_mut(6).zip(state.placement.chunks_exact(12)) {
                wrench.chunks_exact_mut(3).for_each(|part| rotated_back(place, part));
            }
        },
        ..NONE
    },
    Hypothesis {
        seems: "wrenches have the wrong sign",
        advice: "they act on the body: tau = M a + h − Σ J' f",
        state: |_, state| state.wrench.iter_mut().for_each(|x| *x = -*x),
        ..NONE
    },
    // ---- answers
    Hypothesis {
        seems: "only the upper triangle of M is filled",
        advice: "send both triangles",
        answer: Some(|robot, quantity, _, value| triangle(robot, quantity, value, |row, column| row <= column)),
        ..NONE
    },
    Hypothesis {
        seems: "only the lower triangle of M is filled",
        advice: "send both triangles",
        answer: Some(|robot, quantity, _, value| triangle(robot, quantity, value, |row, column| row >= column)),
        ..NONE
    },
    Hypothesis {
        seems: "6-vectors are sent as [linear; angular]",
        advice: "send [angular; linear]",
        answer: Some(|robot, quantity, _, value| match quantity {
            Quantity::BodyVelocity | Quantity::BodyAcceleration | Quantity::Momentum => {
                value.chunks_exact_mut(6).for_each(|vector| vector.rotate_left(3));
            }
            Quantity::BodyJacobian => value.rotate_left(3 * robot.states.nv),
            _ => {}
        }),
        ..NONE
    },
    Hypothesis {
        seems: "velocities and accelerations of bodies are sent in body axes",
        advice: "send them in world axes",
        answer: Some(|_, quantity, state, value| {
            if matches!(quantity, Quantity::BodyVelocity | Quantity::BodyAcceleration) {
                for (vector, place) in value.chunks_exact_mut(6).zip(state.placement.chunks_exact(12)) {
                    vector.chunks_exact_mut(3).for_each(|part| rotated_back(place, part));
                }
            }
        }),
        ..NONE
    },
    Hypothesis {
        seems: "accelerations of bodies are spatial",
        advice: "send the classical ones: add ω × v to the linear part",
        answer: Some(|_, quantity, state, value| {
            if quantity == Quantity::BodyAcceleration {
                for (vector, velocity) in value.chunks_exact_mut(6).zip(state.velocity.chunks_exact(6)) {
                    let carried = cross(&velocity[..3], &velocity[3..]);
                    vector[3..].iter_mut().zip(carried).for_each(|(x, c)| *x -= c);
                }
            }
        }),
        ..NONE
    },
    Hypothesis {
        seems: "angular momentum is about the world's origin",
        advice: "send it about the centre of mass",
        answer: Some(|_, quantity, state, value| {
            if quantity == Quantity::Momentum {
                let carried = cross(&state.com, &state.momentum[3..]);
                value.iter_mut().zip(carried).for_each(|(x, c)| *x += c);
            }
        }),
        ..NONE
    },
];

// ---- building blocks

fn is_inverse(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::InverseDynamics | Quantity::InverseDynamicsWrench | Quantity::Bias)
}

fn joints(robot: &mut Description, change: impl Fn(&mut featherbench_model::JointDescription)) {
    robot.bodies.iter_mut().for_each(|body| change(&mut body.joint));
}

fn rotates_about_skew_axis(kind: JointType) -> bool {
    match kind {
        JointType::Revolute { axis } | JointType::Helical { axis, .. } => axis.iter().filter(|&&x| x != 0.0).count() > 1,
        _ => false,
    }
}

fn is_cylindrical(kind: JointType) -> bool {
    matches!(kind, JointType::Cylindrical { .. })
}

fn inertias(robot: &mut Description, change: impl Fn([f64; 6]) -> [f64; 6]) {
    robot.bodies.iter_mut().for_each(|body| body.inertia = change(body.inertia));
}

/// I + sign·m (|c|²·1 − c cᵀ): moves each inertia between the centre of mass c and the body's origin.
fn shift_inertia(robot: &mut Description, sign: f64) {
    for body in &mut robot.bodies {
        let ([x, y, z], m) = (body.com, sign * body.mass);
        let shift = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
        body.inertia.iter_mut().zip(shift).for_each(|(entry, shift)| *entry += m * shift);
    }
}

fn axes_in_parent(robot: &mut Description) {
    joints(robot, |joint| {
        let rotation = joint.placement.rotation;
        if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut joint.kind {
            rotated_back(&rotation, axis);
        }
    });
}

/// Where a joint's quaternion begins, if it has one.
fn quaternion_at(kind: JointType, q: usize) -> Option<usize> {
    match kind {
        JointType::Spherical => Some(q),
        JointType::Free => Some(q + 3),
        _ => None,
    }
}

fn quaternions(robot: &Description, q: &mut [f64], change: impl Fn(&mut [f64])) {
    let found = places(robot).into_iter().filter_map(|(at, _, body)| quaternion_at(body.joint.kind, at));
    found.for_each(|at| change(&mut q[at..at + 4]));
}

/// `law(v)` times each dof's coefficient.
fn resistance(robot: &Description, of: fn(&featherbench_model::JointDescription) -> &Vec<f64>, v: &[f64], law: fn(f64) -> f64) -> Vec<f64> {
    let mut force = vec![0.0; v.len()];
    for (_, at, body) in places(robot) {
        for (k, coefficient) in of(&body.joint).iter().enumerate() {
            force[at + k] = if v[at + k] == 0.0 { 0.0 } else { coefficient * law(v[at + k]) };
        }
    }
    force
}

fn triangle(robot: &Robot, quantity: Quantity, value: &mut [f64], keeps: fn(usize, usize) -> bool) {
    let n = robot.states.nv;
    if quantity == Quantity::MassMatrix {
        value.iter_mut().enumerate().filter(|(at, _)| !keeps(at / n, at % n)).for_each(|(_, x)| *x = 0.0);
    }
}
