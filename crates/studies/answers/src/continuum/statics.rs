//! Equilibria: small deflections against the quadrature that an element is, the elastica, the closed circle, and Newton's method astray.

use super::{Case, Law, NoAnswer, case, count, element, error, failed, largest, rod, told};
use featherbench_continua::known::{elastica, exact_modes_tip_ratio, tip_ratio};
use featherbench_continua::{Hinges, Load, Settings, Status, equilibrium, newton, residual, systems, tangent_stiffness};
use serde_json::json;
use std::f64::consts::TAU;

/// The refinements of the fits.
const COUNTS: [usize; 5] = [4, 8, 16, 32, 64];

/// The elastica's deflections over L, to 14 digits, by α. Cross-checked by shooting in `crates/mechanics/continua/tests/answers.rs`.
const TABLE: [(f64, f64); 5] = [
    (0.1, 0.033_295_319_268_174),
    (1.0, 0.301_720_773_799_81),
    (2.0, 0.493_457_480_396_71),
    (5.0, 0.713_791_523_611_91),
    (10.0, 0.810_609_024_880_3),
];

/// The tip's distance from the wall along the unloaded rod, over L, by α.
const REACH: [(f64, f64); 2] = [(1.0, 0.943_566_763_716_62), (10.0, 0.445_004_402_246_25)];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = vec![table(), circle(), astray()];
    for name in ["links_start", "links_start_stiff_wall", "links_middle", "sections"] {
        cases.push(small(name));
        cases.push(fitted(name));
    }
    for name in ["monomials", "modes", "hermite"] {
        cases.push(ritz_tip(name));
    }
    cases
}

/// The deflection under a small tip force over the exact one: Jᵀ K⁻¹ J by the exact tangent at rest, so that no term of second order is left.
pub(super) fn compliance(name: &str, n: usize) -> Result<f64, NoAnswer> {
    let (beam, tip) = systems::cantilever(&rod()?, &element(name, n)?).map_err(failed)?;
    let rest = beam.rest();
    let load = Load::force(tip.body, tip.placement.translation, [0.0, 1.0, 0.0]);
    // At rest the residual is −Jᵀ F.
    let force = -residual(&beam, &rest, &[load]).map_err(failed)?;
    let stiffness = tangent_stiffness(&beam, &rest, &[]).map_err(failed)?;
    let moved = stiffness.cholesky().ok_or_else(|| failed("K is not positive definite"))?.solve(&force);
    Ok(3.0 * force.dot(&moved))
}

/// The deflection of the tip under a dead force α.
pub(super) fn deflection(name: &str, n: usize, alpha: f64) -> Result<f64, NoAnswer> {
    let (beam, tip) = systems::cantilever(&rod()?, &element(name, n)?).map_err(failed)?;
    let load = Load::force(tip.body, tip.placement.translation, [0.0, alpha, 0.0]);
    let found = equilibrium(&beam, &[load], &Settings::default()).map_err(failed)?;
    if found.status != Status::Converged {
        return Err(failed(format!("the equilibrium at α = {alpha} is {:?}", found.status)));
    }
    Ok(beam.place(&found.s, &tip).map_err(failed)?.translation.y)
}

fn hinges(name: &str) -> Hinges {
    match name {
        "links_start" => Hinges::Start,
        "links_start_stiff_wall" => Hinges::StartStiffWall,
        _ => Hinges::Middle,
    }
}

/// Every n obeys the closed law.
fn small(name: &'static str) -> Case {
    case(
        "cantilever, small tip force",
        "small_deflection",
        name,
        json!({"counts": COUNTS}),
        vec![error("error", "closed form")],
        move || {
            let misses = COUNTS.iter().map(|&n| Ok(compliance(name, n)? / tip_ratio(hinges(name), n) - 1.0));
            Ok(vec![largest(misses.collect::<Result<Vec<f64>, NoAnswer>>()?)])
        },
    )
}

/// The law's order and prefactor: 3/2n, 1/2n², −1/4n².
fn fitted(name: &'static str) -> Case {
    let law = match hinges(name) {
        Hinges::Start => Law { order: 1.0, next: 2.0, prefactor: 1.5 },
        Hinges::StartStiffWall => Law { order: 2.0, next: 4.0, prefactor: 0.5 },
        Hinges::Middle => Law { order: 2.0, next: 4.0, prefactor: -0.25 },
    };
    // 3/2n has the slope 1 to 0.05 only where 1/2n² is below a twentieth of it.
    let counts = if law.order == 1.0 { [16, 24, 32, 48, 64] } else { COUNTS };
    case("cantilever, small tip force", "deflection_law", name, json!({"counts": counts}), Law::numbers(), move || {
        let errors = counts.iter().map(|&n| Ok((n as f64, compliance(name, n)? - 1.0)));
        Ok(law.fitted(&errors.collect::<Result<Vec<_>, NoAnswer>>()?))
    })
}

/// Shape functions: s² alone gives ¾ of the deflection. With s³ it is exact, and so it is of cubic splines; modes have 12 Σ 1/β⁴.
fn ritz_tip(name: &'static str) -> Case {
    case("cantilever, small tip force", "small_deflection", name, json!({"terms": 4}), vec![error("error", "closed form")], move || {
        let known = |r: usize| match name {
            "modes" => exact_modes_tip_ratio(r),
            "monomials" if r == 1 => 0.75,
            _ => 1.0,
        };
        let misses = (1..=4).map(|r| Ok(compliance(name, r)? / known(r) - 1.0));
        Ok(vec![largest(misses.collect::<Result<Vec<f64>, NoAnswer>>()?)])
    })
}

/// The closed form by elliptic integrals against the table.
fn table() -> Case {
    case("elastica", "elastica", "quadrature", json!({"table": TABLE, "reach": REACH}), vec![error("error", "table")], || {
        let of_deflection = TABLE.iter().map(|(alpha, due)| elastica(*alpha).deflection - due);
        let of_reach = REACH.iter().map(|(alpha, due)| elastica(*alpha).reach - due);
        Ok(vec![largest(of_deflection.chain(of_reach))])
    })
}

/// One element of constant curvature closes a circle under the end moment 2π EI/L.
fn circle() -> Case {
    case("circle, end moment", "closed_circle", "sections", json!({"elements": 1}), vec![error("error", "closed form")], || {
        let (beam, tip) = systems::cantilever(&rod()?, &element("sections", 1)?).map_err(failed)?;
        let found = equilibrium(&beam, &[Load::moment(tip.body, [0.0, 0.0, TAU])], &Settings::default()).map_err(failed)?;
        if found.status != Status::Converged {
            return Err(failed(format!("{:?}", found.status)));
        }
        let place = beam.place(&found.s, &tip).map_err(failed)?;
        Ok(vec![largest([place.translation.x, place.translation.y, found.s[0] - TAU])])
    })
}

/// Newton's method at α = 10 in one step, from the straight rod and from curled ones: what it finds beside the branch from rest is said to be so.
fn astray() -> Case {
    let numbers = vec![
        count("branch_converged", 1.0, "theory"),
        count("taken_for_the_branch", 0.0, "theory"),
        told("others_found", "1"),
        error("branch_error", "elastica"),
    ];
    case("elastica, α = 10", "equilibria", "links_middle", json!({"alpha": 10.0, "elements": 16, "starts": 9}), numbers, || {
        let (alpha, n) = (10.0, 16);
        let (beam, tip) = systems::cantilever(&rod()?, &element("links_middle", n)?).map_err(failed)?;
        let load = [Load::force(tip.body, tip.placement.translation, [0.0, alpha, 0.0])];
        let settings = Settings::default();
        let branch = equilibrium(&beam, &load, &settings).map_err(failed)?;
        let known = beam.place(&branch.s, &tip).map_err(failed)?.translation.y;
        let (mut mistaken, mut others) = (0, 0);
        for turns in -4..=4 {
            let from: Vec<f64> = vec![TAU * f64::from(turns) / n as f64 * 0.5; n];
            let found = newton(&beam, &from, &load, &settings).map_err(failed)?;
            let same = largest(found.s.iter().zip(&branch.s).map(|(a, b)| a - b)) < 1e-6;
            match found.status {
                Status::Converged if !same => mistaken += 1,
                Status::Unstable { .. } | Status::Spurious { .. } => others += 1,
                Status::Converged | Status::CapReached { .. } => {}
            }
        }
        let converged = f64::from(u8::from(branch.status == Status::Converged));
        // 16 links have −0.49/n² of the deflection: the coarse beam's own answer is on the right branch.
        Ok(vec![converged, f64::from(mistaken), f64::from(others), (known / elastica(alpha).deflection - 1.0).abs()])
    })
}
