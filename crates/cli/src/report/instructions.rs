//! Instruction counts, as `ci/instructions.py --out` writes them.

use crate::fail::Fail;
use featherbench_speed::InstructionCounts;
use std::path::Path;

/// Reads them.
pub fn read(path: &Path) -> Result<InstructionCounts, Fail> {
    let failed = |what: String| Fail::input(format!("{}: {what}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    let mut counts = InstructionCounts::new();
    for (number, line) in text.lines().enumerate().skip(1) {
        let mut fields = line.rsplitn(4, ',');
        let (Some(count), Some(model), Some(kernel)) = (fields.next(), fields.next(), fields.next()) else {
            return Err(failed(format!("line {} is not rustc,kernel,model,instructions", number + 1)));
        };
        let parsed = count.parse().map_err(|_| failed(format!("line {}: '{count}' is no count of instructions", number + 1)))?;
        counts.insert((kernel.to_owned(), model.to_owned()), parsed);
    }
    Ok(counts)
}
