//! Common wrong orders of the numbers in q and v: for each number, its place in our order.

use super::coordinate_change::places;
use featherbench_model::{Description, JointType};

/// The places of q and of v.
pub(super) struct Places {
    pub(super) q: Vec<usize>,
    pub(super) v: Vec<usize>,
}

/// Bodies in an order that takes siblings as `arrange` leaves them, depth first.
fn depth_first(robot: &Description, arrange: impl Fn(&mut Vec<usize>)) -> Places {
    let children = |parent: Option<usize>| {
        let mut found: Vec<usize> = (0..robot.bodies.len()).filter(|&body| robot.bodies[body].parent == parent).collect();
        arrange(&mut found);
        found
    };
    let (mut order, mut stack) = (Vec::new(), children(None));
    stack.reverse();
    while let Some(body) = stack.pop() {
        order.push(body);
        stack.extend(children(Some(body)).into_iter().rev());
    }
    of_bodies(robot, &order)
}

/// Depth first, siblings by the names of their joints.
pub(super) fn siblings_by_name(robot: &Description) -> Places {
    depth_first(robot, |bodies| bodies.sort_by_key(|&body| &robot.bodies[body].joint.name))
}

/// Depth first, siblings from the last to the first.
pub(super) fn siblings_reversed(robot: &Description) -> Places {
    depth_first(robot, |bodies| bodies.reverse())
}

/// Level by level.
pub(super) fn breadth_first(robot: &Description) -> Places {
    let mut depth: Vec<usize> = Vec::with_capacity(robot.bodies.len());
    for body in &robot.bodies {
        depth.push(body.parent.map_or(0, |parent| depth[parent] + 1));
    }
    let mut order: Vec<usize> = (0..robot.bodies.len()).collect();
    order.sort_by_key(|&body| depth[body]);
    of_bodies(robot, &order)
}

/// By the names of the joints.
pub(super) fn by_name(robot: &Description) -> Places {
    let mut order: Vec<usize> = (0..robot.bodies.len()).collect();
    order.sort_by_key(|&body| &robot.bodies[body].joint.name);
    of_bodies(robot, &order)
}

/// The bodies in our order, but the numbers of some joints from the last to the first.
pub(super) fn joints_reversed(robot: &Description, is: impl Fn(JointType) -> bool) -> Places {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for (at_q, at_v, body) in places(robot) {
        let kind = body.joint.kind;
        let add = |to: &mut Vec<usize>, at: usize, size: usize| {
            let from = to.len();
            to.extend(at..at + size);
            if is(kind) {
                to[from..].reverse();
            }
        };
        add(&mut q, at_q, kind.nq());
        add(&mut v, at_v, kind.nv());
    }
    Places { q, v }
}

fn of_bodies(robot: &Description, order: &[usize]) -> Places {
    let ours = places(robot);
    let of = |range: fn(&(usize, usize, &featherbench_model::BodyDescription)) -> std::ops::Range<usize>| {
        order.iter().flat_map(|&body| range(&ours[body])).collect::<Vec<_>>()
    };
    Places { q: of(|(q, _, body)| *q..q + body.joint.kind.nq()), v: of(|(_, v, body)| *v..v + body.joint.kind.nv()) }
}
