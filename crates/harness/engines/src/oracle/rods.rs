//! Elastic rods of the engine behind an oracle: the operation `rod`.

use super::{Oracle, shaped, told_time};
use featherbench_bench::{NoAnswer, RodAnswer, RodQuestion, RodSolver};
use featherbench_protocol::{Block, Message};
use serde_json::{Value, json};

impl RodSolver for Oracle {
    fn rod_elements(&self) -> Vec<String> {
        self.hello.rods.clone()
    }

    fn rod(&self, question: &RodQuestion, element: &str) -> Result<RodAnswer, NoAnswer> {
        let (header, blocks) = request(question, element);
        read(&self.session()?.ask(header, blocks)?, question)
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
    let (nanoseconds, preparation) = (told_time(answer, "nanoseconds")?, told_time(answer, "preparation")?);
    Ok(RodAnswer { tips: tips.chunks_exact(2).map(|tip| [tip[0], tip[1]]).collect(), frequencies, nanoseconds, preparation })
}
