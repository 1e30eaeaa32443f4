//! Robots with loops, held by the engine behind an oracle: the operations `loops`, `loop_accelerations` and `loop_motion`.

use super::{Oracle, Session, own_time, shaped, sized};
use featherbench_bench::{LoopAccelerations, LoopDrive, LoopMotion, LoopSolver, LoopStates, LoopSteps, NoAnswer};
use featherbench_model::Description;
use featherbench_protocol::{Block, Message};
use serde::Deserialize;
use serde_json::{Value, json};
use std::time::Duration;

/// The part of `hello` about loops.
#[derive(Clone, Debug, PartialEq, Default, Deserialize)]
pub(crate) struct Loops {
    /// Methods of accelerations.
    pub(crate) accelerations: Vec<String>,
    /// Methods of motions.
    pub(crate) motions: Vec<String>,
}

impl Oracle {
    /// One question about a robot with loops.
    fn held(&self, robot: &Description, drive: Option<&LoopDrive>, header: Value, blocks: Vec<Block>) -> Result<Message, NoAnswer> {
        let prepare = request(robot, drive)?;
        let mut session = self.session()?;
        build(session.open()?, robot, drive.is_some(), prepare)?;
        session.ask(header, blocks)
    }
}

/// The request that builds a robot.
fn request(robot: &Description, drive: Option<&LoopDrive>) -> Result<Value, NoAnswer> {
    let mut request = json!({"op": "loops", "model": model(robot)?});
    if let Some(LoopDrive { tau, springs }) = drive {
        let end =
            |body: Option<usize>, point: [f64; 3]| json!({"body": body.map_or_else(|| json!(-1), |body| json!(body)), "point": point});
        let springs = springs.iter().map(|spring| {
            let [first, second] = [0, 1].map(|side| end(spring.bodies[side], spring.points[side]));
            json!({"first": first, "second": second, "stiffness": spring.stiffness, "length": spring.length})
        });
        request["drive"] = json!({"tau": tau, "springs": springs.collect::<Vec<_>>()});
    }
    Ok(request)
}

/// Lets the engine build the robot.
fn build(session: &mut Session, robot: &Description, driven: bool, request: Value) -> Result<(), NoAnswer> {
    let answer = session.ask(request, Vec::new())?;
    // An oracle leaves out what it does not know, and without its drive a robot is another one.
    if driven && answer.header.get("driven") != Some(&Value::Bool(true)) {
        return Err(NoAnswer::NotOffered("the oracle takes no springs and constant forces".into()));
    }
    sized(&answer, robot.nq(), robot.nv())?;
    // Without its loops a robot is another one.
    let held = answer.header.get("held").and_then(Value::as_object).map_or(0, serde_json::Map::len);
    if held != robot.loops.len() {
        return Err(NoAnswer::Failed(format!("the engine holds {held} loops, the robot has {}", robot.loops.len())));
    }
    Ok(())
}

/// The robot with its loops in the form of the protocol.
pub(crate) fn model(robot: &Description) -> Result<Value, NoAnswer> {
    let line = featherbench_formats::neutral::to_line_with_loops(robot).map_err(|error| NoAnswer::Failed(error.to_string()))?;
    serde_json::from_str(&line).map_err(|error| NoAnswer::Failed(error.to_string()))
}

/// The engine's own time, and its settings.
pub(crate) fn told(answer: &Message) -> Result<(Duration, Value), NoAnswer> {
    let time = own_time(answer)?;
    let settings = answer.header.get("settings").filter(|settings| settings.is_object());
    let settings = settings.ok_or_else(|| NoAnswer::Failed("the oracle's answer has no settings".into()))?;
    Ok((time, settings.clone()))
}

impl LoopSolver for Oracle {
    fn acceleration_methods(&self) -> Vec<String> {
        self.hello.loops.as_ref().map(|loops| loops.accelerations.clone()).unwrap_or_default()
    }

    fn motion_methods(&self) -> Vec<String> {
        self.hello.loops.as_ref().map(|loops| loops.motions.clone()).unwrap_or_default()
    }

    fn loop_accelerations(
        &self,
        robot: &Description,
        method: &str,
        states: &LoopStates,
        repeats: usize,
    ) -> Result<LoopAccelerations, NoAnswer> {
        let LoopStates { count, q, v, tau } = states;
        let blocks = vec![
            Block::new("q", &[*count, robot.nq()], q),
            Block::new("v", &[*count, robot.nv()], v),
            Block::new("tau", &[*count, robot.nv()], tau),
        ];
        let header = json!({"op": "loop_accelerations", "method": method, "count": count, "repeats": repeats});
        let answer = self.held(robot, None, header, blocks)?;
        let (time, settings) = told(&answer)?;
        Ok(LoopAccelerations { acceleration: shaped(&answer, "acceleration", &[*count, robot.nv()])?, time, settings })
    }

    fn loop_motion(
        &self,
        robot: &Description,
        drive: Option<&LoopDrive>,
        method: &str,
        (q, v): (&[f64], &[f64]),
        steps: LoopSteps,
    ) -> Result<LoopMotion, NoAnswer> {
        let LoopSteps { dt, steps, every } = steps;
        let records = steps.checked_div(every).unwrap_or_default();
        let blocks = vec![Block::new("q", &[robot.nq()], q), Block::new("v", &[robot.nv()], v)];
        let header = json!({"op": "loop_motion", "method": method, "dt": dt, "steps": steps, "every": every});
        let answer = self.held(robot, drive, header, blocks)?;
        let (time, settings) = told(&answer)?;
        let block = |name: &str, numbers: usize| shaped(&answer, name, &[records, numbers]);
        Ok(LoopMotion { q: block("q", robot.nq())?, v: block("v", robot.nv())?, time, settings })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_bench::LoopSpring;
    use featherbench_model::{BodyDescription, JointDescription, JointType};

    /// The world is −1, and without a drive the request has none.
    #[test]
    fn a_drive_is_written_as_the_protocol_says() {
        let spring = LoopSpring { bodies: [Some(2), None], points: [[1.0, 2.0, 3.0], [0.0; 3]], stiffness: 5.0, length: 0.5 };
        let drive = LoopDrive { tau: vec![1.0, 0.0], springs: vec![spring] };
        let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 0.0, 1.0] }, ..JointDescription::default() };
        let inertia = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];
        let body = BodyDescription { name: "one".into(), parent: None, mass: 1.0, com: [0.0; 3], inertia, joint };
        let robot = Description { name: "one".into(), bodies: vec![body], ..Description::default() };
        let written = request(&robot, Some(&drive)).unwrap();
        let due = json!({"first": {"body": 2, "point": [1.0, 2.0, 3.0]}, "second": {"body": -1, "point": [0.0, 0.0, 0.0]}, "stiffness": 5.0, "length": 0.5});
        assert_eq!(written["drive"], json!({"tau": [1.0, 0.0], "springs": [due]}));
        assert!(request(&robot, None).unwrap().get("drive").is_none());
    }
}
