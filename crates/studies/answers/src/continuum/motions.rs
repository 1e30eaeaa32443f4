//! Rods on bodies that move: momentum of a free hub and of a flying rod, and the limits of a heavy hub and of a stiff rod.

use super::{Case, NoAnswer, case, count, element, error, failed, largest, rod, told};
use featherbench_continua::{Load, Motion, Rod, energies, library, modes, momentum, rigid_limit};
use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
use featherbench_spatial::Vec3;
use serde_json::json;

/// The elements and how many of each.
const ELEMENTS: [(&str, usize); 3] = [("links_middle", 8), ("sections", 4), ("hermite", 3)];
/// Times the stiffness of a stiff rod.
const FACTORS: [f64; 4] = [1e3, 1e6, 1e9, 1e12];
/// What is asked of the stiff limit where rounding allows it.
const STIFF: f64 = 1e-10;
/// The factor from which it does, for these elements: the deflection is some 1e-1 over the factor.
const REACHED: f64 = 1e12;
/// Masses of hubs: the rod has the mass 1.
const HUBS: [f64; 3] = [1e2, 1e4, 1e6];

pub(super) fn cases() -> Vec<Case> {
    let of = |(name, n): (&'static str, usize)| {
        let stiff = FACTORS.into_iter().map(move |factor| stiff(name, n, factor, factor >= REACHED));
        [free(name, n), heavy(name, n)].into_iter().chain((name != "hermite").then(|| flying(name, n))).chain(stiff)
    };
    // Of many splines, rounding of K x alone is above the tolerance.
    ELEMENTS.into_iter().flat_map(of).chain([stiff("hermite", 16, REACHED, false)]).collect()
}

fn tolerance() -> Tolerance {
    Tolerance { absolute: 1e-11, relative: 1e-11, ..Tolerance::default() }
}

/// The momentum about the world's origin: [angular; linear].
fn about_origin(found: &featherbench_dynamics::CentroidalMomentum<f64>) -> [Vec3<f64>; 2] {
    let linear = found.momentum.lin;
    [found.momentum.ang + found.center.position.cross(linear), linear]
}

/// A rod on a free hub turns and swings: no force acts, and momentum and energy stay.
fn free(name: &'static str, n: usize) -> Case {
    let numbers = vec![error("momentum_drift", "conservation"), error("energy_drift", "conservation")];
    case("rod on a free hub", "momentum", name, json!({"elements": n, "time": 0.5}), numbers, move || {
        let (assembly, _) =
            library::on_free_hub(1.5, 0.3, &Rod::textbook(2.0, 0.5, 1.0).map_err(failed)?, &element(name, n)?).map_err(failed)?;
        let robot = assembly.build().map_err(failed)?;
        let topology = robot.topology();
        let (mut s, mut rate) = (robot.rest(), vec![0.0; topology.nv()]);
        for (k, rate) in rate.iter_mut().enumerate() {
            *rate = 0.3 * (12.9898 * (k as f64 + 1.0)).sin();
        }
        let state = |s: &[f64], rate: &[f64]| -> Result<([Vec3<f64>; 2], f64), NoAnswer> {
            let energy = energies(&robot, s, rate).map_err(failed)?;
            Ok((about_origin(&momentum(&robot, s, rate).map_err(failed)?), energy.kinetic + energy.potential))
        };
        let (before, energy) = state(&s, &rate)?;
        let mut motion = Motion::new(&robot, |_| Vec::new());
        DormandPrince::new(topology).run(&mut motion, [0.0, 0.5], &mut s, &mut rate, &tolerance(), |_, _, _| ()).map_err(failed)?;
        let (after, left) = state(&s, &rate)?;
        let moved = before.iter().zip(&after).flat_map(|(a, b)| (*b - *a).to_array());
        let size = largest(before.iter().flat_map(|part| part.to_array()));
        Ok(vec![largest(moved) / size, (left / energy - 1.0).abs()])
    })
}

/// A free rod with a force and a moment at one end, after Simo and Vu-Quoc (1986), with numbers of our own: its momentum is the impulse of the
/// loads, whatever the discretisation. The pulses are triangles: ∫ = ½.
fn flying(name: &'static str, n: usize) -> Case {
    let numbers = vec![error("momentum_error", "impulse"), error("angular_error", "impulse"), told("elastic_energy", "J")];
    case("flying rod", "momentum", name, json!({"elements": n, "bending": 100.0, "length": 10.0}), numbers, move || {
        let rod = Rod::textbook(100.0, 1.0, 10.0).map_err(failed)?;
        let (assembly, tip) = library::on_free_hub(0.1, 0.1, &rod, &element(name, n)?).map_err(failed)?;
        let robot = assembly.build().map_err(failed)?;
        let (force, moment) = ([8.0, 1.0, 0.5], [0.0, 0.0, -8.0]);
        let at_tip = Load { moment, ..Load::force(tip.body, tip.placement.translation, force) };
        let pulse = |t: f64| if t < 0.5 { 2.0 * t } else { 2.0 - 2.0 * t };
        let arm = |t: f64, s: &[f64]| -> Result<Vec3<f64>, NoAnswer> {
            let place = robot.place(s, &tip).map_err(failed)?.translation;
            Ok((Vec3::from_array(moment) + place.cross(Vec3::from_array(force))) * pulse(t))
        };
        let (mut s, mut rate) = (robot.rest(), vec![0.0; robot.topology().nv()]);
        let (mut motion, mut method) = (Motion::new(&robot, |t| vec![at_tip.times(pulse(t))]), DormandPrince::new(robot.topology()));
        // The impulse of the moments by Simpson's rule: its error is h⁴ = 1.6e-9 times fourth derivatives.
        let (steps, mut turned) = (160, Vec3::from_array([0.0; 3]));
        let h = 1.0 / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            let first = arm(t, &s)?;
            let mut to = |from: f64, to: f64, s: &mut [f64], rate: &mut [f64]| {
                method.run(&mut motion, [from, to], s, rate, &tolerance(), |_, _, _| ()).map_err(failed)
            };
            to(t, t + 0.5 * h, &mut s, &mut rate)?;
            let middle = arm(t + 0.5 * h, &s)?;
            to(t + 0.5 * h, t + h, &mut s, &mut rate)?;
            turned += (first + middle * 4.0 + arm(t + h, &s)?) * (h / 6.0);
        }
        let [angular, linear] = about_origin(&momentum(&robot, &s, &rate).map_err(failed)?);
        let impulse = Vec3::from_array(force) * 0.5;
        let relative = |found: Vec3<f64>, due: Vec3<f64>| largest((found - due).to_array()) / largest(due.to_array());
        let energy = energies(&robot, &s, &rate).map_err(failed)?.potential;
        Ok(vec![relative(linear, impulse), relative(angular, turned), energy])
    })
}

/// A heavy hub is a wall: the first frequency comes to that of the clamped rod like 1/mass.
fn heavy(name: &'static str, n: usize) -> Case {
    let numbers = vec![error("order_error", "theory"), error("clamped_error", "clamped rod"), told("order", "1")];
    case("rod on a heavy hub", "clamped_limit", name, json!({"elements": n, "masses": HUBS}), numbers, move || {
        let (clamped, _) = library::cantilever(&rod()?, &element(name, n)?).map_err(failed)?;
        let wall = modes(&clamped, &clamped.rest(), &[]).map_err(failed)?.frequencies()[0];
        let miss = |mass: f64| -> Result<(f64, f64), NoAnswer> {
            let (assembly, _) = library::on_free_hub(mass, mass, &rod()?, &element(name, n)?).map_err(failed)?;
            let robot = assembly.build().map_err(failed)?;
            let squares = modes(&robot, &robot.rest(), &[]).map_err(failed)?.squares;
            // Six free motions have ω² = 0 to rounding.
            let first = squares.iter().copied().find(|square| *square > 1e-3 * wall * wall).ok_or_else(|| failed("it has no frequency"))?;
            Ok((mass, first.sqrt() / wall - 1.0))
        };
        let misses = HUBS.into_iter().map(miss).collect::<Result<Vec<_>, _>>()?;
        let found = featherbench_continua::fit(&misses, 1.0, 2.0);
        Ok(vec![(found.order - 1.0).abs(), misses[HUBS.len() - 1].1.abs(), found.order])
    })
}

/// A stiff rod on a free hub with a body at its tip: the hub's accelerations beside those of the rigid tree.
///
/// Where the deflection or rounding of K x alone is above the tolerance, the tolerance is not due, and the number `within_reach` is 0.
/// This number must be what `reach` tells, so that no wide bound excuses a wrong answer.
fn stiff(name: &'static str, n: usize, factor: f64, reach: bool) -> Case {
    let numbers = vec![
        count("beyond_bound", 0.0, "theory"),
        told("difference", "1"),
        told("rounding", "1"),
        told("deflection", "1"),
        count("within_reach", f64::from(u8::from(reach)), "theory"),
    ];
    case(
        format!("stiff rod, n = {n}, {factor:e} times"),
        "stiff_limit",
        name,
        json!({"elements": n, "factor": factor}),
        numbers,
        move || {
            let (mut assembly, tip) = library::on_free_hub(1.0, 0.2, &rod()?, &element(name, n)?).map_err(failed)?;
            library::carry(&mut assembly, &tip, 0.5, 0.1);
            let (q, v) = ([0.1, 0.2, -0.3, 0.0, 0.0, 0.6, 0.8], [0.1, 0.2, 0.3, 0.4, -0.5, 0.6]);
            let limit = rigid_limit(&assembly, factor, &q, &v, &[1.0, -2.0, 0.5, 0.3, 0.7, -0.4]).map_err(failed)?;
            // The rod's own share, some units of its deflection, and what rounding of K x can do: K x alone is in `floor`, and a hundred such sums are
            // in M⁻¹. Where both are below it, the tolerance is due.
            let (share, rounding) = (20.0 * limit.deflection, 100.0 * limit.floor);
            let reach = share <= STIFF && rounding <= STIFF;
            let bound = if reach { STIFF } else { share + rounding };
            // NaN is beyond.
            let beyond = f64::from(u8::from(limit.difference.is_nan() || limit.difference > bound));
            Ok(vec![beyond, limit.difference, limit.floor, limit.deflection, f64::from(u8::from(reach))])
        },
    )
}
