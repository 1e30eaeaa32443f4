//! §9: the Java lab's graph of links and joints accepts anything, and has no loops.
//!
//! loops = joints − moving links. Grübler: mobility = Σ freedom − d·loops, d = 3 in a plane and 6 in space; the truth is dofs − rank J.

use crate::claim::{Claim, Failure, Holds, Number};
use featherbench_constrained::systems::{Bricard, Ladder};
use featherbench_constrained::{BadGraph, Edge, Graph, Mobility};

fn hinge(name: &str, parent: Option<usize>, child: Option<usize>, cut: bool) -> Edge {
    Edge { name: name.into(), parent, child, freedom: 1, cut }
}

fn links(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn four_bar() -> Result<Graph, BadGraph> {
    let joints = vec![
        hinge("a", None, Some(0), false),
        hinge("b", Some(0), Some(1), false),
        hinge("d", None, Some(2), false),
        hinge("c", Some(2), Some(1), true),
    ];
    Graph::new(links(&["crank", "coupler", "rocker"]), joints)
}

/// What is wrong, what the graph says, and whether that is the error that is due.
type Malformed = (&'static str, Result<Graph, BadGraph>, fn(&BadGraph) -> bool);

/// Graphs that are no robot, each with the error that is due.
fn malformed() -> [Malformed; 5] {
    let two = || links(&["one", "two"]);
    [
        (
            "an orphan",
            Graph::new(two(), vec![hinge("a", None, Some(0), false)]),
            |bad| matches!(bad, BadGraph::Orphan { link } if link == "two"),
        ),
        (
            "two parents",
            Graph::new(
                two(),
                vec![hinge("a", None, Some(0), false), hinge("b", None, Some(1), false), hinge("c", Some(0), Some(1), false)],
            ),
            |bad| matches!(bad, BadGraph::TwoParents { link, .. } if link == "two"),
        ),
        (
            "a cycle without a cut",
            Graph::new(two(), vec![hinge("a", Some(1), Some(0), false), hinge("b", Some(0), Some(1), false)]),
            |bad| matches!(bad, BadGraph::CycleWithoutCut { links } if links.len() == 2),
        ),
        (
            "a link that does not exist",
            Graph::new(two(), vec![hinge("a", None, Some(0), false), hinge("b", Some(0), Some(7), false)]),
            |bad| matches!(bad, BadGraph::NoLink { joint, link: 7, .. } if joint == "b"),
        ),
        (
            "a name twice",
            Graph::new(links(&["one", "one"]), vec![hinge("a", None, Some(0), false), hinge("b", Some(0), Some(1), false)]),
            |bad| matches!(bad, BadGraph::DuplicateName { name } if name == "one"),
        ),
    ]
}

fn numbers() -> Result<Vec<Number>, Failure> {
    let four = four_bar()?;
    let (one, two) = (Ladder::default(), Ladder { windows: 2, ..Ladder::default() });
    let bricard = Bricard::default().mechanism()?;
    let freedom = |mechanism: &featherbench_constrained::Mechanism, q: &[f64]| -> Result<f64, Failure> {
        Ok(Mobility::at(&mechanism.model, &mechanism.constraints, q).map_err(Failure::of)?.freedom() as f64)
    };
    let counted = |name: &str, graph: &Graph, motion: usize| (format!("Grübler's count, {name}"), graph.gruebler(motion) as f64);
    let mut numbers = vec![
        Number::count("loops, four-bar", four.loops(), four.joints().len() - four.links().len()),
        Number::count("joints of the spanning tree, four-bar", four.tree().len(), four.links().len()),
        Number::count("joints of its cycle", four.cycles()[0].joints.len(), 4),
    ];
    // The truth by the rank of J, where no bar is on a line with another.
    for (name, ladder) in [("four-bar", one), ("two windows", two)] {
        let mechanism = ladder.mechanism()?;
        let (name, count) = counted(name, &mechanism.graph, 3);
        numbers.push(Number::new(name, "1", count, freedom(&mechanism, &ladder.spread(0.5))?));
    }
    let (name, count) = counted("Bricard's ring", &bricard.graph, 6);
    // By hand: six hinges in one loop.
    let (hinges, loops) = (6.0, 1.0);
    numbers.push(Number::new(name, "1", count, hinges - 6.0 * loops));
    numbers.push(Number::new("true mobility, Bricard's ring", "1", freedom(&bricard, &[0.0; 5])?, 1.0));
    for (name, result, due) in malformed() {
        let refused = usize::from(result.as_ref().err().is_some_and(due));
        numbers.push(Number::count(format!("refused by name: {name}"), refused, 1).stated(0.0, -1.0));
    }
    Ok(numbers)
}

/// The lab in Java.
pub(super) const CLAIM: Claim = Claim {
    id: "robot_graph",
    place: "§9",
    title: "A robot as a graph",
    says: "Lists of links and joints are a model of any robot; nothing is checked.",
    right: "Orphans, second parents, cycles without a cut, bad indices and double names are refused by name. loops = joints − moving links.",
    holds: Holds::No,
    numbers: |_| numbers(),
};
