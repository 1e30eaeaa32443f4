//! Rigid links with springs.
//!
//! With the loads of the weak form, the springs stand for the integral of the strain energy by a rule with nodes at the joints. So errors
//! of statics have closed forms: of a cantilever with a tip load, δ/δ_exact = 1 + 3/(2n) + 1/(2n²) for [`Hinges::Start`], 1 + 1/(2n²) for
//! [`Hinges::StartStiffWall`], 1 − 1/(4n²) for [`Hinges::Middle`].

use super::{Hinges, Host, Made, Spring, add_piece, along, joint_of, massless};
use crate::{Rod, Strain};
use featherbench_model::{BodyDescription, JointType};

/// Makes the bodies of a rod of rigid links.
pub(crate) fn make(bodies: &mut Vec<BodyDescription>, name: &str, rod: &Rod, host: &Host, element: (usize, Hinges, &[Strain])) -> Made {
    let (count, hinges, strains) = element;
    let mut ordered = strains.to_vec();
    // Slides first, then turns: a turn does not then take the slide of its own joint with it.
    ordered.sort_by_key(|strain| (strain.turns(), *strain));
    let h = rod.length() / count as f64;
    let half = hinges == Hinges::Middle;
    let mut springs = Vec::with_capacity(count * ordered.len());

    let (mut parent, mut placement) = (host.body, host.placement);
    if half {
        let mut root = massless(format!("{name}.root"), parent, JointType::Fixed, placement);
        add_piece(&mut root, rod, 0.0, 0.5 * h);
        bodies.push(root);
        (parent, placement) = (Some(bodies.len() - 1), along(0.5 * h));
    }
    for link in 0..count {
        let stiffer = if link == 0 && hinges == Hinges::StartStiffWall { 2.0 } else { 1.0 };
        for strain in &ordered {
            let body = massless(format!("{name}.{link}.{strain:?}"), parent, joint_of(*strain), placement);
            bodies.push(body);
            springs.push(Spring { body: bodies.len() - 1, stiffness: stiffer * rod.stiffness(*strain) / h });
            (parent, placement) = (Some(bodies.len() - 1), along(0.0));
        }
        let length = if half && link + 1 == count { 0.5 * h } else { h };
        if let Some(body) = bodies.last_mut() {
            add_piece(body, rod, 0.0, length);
        }
        placement = along(length);
    }
    let tip = bodies.len() - 1;
    Made { tip, tip_placement: placement, springs, pieces: Vec::new() }
}
