//! Shape functions: point masses at Gauss points, each on slides of its own from the clamped end, and a tip that follows.
//!
//! The masses are points: Euler–Bernoulli's beam, without the rotary inertia of bending. A twist turns them with ρ (I_y + I_z).
//!
//! The slides and turns are q = Φ s, with Φ_{kj} = φ_j(x_k): so M = Σ_k w_k ρA φ(x_k) φ(x_k)ᵀ is the mass matrix of the rod as far as the
//! Gauss rule is exact. The stiffness is ∫ EI φ'' φ''ᵀ, ∫ EA φ' φ'ᵀ or ∫ GJ φ' φ'ᵀ by the same rule.

use super::{Host, Made, Piece, Ties, along, along_x, joint_of, massless};
use crate::{Basis, Rod, Strain};
use featherbench_model::BodyDescription;
use nalgebra::DMatrix;

/// Makes the bodies of a rod with shape functions.
pub(crate) fn make(bodies: &mut Vec<BodyDescription>, name: &str, rod: &Rod, host: &Host, basis: Basis, strains: &[Strain]) -> Made {
    let length = rod.length();
    let mut strains = strains.to_vec();
    // The tip slides before it turns.
    strains.sort_by_key(|strain| (*strain != Strain::Extension, *strain));
    let offsets: Vec<usize> = offsets(basis, &strains);
    let terms = offsets.last().copied().unwrap_or(0);
    let mut rows: Vec<(usize, Vec<(usize, f64)>)> = Vec::new();
    let mut stiffness = DMatrix::zeros(terms, terms);

    // The rule of bending integrates the other products too.
    let rule = basis.rule(true);
    for (k, (s, weight)) in rule.iter().enumerate() {
        let mut parent = host.body;
        let mut placement = along_x(&host.placement, s * length);
        for (strain, first) in strains.iter().zip(&offsets) {
            let bending = matches!(strain, Strain::BendY | Strain::BendZ);
            let shapes: Vec<_> = (0..basis.terms(bending)).map(|j| basis.at(bending, j, *s)).collect();
            for (i, a) in shapes.iter().enumerate() {
                for (j, b) in shapes.iter().enumerate() {
                    // ∫ … dx: L ds, and a derivative by x is one by s, over L.
                    let product = if bending { a.curvature * b.curvature / length.powi(3) } else { a.slope * b.slope / length };
                    stiffness[(first + i, first + j)] += weight * rod.stiffness(*strain) * product;
                }
            }
            let values = shapes.iter().enumerate().map(|(j, shape)| (first + j, shape.value)).collect();
            bodies.push(massless(format!("{name}.{k}.{strain:?}"), parent, joint_of(deflection(*strain)), placement));
            rows.push((bodies.len() - 1, values));
            (parent, placement) = (Some(bodies.len() - 1), along(0.0));
        }
        if let Some(body) = bodies.last_mut() {
            body.mass = rod.mass_per_length() * weight * length;
            if strains.contains(&Strain::Twist) {
                body.inertia[0] = rod.rotary_inertia()[0] * weight * length;
            }
        }
    }

    // The tip: its slides, then its turns, by −w' about y and v' about z.
    let (mut parent, mut placement) = (host.body, along_x(&host.placement, length));
    let slides = strains.iter().zip(&offsets).filter(|(strain, _)| **strain != Strain::Twist).map(|(strain, first)| (strain, first, false));
    let turns =
        strains.iter().zip(&offsets).filter(|(strain, _)| **strain != Strain::Extension).map(|(strain, first)| (strain, first, true));
    for (strain, first, turn) in slides.chain(turns) {
        let bending = matches!(strain, Strain::BendY | Strain::BendZ);
        let values = (0..basis.terms(bending)).map(|j| {
            let shape = basis.at(bending, j, 1.0);
            let value = match (strain, turn) {
                (Strain::BendY, true) => -shape.slope / length,
                (Strain::BendZ, true) => shape.slope / length,
                _ => shape.value,
            };
            (first + j, value)
        });
        let values = values.collect();
        let moving = if turn { *strain } else { deflection(*strain) };
        let what = if turn { "turn" } else { "slide" };
        bodies.push(massless(format!("{name}.tip.{what}.{strain:?}"), parent, joint_of(moving), placement));
        rows.push((bodies.len() - 1, values));
        (parent, placement) = (Some(bodies.len() - 1), along(0.0));
    }

    let mut shapes = DMatrix::zeros(rows.len(), terms);
    let mut members = Vec::with_capacity(rows.len());
    for (row, (body, values)) in rows.into_iter().enumerate() {
        members.push(body);
        values.into_iter().for_each(|(column, value)| shapes[(row, column)] = value);
    }
    let tip = bodies.len() - 1;
    let piece = Piece { bodies: members, ties: Ties::Linear { shapes }, stiffness };
    Made { tip, tip_placement: along(0.0), springs: Vec::new(), pieces: vec![piece] }
}

/// The first coordinate of each strain, and their number.
fn offsets(basis: Basis, strains: &[Strain]) -> Vec<usize> {
    let mut offsets = vec![0];
    for strain in strains {
        let terms = basis.terms(matches!(strain, Strain::BendY | Strain::BendZ));
        offsets.push(offsets[offsets.len() - 1] + terms);
    }
    offsets
}

/// The motion of a point that is deflected by a strain: bending about y moves along z, bending about z along y.
fn deflection(strain: Strain) -> Strain {
    match strain {
        Strain::BendY => Strain::ShearZ,
        Strain::BendZ => Strain::ShearY,
        other => other,
    }
}
