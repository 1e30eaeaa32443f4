//! Elastic rods of the engine behind an oracle: the operation `rod`.

use super::{Oracle, shaped};
use featherbench_bench::{NoAnswer, RodAnswer, RodQuestion, RodSolver};
use featherbench_protocol::{Block, Message};
use serde_json::{Value, json};

impl RodSolver for Oracle {
    fn rod_elements(&self) -> Vec<String> {
        self.rods.clone()
    }

    fn rod(&self, question: &RodQuestion, element: &str) -> Result<RodAnswer, NoAnswer> {
        let mut session = self.session()?;
        let (header, blocks) = request(question, element);
        let answer = session.ask(header, blocks).and_then(|answer| read(&answer, question));
        self.give_back(session);
        answer
    }
}

/// The question as a message.
pub(crate) fn request(question: &RodQuestion, element: &str) -> (Value, Vec<Block>) {
    let RodQuestion { count, length, bending, mass_per_length, forces } = question;
    let header =
        json!({"op": "rod", "method": element, "count": count, "length": length, "bending": bending, "mass_per_length": mass_per_length});
    (header, vec![Block::new("forces", &[forces.len()], forces)])
}

/// The answer in its shape.
pub(crate) fn read(answer: &Message, question: &RodQuestion) -> Result<RodAnswer, NoAnswer> {
    let tips = shaped(answer, "tips", &[question.forces.len(), 2])?;
    let frequencies = shaped(answer, "frequencies", &[question.count.min(3)])?;
    let time = |field: &str| {
        let time = answer.header.get(field).and_then(Value::as_f64).filter(|time| time.is_finite() && *time >= 0.0);
        time.ok_or_else(|| NoAnswer::Failed(format!("the oracle's answer has no {field}")))
    };
    let (nanoseconds, preparation) = (time("nanoseconds")?, time("preparation")?);
    Ok(RodAnswer { tips: tips.chunks_exact(2).map(|tip| [tip[0], tip[1]]).collect(), frequencies, nanoseconds, preparation })
}
