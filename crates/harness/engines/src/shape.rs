//! The shapes of blocks, as in the tables of `oracles/PROTOCOL.md`. Runs, the conformance test and native oracles all use them.

use featherbench_bench::{Quantity, Robot};
use featherbench_protocol::Message;

/// The shape of an answer about this number of states: `[count, …]`.
pub(crate) fn of_value(quantity: Quantity, robot: &Robot, count: usize) -> Vec<usize> {
    std::iter::once(count).chain(quantity.shape(robot)).collect()
}

/// The shape of the block `readback`.
pub(crate) fn of_readback(robot: &Robot) -> Vec<usize> {
    Quantity::Readback.shape(robot).collect()
}

/// The numbers of a block that must be there in this shape.
///
/// # Errors
/// A sentence that names the block, its shape and the expected one.
pub(crate) fn block<'a>(answer: &'a Message, name: &str, due: &[usize]) -> Result<&'a [f64], String> {
    let block = answer.block(name).ok_or_else(|| format!("the answer has no block '{name}'"))?;
    if block.shape != due {
        return Err(format!("block '{name}' has the shape {:?}; {due:?} is due", block.shape));
    }
    Ok(&block.data)
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_results::ModelOrigin;
    use featherbench_robots::Family;

    /// A robot for which nv, bodies and stored are all different, and none is a number of the tables.
    fn robot() -> Robot {
        let description = Family::parse("joints:kind=mixed,base=free").unwrap().generate().unwrap();
        Robot::new(&description, "joints", ModelOrigin::Generated, 2, 1).unwrap()
    }

    fn project(file: &str) -> String {
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").join(file)).unwrap()
    }

    /// The extents of a table's entry; words stand for the numbers of a robot.
    fn extents(words: &str, robot: &Robot) -> Vec<usize> {
        let (nv, bodies, stored) = (robot.states.nv, robot.description.bodies.len(), robot.model.topology.stored());
        assert!(nv != bodies && stored != nv && ![1, 3, 6, 12].iter().any(|n| [nv, bodies, stored].contains(n)), "{nv} {bodies} {stored}");
        let extent = |word: &str| match word {
            "nv" => nv,
            "bodies" => bodies,
            "stored" => stored,
            number => number.parse().unwrap_or_else(|_| panic!("'{number}' is no extent")),
        };
        words.split(',').map(|word| word.trim().trim_matches('"')).filter(|word| !word.is_empty()).map(extent).collect()
    }

    /// Authors of oracles use that page: its shapes must be those that runs and the conformance test expect.
    #[test]
    fn the_page_and_the_checks_agree_on_every_quantity() {
        let (page, robot) = (project("oracles/PROTOCOL.md"), robot());
        let (_, table) = page.split_once("| quantity | shape per state | meaning |").unwrap();
        let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
        let mut seen = Vec::new();
        for row in rows {
            let columns: Vec<&str> = row.split('|').map(str::trim).collect();
            let quantity = Quantity::parse(columns[1].trim_matches('`')).unwrap_or_else(|| panic!("{row}"));
            let due = [vec![5], extents(columns[2], &robot)].concat();
            assert_eq!(of_value(quantity, &robot, 5), due, "{row}");
            assert_eq!(due.iter().product::<usize>(), 5 * quantity.size(&robot), "{row}");
            seen.push(quantity);
        }
        // The read-back is among the requests; only our engine has single precision and second derivatives. The products of all bodies'
        // Jacobians are made of `body_jacobian`.
        let ours = |quantity: &Quantity| {
            matches!(quantity, Quantity::ForwardDynamicsSingle | Quantity::BodyJacobians) || Quantity::SECOND_DERIVATIVES.contains(quantity)
        };
        let asked = Quantity::ALL.into_iter().filter(|quantity| *quantity != Quantity::Readback && !ours(quantity));
        seen.sort_unstable();
        let mut due: Vec<Quantity> = asked.collect();
        due.sort_unstable();
        assert_eq!(seen, due, "every quantity stands on the page once");
        assert!(page.contains("block `readback` `[bodies, 22]`"));
        assert_eq!(of_readback(&robot), [robot.description.bodies.len(), 22]);
    }

    /// The shapes that our own oracles send.
    #[test]
    fn the_python_table_is_that_of_the_page() {
        let (text, robot) = (project("oracles/featherbench_oracles/core/protocol.py"), robot());
        let (_, table) = text.split_once("SHAPES: dict").unwrap();
        let rows: Vec<&str> = table.lines().skip(1).take_while(|line| !line.starts_with('}')).collect();
        assert!(rows.len() > 12);
        for row in rows {
            let (name, shape) = row.trim().trim_end_matches("),").split_once(": (").unwrap();
            let quantity = Quantity::parse(name.trim_matches('"')).unwrap_or_else(|| panic!("{row}"));
            assert_eq!(of_value(quantity, &robot, 5), [vec![5], extents(shape, &robot)].concat(), "{row}");
        }
    }

    #[test]
    fn a_block_of_another_shape_is_named_with_the_one_that_is_due() {
        let answer = Message::new(serde_json::json!({}), vec![featherbench_protocol::Block::new("value", &[2, 3], &[0.0; 6])]);
        assert_eq!(block(&answer, "value", &[2, 3]).unwrap().len(), 6);
        for due in [&[3, 2][..], &[6], &[2, 3, 1]] {
            assert!(block(&answer, "value", due).unwrap_err().contains("[2, 3]"));
        }
        assert!(block(&answer, "other", &[6]).unwrap_err().contains("no block 'other'"));
    }
}
