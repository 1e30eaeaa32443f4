//! Shapes to look at: the elastica under forces, modes, a gripper that closes, and an arm that falls with its cable.
//!
//! The last two are `soft_gripper.json` and `cable_arm.json` of `datasets/models/soft`. Each case is one shape; its numbers are points of the axis.

use super::{Case, NoAnswer, Number, case, count, element, error, failed, rod, told};
use featherbench_continua::examples::{cable_arm, gripper};
use featherbench_continua::{Assembly, Continuum, Load, Motion, Settings, Status, Tip, energies, equilibrium, library, modes};
use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
use serde_json::json;

/// The elements of a shape that is drawn.
const ELEMENTS: usize = 12;
/// Forces of the drawn elastica, F L²/EI.
const FORCES: [f64; 5] = [0.1, 1.0, 2.0, 5.0, 10.0];
/// Moments that close the gripper's fingers, N·m: tension of a tendon times its distance from the axis.
const MOMENTS: [f64; 5] = [0.0, 0.01, 0.02, 0.03, 0.04];
/// Times of the falling arm, s.
const TIMES: [f64; 5] = [0.0, 0.15, 0.3, 0.45, 0.6];

/// Names of the coordinates of points.
const POINTS: [[&str; 2]; 16] = [
    ["x_0", "y_0"],
    ["x_1", "y_1"],
    ["x_2", "y_2"],
    ["x_3", "y_3"],
    ["x_4", "y_4"],
    ["x_5", "y_5"],
    ["x_6", "y_6"],
    ["x_7", "y_7"],
    ["x_8", "y_8"],
    ["x_9", "y_9"],
    ["x_10", "y_10"],
    ["x_11", "y_11"],
    ["x_12", "y_12"],
    ["x_13", "y_13"],
    ["x_14", "y_14"],
    ["x_15", "y_15"],
];

pub(super) fn cases() -> Vec<Case> {
    let elastica = FORCES.into_iter().map(elastica);
    let modes = (0..3).map(mode);
    let fingers = MOMENTS.into_iter().flat_map(|moment| ["left", "right"].map(|finger| closing(finger, moment)));
    let arm = TIMES.into_iter().map(falling);
    elastica.chain(modes).chain(fingers).chain(arm).collect()
}

/// The numbers of so many points, with the judged number before.
fn points(first: Number, count: usize) -> Vec<Number> {
    std::iter::once(first).chain(POINTS.iter().take(count).flatten().map(|metric| told(metric, "m"))).collect()
}

/// The root and the end of each section of a rod, in two of the world's axes.
fn axis(robot: &Continuum, assembly: &Assembly, s: &[f64], rod: &str, axes: [usize; 2]) -> Result<Vec<f64>, NoAnswer> {
    let places = robot.shape(s).map_err(failed)?;
    let (prefix, bodies) = (format!("{rod}."), &assembly.description().bodies);
    let own: Vec<usize> =
        (0..bodies.len()).filter(|k| bodies[*k].name.starts_with(&prefix) && !bodies[*k].name.contains("carried")).collect();
    // Each section has its Gauss points and its end, in this order.
    let each = own.len() / ELEMENTS;
    let ends = own.iter().skip(each - 1).step_by(each);
    let at = |point: [f64; 3]| axes.map(|axis| point[axis]);
    Ok(ends.flat_map(|body| at(places[*body].translation.to_array())).collect())
}

/// A cantilever of sections with its assembly, which knows the names of its bodies.
fn cantilever() -> Result<(Assembly, Continuum, Tip), NoAnswer> {
    let mut assembly = Assembly::new(Default::default());
    let tip = assembly.attach("rod", &rod()?, &element("sections", ELEMENTS)?, None, Default::default()).map_err(failed)?;
    let beam = assembly.clone().build().map_err(failed)?;
    Ok((assembly, beam, tip))
}

fn elastica(alpha: f64) -> Case {
    let numbers = points(count("converged", 1.0, "theory"), ELEMENTS + 1);
    case(format!("elastica, α = {alpha}"), "shape", "sections", json!({"alpha": alpha}), numbers, move || {
        let (assembly, beam, tip) = cantilever()?;
        let load = Load::force(tip.body, tip.placement.translation, [0.0, alpha, 0.0]);
        let found = equilibrium(&beam, &[load], &Settings::default()).map_err(failed)?;
        let mut values = vec![f64::from(u8::from(found.status == Status::Converged)), 0.0, 0.0];
        values.extend(axis(&beam, &assembly, &found.s, "rod", [0, 1])?);
        Ok(values)
    })
}

/// A mode with the tip's deflection 0.2 of the length; the first number is its frequency's share of the exact one.
fn mode(k: usize) -> Case {
    let numbers = points(told("frequency", "rad/s"), ELEMENTS + 1);
    case(format!("mode {}", k + 1), "shape", "sections", json!({"mode": k}), numbers, move || {
        let (beam, tip) = library::cantilever(&rod()?, &element("sections", ELEMENTS)?).map_err(failed)?;
        let found = modes(&beam, &beam.rest(), &[]).map_err(failed)?;
        let (assembly, named, _) = cantilever()?;
        let small: Vec<f64> = found.shapes.column(k).iter().map(|x| 1e-4 * x).collect();
        let end = beam.place(&small, &tip).map_err(failed)?.translation.y;
        let mut values = vec![found.frequencies()[k], 0.0, 0.0];
        let drawn = axis(&named, &assembly, &small, "rod", [0, 1])?;
        values.extend(drawn.chunks_exact(2).flat_map(|point| [point[0], 0.2 * point[1] / end]));
        Ok(values)
    })
}

/// A finger of the gripper under its weight and a moment at its tip, with the wrist held.
fn closing(finger: &'static str, moment: f64) -> Case {
    let numbers = points(count("converged", 1.0, "theory"), ELEMENTS + 1);
    let params = json!({"finger": finger, "moment": moment});
    case(format!("gripper, {finger} finger, {moment} N·m"), "shape", "sections", params, numbers, move || {
        let description = gripper();
        let (assembly, tips) = Assembly::of(&description).map_err(failed)?;
        let robot = assembly.clone().build().map_err(failed)?;
        // The tendon bends the left finger to the right, and the right one to the left: about −y and y.
        let loads = [Load::moment(tips[0].body, [0.0, -moment, 0.0]), Load::moment(tips[1].body, [0.0, moment, 0.0])];
        let settings = Settings { held: vec![0], ..Settings::default() };
        let found = equilibrium(&robot, &loads, &settings).map_err(failed)?;
        let root = description.continua.iter().find(|continuum| continuum.name == finger).map(|continuum| continuum.placement.translation);
        let root = root.ok_or_else(|| failed("the gripper has no such finger"))?;
        let mut values = vec![f64::from(u8::from(found.status == Status::Converged)), root[0], root[2]];
        values.extend(axis(&robot, &assembly, &found.s, finger, [0, 2])?);
        Ok(values)
    })
}

/// The arm after a time of falling from where it is level and its cable hangs: shoulder, elbow, end, and the joints of the cable.
fn falling(time: f64) -> Case {
    let numbers = points(error("energy_drift", "conservation"), 3 + ELEMENTS);
    case(format!("arm with cable, {time} s"), "shape", "string_links", json!({"time": time}), numbers, move || {
        let (assembly, tips) = Assembly::of(&cable_arm()).map_err(failed)?;
        let robot = assembly.build().map_err(failed)?;
        let (mut s, mut rate) = (robot.rest(), vec![0.0; robot.topology().nv()]);
        let total = |s: &[f64], rate: &[f64]| energies(&robot, s, rate).map(|e| e.kinetic + e.potential).map_err(failed);
        let first = total(&s, &rate)?;
        let tolerance = Tolerance { absolute: 1e-10, relative: 1e-10, ..Tolerance::default() };
        let mut motion = Motion::new(&robot, |_| Vec::new());
        if time > 0.0 {
            DormandPrince::new(robot.topology())
                .run(&mut motion, [0.0, time], &mut s, &mut rate, &tolerance, |_, _, _| ())
                .map_err(failed)?;
        }
        let places = robot.shape(&s).map_err(failed)?;
        let kinetic = energies(&robot, &s, &rate).map_err(failed)?.kinetic;
        let scale = if kinetic > 1.0 { kinetic } else { 1.0 };
        let mut values = vec![(total(&s, &rate)? - first).abs() / scale];
        // Bodies are the links of the arm, then those of the cable, each at its joint; then the load.
        let joints = places.iter().take(2 + ELEMENTS).map(|place| place.translation);
        values.extend(joints.flat_map(|point| [point.x, point.z]));
        let end = robot.place(&s, &tips[0]).map_err(failed)?.translation;
        values.extend([end.x, end.z]);
        Ok(values)
    })
}
