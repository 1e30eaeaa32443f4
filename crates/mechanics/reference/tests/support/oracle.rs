//! Asks a program that follows the oracle protocol, version 1.

use super::{State, project};
use featherbench_model::Description;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The interpreter that `featherbench oracles install` makes, if it has what `module` names.
pub fn python(module: &str) -> Option<PathBuf> {
    let python = project().join("target/oracles/venv/bin/python");
    let import = Command::new(&python).args(["-c", &format!("import {module}")]).stderr(Stdio::null()).status();
    import.is_ok_and(|status| status.success()).then_some(python)
}

/// A module of the oracles' package, to be run by this interpreter.
pub fn module(python: &std::path::Path, name: &str) -> Command {
    let mut command = Command::new(python);
    command.args(["-P", "-m", &format!("featherbench_oracles.{name}")]).env("PYTHONPATH", project().join("oracles"));
    command
}

/// A running oracle.
pub struct Oracle {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Oracle {
    pub fn start(python: &std::path::Path, engine: &str) -> Self {
        let mut child = module(python, engine).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let (requests, answers) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        Self { child, requests, answers }
    }

    /// Sends one request with its blocks; returns the answer's header and the numbers of its only block.
    pub fn ask(&mut self, mut header: String, blocks: &[(&str, Vec<usize>, Vec<f64>)]) -> (Value, Vec<f64>) {
        let announced: Vec<Value> = blocks.iter().map(|(name, shape, _)| json!({"name": name, "shape": shape})).collect();
        header.truncate(header.trim_end_matches('}').len().max(1));
        let mut bytes = format!("{header},\"blocks\":{}}}\n", Value::from(announced)).into_bytes();
        blocks.iter().flat_map(|(_, _, numbers)| numbers).for_each(|x| bytes.extend(x.to_le_bytes()));
        self.requests.write_all(&bytes).unwrap();
        self.requests.flush().unwrap();
        let mut line = String::new();
        self.answers.read_line(&mut line).unwrap();
        let answer: Value = serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"));
        let count = |block: &Value| block["shape"].as_array().map_or(0, |shape| shape.iter().map(|n| n.as_u64().unwrap()).product());
        let numbers: u64 = answer["blocks"].as_array().map_or(0, |blocks| blocks.iter().map(count).sum());
        let mut data = vec![0; 8 * usize::try_from(numbers).unwrap()];
        self.answers.read_exact(&mut data).unwrap();
        (answer, data.chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect())
    }

    fn must(&mut self, header: String, blocks: &[(&str, Vec<usize>, Vec<f64>)]) -> (Value, Vec<f64>) {
        let (answer, numbers) = self.ask(header, blocks);
        assert_eq!(answer["status"], "ok", "{answer}");
        (answer, numbers)
    }

    /// The methods that it offers for a quantity.
    pub fn methods(&mut self, quantity: &str) -> Vec<String> {
        let (hello, _) = self.must(json!({"op": "hello"}).to_string(), &[]);
        hello["methods"][quantity]
            .as_array()
            .map_or(Vec::new(), |names| names.iter().map(|name| name.as_str().unwrap().to_owned()).collect())
    }

    /// Sends a robot and states; returns whether the oracle can build the robot.
    pub fn prepare(&mut self, description: &Description, states: &[State]) -> bool {
        // Written by hand: the description is text already.
        let request = format!("{{\"model\":{},\"op\":\"prepare\"", featherbench_formats::neutral::to_line(description).unwrap());
        if self.ask(request, &[]).0["status"] != "ok" {
            return false;
        }
        let (count, nq, nv, bodies) = (states.len(), description.nq(), description.nv(), description.bodies.len());
        let all = |pick: fn(&State) -> &Vec<f64>| states.iter().flat_map(|state| pick(state).clone()).collect::<Vec<_>>();
        let blocks = [
            ("q", vec![count, nq], all(|state| &state.q)),
            ("v", vec![count, nv], all(|state| &state.v)),
            ("a", vec![count, nv], all(|state| &state.a)),
            ("tau", vec![count, nv], all(|state| &state.tau)),
            ("wrench", vec![count, bodies, 6], vec![0.0; count * bodies * 6]),
            ("probe", vec![4, nv], vec![1.0; 4 * nv]),
        ];
        self.must(json!({"op": "states", "count": count}).to_string(), &blocks);
        true
    }

    /// A quantity at the first `count` states.
    pub fn evaluate(&mut self, quantity: &str, method: &str, count: usize) -> Vec<f64> {
        self.must(json!({"op": "evaluate", "quantity": quantity, "method": method, "first": 0, "count": count}).to_string(), &[]).1
    }
}

impl Drop for Oracle {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
