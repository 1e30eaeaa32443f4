//! A robot as URDF, the only form that dynibo reads.

use dynibo::RobotModel;
use featherbench_interface::{Body, JOINTS, Refusal};
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The link of the world, which a robot with a fixed base hangs on.
pub const WORLD: &str = "world";

/// The name of the link of a body.
pub fn link(body: usize) -> String {
    format!("b{body}")
}

/// The name of the joint that carries a body.
pub fn joint(body: usize) -> String {
    format!("j{body}")
}

/// Whether the first body floats.
pub fn floats(bodies: &[Body]) -> bool {
    bodies.first().is_some_and(|body| JOINTS.get(body.joint as usize) == Some(&"free"))
}

/// A robot, read by dynibo. With `apart` each joint hangs on the world: so its placement can be read back.
pub fn model(bodies: &[Body], apart: bool) -> Result<RobotModel, Refusal> {
    let mut text = String::from("<robot name=\"robot\">\n");
    let floats = floats(bodies);
    if apart || !floats {
        let _ = writeln!(text, "<link name=\"{WORLD}\"/>");
    }
    for (k, body) in bodies.iter().enumerate() {
        if k == 0 && floats && apart {
            continue;
        }
        let [xx, xy, xz, yy, yz, zz] = body.inertia;
        let _ = write!(text, "<link name=\"{}\"><inertial><origin xyz=\"{}\" rpy=\"0 0 0\"/>", link(k), three(body.com));
        let _ = write!(text, "<mass value=\"{:e}\"/><inertia ixx=\"{xx:e}\" ixy=\"{xy:e}\" ixz=\"{xz:e}\" ", body.mass);
        let _ = writeln!(text, "iyy=\"{yy:e}\" iyz=\"{yz:e}\" izz=\"{zz:e}\"/></inertial></link>");
        if k == 0 && floats {
            continue;
        }
        let parent = usize::try_from(body.parent).ok().filter(|_| !apart).map_or_else(|| WORLD.to_owned(), link);
        // The widest limits that it takes: they are not used here.
        let (kind, limit) = match JOINTS.get(body.joint as usize) {
            Some(&"revolute") => ("continuous", ""),
            Some(&"prismatic") => ("prismatic", "<limit lower=\"-1e300\" upper=\"1e300\" effort=\"1e300\" velocity=\"1e300\"/>"),
            other => return Err(Refusal::Unsupported(format!("dynibo has no {} joint", other.unwrap_or(&"such")))),
        };
        let [x, y, z] = roll_pitch_yaw(&body.rotation);
        let _ = write!(text, "<joint name=\"{}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{}\"/>", joint(k), link(k));
        let _ = write!(text, "<origin xyz=\"{}\" rpy=\"{x:e} {y:e} {z:e}\"/>", three(body.translation));
        let _ = writeln!(text, "<axis xyz=\"{}\"/>{limit}</joint>", three(body.axis));
    }
    text.push_str("</robot>\n");
    read(&text)
}

/// Dynibo reads files only.
fn read(text: &str) -> Result<RobotModel, Refusal> {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let name = format!("featherbench-dynibo-{}-{}.urdf", std::process::id(), FILES.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, text).map_err(|error| Refusal::Failed(format!("{}: {error}", path.display())))?;
    let model = RobotModel::from_urdf(&path);
    let _ = std::fs::remove_file(&path);
    // What is written here is a tree with finite numbers: a complaint is about the bodies.
    model.map_err(|error| Refusal::Unsupported(format!("dynibo refuses the model: {error}")))
}

fn three([x, y, z]: [f64; 3]) -> String {
    format!("{x:e} {y:e} {z:e}")
}

/// Angles with R = Rz(yaw) Ry(pitch) Rx(roll), of a row-major R. Roll and pitch are taken from Rz(yaw)ᵀR, so that none loses digits where the
/// pitch is near ±90°.
fn roll_pitch_yaw(r: &[f64; 9]) -> [f64; 3] {
    let yaw = r[3].atan2(r[0]);
    let (s, c) = yaw.sin_cos();
    let pitch = (-r[6]).atan2(c * r[0] + s * r[3]);
    let roll = (s * r[2] - c * r[5]).atan2(c * r[4] - s * r[1]);
    [roll, pitch, yaw]
}
