//! A string: links without springs.

use super::{Host, Made, Masses, add_piece, along, joint_of, massless};
use crate::{Rod, Strain};
use featherbench_model::BodyDescription;

/// Makes the bodies of a string.
pub(crate) fn make(bodies: &mut Vec<BodyDescription>, name: &str, rod: &Rod, host: &Host, element: (usize, Masses, bool)) -> Made {
    let (count, masses, planar) = element;
    let h = rod.length() / count as f64;
    let turns: &[Strain] = if planar { &[Strain::BendZ] } else { &[Strain::BendY, Strain::BendZ] };
    let (mut parent, mut placement) = (host.body, host.placement);
    for link in 0..count {
        for turn in turns {
            bodies.push(massless(format!("{name}.{link}.{turn:?}"), parent, joint_of(*turn), placement));
            (parent, placement) = (Some(bodies.len() - 1), along(0.0));
        }
        if let Some(body) = bodies.last_mut() {
            match masses {
                Masses::Uniform => add_piece(body, rod, 0.0, h),
                Masses::Ends => (body.mass, body.com) = (rod.mass_per_length() * h, [h, 0.0, 0.0]),
            }
        }
        placement = along(h);
    }
    let tip = bodies.len() - 1;
    Made { tip, tip_placement: placement, springs: Vec::new(), pieces: Vec::new() }
}
