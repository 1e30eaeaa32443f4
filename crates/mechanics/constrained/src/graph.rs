//! A robot as a graph: links and joints with loops.
//!
//! Links are vertices, the world among them; joints are edges. The joints that are not cut form the spanning tree: each link has one of
//! them as its parent, and every chain of parents ends at the world. Each cut joint closes one *fundamental cycle*: itself, and the tree's
//! paths from its two ends to where they meet. So loops = joints − moving links.
//!
//! Grübler's count assumes that all rows of all loops are independent. The truth is [`Mobility`](crate::Mobility).
//! Source: the book, section 4.1 (connectivity graphs, spanning trees) and 8.1. Cost: O(n) for the tree, O(depth) per cycle.

use std::collections::BTreeSet;
use thiserror::Error;

/// A joint between two links.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The joint's name.
    pub name: String,
    /// The link on which it is, `None` for the world.
    pub parent: Option<usize>,
    /// The link that it moves, `None` for the world.
    pub child: Option<usize>,
    /// Its degrees of freedom.
    pub freedom: usize,
    /// Whether the tree does without it.
    pub cut: bool,
}

/// A cut joint with the path through the tree that it closes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// The cut joint.
    pub cut: usize,
    /// The links, from the child of the cut joint through the tree to its parent; `None` is the world.
    pub links: Vec<Option<usize>>,
    /// The joints: those of the path in the same order, and the cut joint last.
    pub joints: Vec<usize>,
}

/// Why links and joints are no robot.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadGraph {
    /// A joint at a link that does not exist.
    #[error("joint '{joint}' names link {link}, but there are {links} links, counted from 0")]
    NoLink {
        /// The joint.
        joint: String,
        /// The link named.
        link: usize,
        /// How many there are.
        links: usize,
    },
    /// A joint from a link to itself.
    #[error("joint '{joint}' connects a link with itself")]
    SelfLoop {
        /// The joint.
        joint: String,
    },
    /// A joint with more than six degrees of freedom.
    #[error("joint '{joint}' has {freedom} degrees of freedom; a joint has six at most")]
    Freedom {
        /// The joint.
        joint: String,
        /// What it was given.
        freedom: usize,
    },
    /// Two links, or two joints, share a name.
    #[error("two links or two joints are named '{name}'; names must be unique")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A link that no joint moves.
    #[error("link '{link}' is an orphan: no joint of the tree moves it; give it a joint to its parent, or one to the world")]
    Orphan {
        /// The link.
        link: String,
    },
    /// A link that two joints of the tree move.
    #[error("link '{link}' has two parents: the joints '{first}' and '{second}' move it; cut one of them")]
    TwoParents {
        /// The link.
        link: String,
        /// One joint.
        first: String,
        /// The other.
        second: String,
    },
    /// Joints of the tree that lead back to where they came from.
    #[error("the joints of {} form a cycle without a cut; cut one of them", links.join(", "))]
    CycleWithoutCut {
        /// The links of the cycle.
        links: Vec<String>,
    },
}

/// A connected graph of links and joints with a spanning tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    links: Vec<String>,
    joints: Vec<Edge>,
    /// The joint of the tree that moves each link.
    moved_by: Vec<usize>,
}

impl Graph {
    /// The graph of these links and joints. The world is no link of the list.
    ///
    /// # Errors
    /// [`BadGraph`], which names the link or joint.
    ///
    /// ```
    /// use featherbench_constrained::{Edge, Graph};
    /// // Four-bar: two cranks on the world, a coupler on the first, and a cut hinge between coupler and second crank.
    /// let hinge = |name: &str, parent, child, cut| Edge { name: name.into(), parent, child, freedom: 1, cut };
    /// let links = ["crank", "coupler", "rocker"].map(String::from).to_vec();
    /// let joints = vec![
    ///     hinge("a", None, Some(0), false),
    ///     hinge("b", Some(0), Some(1), false),
    ///     hinge("d", None, Some(2), false),
    ///     hinge("c", Some(2), Some(1), true),
    /// ];
    /// let four_bar = Graph::new(links, joints)?;
    /// assert_eq!((four_bar.loops(), four_bar.gruebler(3), four_bar.gruebler(6)), (1, 1, -2));
    /// assert_eq!(four_bar.cycles()[0].joints, [1, 0, 2, 3]);
    /// # Ok::<(), featherbench_constrained::BadGraph>(())
    /// ```
    pub fn new(links: Vec<String>, joints: Vec<Edge>) -> Result<Self, BadGraph> {
        expect_unique(links.iter())?;
        expect_unique(joints.iter().map(|joint| &joint.name))?;
        for joint in &joints {
            let name = || joint.name.clone();
            if let Some(link) = [joint.parent, joint.child].into_iter().flatten().find(|link| *link >= links.len()) {
                return Err(BadGraph::NoLink { joint: name(), link, links: links.len() });
            }
            if joint.parent == joint.child {
                return Err(BadGraph::SelfLoop { joint: name() });
            }
            if joint.freedom > 6 {
                return Err(BadGraph::Freedom { joint: name(), freedom: joint.freedom });
            }
        }
        let mut moved_by: Vec<Option<usize>> = vec![None; links.len()];
        let mut into_world = None;
        for (k, joint) in joints.iter().enumerate().filter(|(_, joint)| !joint.cut) {
            match joint.child {
                Some(child) => match moved_by[child].replace(k) {
                    Some(other) => {
                        let (first, second) = (joints[other].name.clone(), joint.name.clone());
                        return Err(BadGraph::TwoParents { link: links[child].clone(), first, second });
                    }
                    None => continue,
                },
                None => into_world = into_world.or(Some(k)),
            }
        }
        let parent = |link: usize| moved_by[link].and_then(|joint| joints[joint].parent);
        // A joint of the tree that moves the world closes the path from its parent to the world.
        if let Some(start) = into_world.and_then(|joint| joints[joint].parent) {
            let path = path_to_root(start, parent);
            return Err(BadGraph::CycleWithoutCut { links: path.into_iter().map(|link| links[link].clone()).collect() });
        }
        // 0: not yet seen; k + 1: on the path from link k; done: its chain ends at the world.
        let done = links.len() + 1;
        let mut seen = vec![0; links.len()];
        for start in 0..links.len() {
            let (mut at, mut path) = (Some(start), Vec::<usize>::new());
            while let Some(link) = at {
                if seen[link] == done {
                    break;
                }
                if seen[link] == start + 1 {
                    let from = path.iter().position(|other| *other == link).unwrap_or(0);
                    return Err(BadGraph::CycleWithoutCut {
                        links: path[from..].iter().map(|link: &usize| links[*link].clone()).collect(),
                    });
                }
                if moved_by[link].is_none() {
                    return Err(BadGraph::Orphan { link: links[link].clone() });
                }
                seen[link] = start + 1;
                path.push(link);
                at = parent(link);
            }
            path.into_iter().for_each(|link| seen[link] = done);
        }
        let moved_by = moved_by.into_iter().flatten().collect();
        Ok(Self { links, joints, moved_by })
    }

    /// The names of the moving links.
    pub fn links(&self) -> &[String] {
        &self.links
    }

    /// The joints, cut ones included.
    pub fn joints(&self) -> &[Edge] {
        &self.joints
    }

    /// The joint of the spanning tree that moves each link.
    pub fn tree(&self) -> &[usize] {
        &self.moved_by
    }

    /// The joints that the tree does without.
    pub fn cuts(&self) -> impl Iterator<Item = usize> {
        self.joints.iter().enumerate().filter(|(_, joint)| joint.cut).map(|(k, _)| k)
    }

    /// Independent loops: joints − moving links.
    pub fn loops(&self) -> usize {
        self.joints.len() - self.links.len()
    }

    /// Grübler's count: `Σ freedom − d·loops`, d = 6 in space and 3 in a plane. It can be negative, and it is only a count.
    pub fn gruebler(&self, motion: usize) -> i64 {
        let freedom: usize = self.joints.iter().map(|joint| joint.freedom).sum();
        freedom as i64 - (motion * self.loops()) as i64
    }

    /// The fundamental cycle of each cut joint, in the order of the joints.
    pub fn cycles(&self) -> Vec<Cycle> {
        self.cuts().map(|cut| self.cycle(cut)).collect()
    }

    fn cycle(&self, cut: usize) -> Cycle {
        let Edge { parent, child, .. } = self.joints[cut];
        let ancestors = |end: Option<usize>| end.map_or_else(Vec::new, |link| path_to_root(link, |link| self.parent(link)));
        let (mut up, mut down) = (ancestors(child), ancestors(parent));
        // What both paths have in common, but for its first link, is not on the cycle.
        let mut meeting = None;
        while let (Some(a), Some(b)) = (up.last().copied(), down.last().copied()) {
            if a != b {
                break;
            }
            meeting = Some(a);
            up.pop();
            down.pop();
        }
        let joints = up.iter().chain(down.iter().rev()).map(|link| self.moved_by[*link]).chain([cut]).collect();
        let links = up.iter().copied().map(Some).chain([meeting]).chain(down.iter().rev().copied().map(Some)).collect();
        Cycle { cut, links, joints }
    }

    fn parent(&self, link: usize) -> Option<usize> {
        self.joints[self.moved_by[link]].parent
    }
}

/// A link and its ancestors, the link first. It ends where a link comes twice.
fn path_to_root(start: usize, parent: impl Fn(usize) -> Option<usize>) -> Vec<usize> {
    let (mut path, mut seen, mut at) = (Vec::new(), BTreeSet::new(), Some(start));
    while let Some(link) = at.filter(|link| seen.insert(*link)) {
        path.push(link);
        at = parent(link);
    }
    path
}

fn expect_unique<'a>(names: impl Iterator<Item = &'a String>) -> Result<(), BadGraph> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(BadGraph::DuplicateName { name: name.clone() });
        }
    }
    Ok(())
}
