//! Elements of constant strain (a Cosserat rod): the pose along an element is exp(x ξ), ξ = [κ; ε] constant.
//!
//! Source: F. Renda, F. Boyer, J. Dias and L. Seneviratne (2018), "Discrete Cosserat approach for multisection soft manipulator dynamics",
//! whose poses these are. Here each Gauss point is a body on a free joint from the point before. Let Δ be the distance of the two. The
//! joint is at exp(Δ ξ). Its velocity in body axes is J(Δ ξ) Δ ξ̇, with the right Jacobian J of the exponential.

use super::{Host, Made, Piece, Ties, along, massless};
use crate::{Rod, Strain};
use featherbench_model::{BodyDescription, JointType};
use nalgebra::{DMatrix, DVector};

/// Makes the bodies of a rod of sections.
pub(crate) fn make(bodies: &mut Vec<BodyDescription>, name: &str, rod: &Rod, host: &Host, element: (usize, &[Strain], usize)) -> Made {
    let (count, strains, points) = element;
    let h = rod.length() / count as f64;
    let stiffness = DMatrix::from_diagonal(&DVector::from_iterator(strains.len(), strains.iter().map(|strain| rod.stiffness(*strain) * h)));
    let rule = crate::quadrature::gauss(points);
    let (mut parent, mut placement) = (host.body, host.placement);
    let mut pieces = Vec::with_capacity(count);
    for section in 0..count {
        let (mut members, mut steps, mut last) = (Vec::with_capacity(points + 1), Vec::with_capacity(points + 1), 0.0);
        for (k, (x, weight)) in rule.iter().chain(&[(1.0, 0.0)]).enumerate() {
            let mut body = massless(format!("{name}.{section}.{k}"), parent, JointType::Free, placement);
            body.mass = rod.mass_per_length() * weight * h;
            let [about_x, about_y, about_z] = rod.rotary_inertia().map(|rotary| rotary * weight * h);
            body.inertia = [about_x, 0.0, 0.0, about_y, 0.0, about_z];
            bodies.push(body);
            members.push(bodies.len() - 1);
            steps.push((x - last) * h);
            last = *x;
            (parent, placement) = (Some(bodies.len() - 1), along(0.0));
        }
        let ties = Ties::Screw { steps, strains: strains.to_vec() };
        pieces.push(Piece { bodies: members, ties, stiffness: stiffness.clone() });
    }
    let tip = bodies.len() - 1;
    Made { tip, tip_placement: along(0.0), springs: Vec::new(), pieces }
}
