//! Generators of robots: each family a pure function of its parameters, the same bits on every platform.
//!
//! Families draw with [`crate::Random`] alone and use only sums, products, quotients and square roots. They use no sine or cosine, whose
//! last bit depends on the library, and no fused products, which depend on the processor.
//! The result is canonical: depth-first, without fixed joints, with unique names.
//!
//! A text names a [`Family`]: `family` or `family:key=value,key=value`. Suites and the command line use such texts:
//!
//! ```
//! use featherbench_robots::Family;
//! let family = Family::parse("chain:n=20,layout=spatial")?;
//! assert_eq!(family.generate()?.nv(), 20);
//! # Ok::<(), featherbench_robots::BadFamily>(())
//! ```

mod binary_tree;
mod centipede;
mod chain;
mod hand;
mod humanoid;
mod joints;
mod parameters;
mod parts;
mod platform;
mod quadruped;
mod snake;
mod star;
mod tree;

pub use binary_tree::BinaryTree;
pub use centipede::Centipede;
pub use chain::{Chain, Layout};
pub use hand::Hand;
pub use humanoid::Humanoid;
pub use joints::{Joints, Kind, Shape};
pub use platform::Platform;
pub use quadruped::Quadruped;
pub use snake::Snake;
pub use star::Star;
pub use tree::{Mix, Tree};

use featherbench_model::Description;
use parameters::{Parameters, words};
use std::fmt;
use thiserror::Error;

/// The base of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Base {
    /// The world.
    #[default]
    Fixed,
    /// A free base body, six dofs and one body more than the fixed robot.
    Free,
}

words!(Base { Fixed => "fixed", Free => "free" });

/// A family of generated robots, with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Family {
    /// Identical links in a row.
    Chain(Chain),
    /// A random tree with random bodies.
    Tree(Tree),
    /// A balanced binary tree.
    BinaryTree(BinaryTree),
    /// Links that are all joined to the world.
    Star(Star),
    /// A floating chain whose axes alternate.
    Snake(Snake),
    /// A floating spine with two legs on each link.
    Centipede(Centipede),
    /// Many arms that share one floating base.
    Platform(Platform),
    /// A 36-dof humanoid.
    Humanoid(Humanoid),
    /// An 18-dof quadruped.
    Quadruped(Quadruped),
    /// A 26-dof floating hand.
    Hand(Hand),
    /// A small branched tree that shows one kind of joint in its middle and at its tips.
    Joints(Joints),
}

/// Why a family cannot be generated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BadFamily {
    /// No family has this name.
    #[error("there is no family '{name}'; choose one of {}", Family::NAMES.join(", "))]
    UnknownFamily {
        /// The name given.
        name: String,
    },
    /// The text is not `family:key=value,…`.
    #[error("'{part}' in '{spec}' is not key=value; write for example chain:n=20,layout=spatial")]
    Syntax {
        /// The whole text.
        spec: String,
        /// The part that is wrong.
        part: String,
    },
    /// The family has no such parameter.
    #[error("family '{family}' has no parameter '{key}'; it takes {known}")]
    UnknownParameter {
        /// The family.
        family: &'static str,
        /// The parameter given.
        key: String,
        /// The parameters it has.
        known: String,
    },
    /// A parameter is given twice.
    #[error("family '{family}': parameter '{key}' is given twice")]
    Repeated {
        /// The family.
        family: &'static str,
        /// The parameter.
        key: String,
    },
    /// A parameter's value cannot be read or is out of range.
    #[error("family '{family}': {key}={value} does not do; give {expected}")]
    BadValue {
        /// The family.
        family: &'static str,
        /// The parameter.
        key: &'static str,
        /// The value given.
        value: String,
        /// What it takes.
        expected: String,
    },
}

impl Family {
    /// The families' names.
    pub const NAMES: [&'static str; 11] =
        ["chain", "tree", "binary_tree", "star", "snake", "centipede", "platform", "humanoid", "quadruped", "hand", "joints"];

    /// The family's name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Chain(_) => "chain",
            Self::Tree(_) => "tree",
            Self::BinaryTree(_) => "binary_tree",
            Self::Star(_) => "star",
            Self::Snake(_) => "snake",
            Self::Centipede(_) => "centipede",
            Self::Platform(_) => "platform",
            Self::Humanoid(_) => "humanoid",
            Self::Quadruped(_) => "quadruped",
            Self::Hand(_) => "hand",
            Self::Joints(_) => "joints",
        }
    }

    /// The family with this name and these parameters; the others have their defaults.
    ///
    /// # Errors
    /// [`BadFamily`], naming the family, the parameter and what it takes.
    pub fn from_parameters<'a>(name: &str, given: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, BadFamily> {
        let Some(family) = Self::NAMES.into_iter().find(|&known| known == name) else {
            return Err(BadFamily::UnknownFamily { name: name.to_owned() });
        };
        let mut parameters = Parameters::new(family, given)?;
        let result = match family {
            "chain" => Self::Chain(Chain::read(&mut parameters)?),
            "tree" => Self::Tree(Tree::read(&mut parameters)?),
            "binary_tree" => Self::BinaryTree(BinaryTree::read(&mut parameters)?),
            "star" => Self::Star(Star::read(&mut parameters)?),
            "snake" => Self::Snake(Snake::read(&mut parameters)?),
            "centipede" => Self::Centipede(Centipede::read(&mut parameters)?),
            "platform" => Self::Platform(Platform::read(&mut parameters)?),
            "humanoid" => Self::Humanoid(Humanoid::read(&mut parameters)?),
            "quadruped" => Self::Quadruped(Quadruped),
            "hand" => Self::Hand(Hand),
            _ => Self::Joints(Joints::read(&mut parameters)?),
        };
        parameters.finish()?;
        result.check()?;
        Ok(result)
    }

    /// The family that a text names: `family` or `family:key=value,key=value`.
    ///
    /// # Errors
    /// [`BadFamily`], naming the part of the text that is wrong.
    pub fn parse(spec: &str) -> Result<Self, BadFamily> {
        let (name, list) = spec.split_once(':').unwrap_or((spec, ""));
        let parts = list.split(',').map(str::trim).filter(|part| !part.is_empty());
        let pairs = parts.map(|part| {
            let (key, value) = part.split_once('=').ok_or_else(|| BadFamily::Syntax { spec: spec.to_owned(), part: part.to_owned() })?;
            Ok((key.trim(), value.trim()))
        });
        Self::from_parameters(name.trim(), pairs.collect::<Result<Vec<_>, _>>()?)
    }

    /// The robot. Its axes and rotations are normalised as the canonical form does it.
    ///
    /// # Errors
    /// [`BadFamily::BadValue`] when a parameter is out of its range.
    pub fn generate(&self) -> Result<Description, BadFamily> {
        self.check()?;
        let mut robot = match self {
            Self::Chain(chain) => chain.describe(),
            Self::Tree(tree) => tree.describe(),
            Self::BinaryTree(tree) => tree.describe(),
            Self::Star(star) => star.describe(),
            Self::Snake(snake) => snake.describe(),
            Self::Centipede(centipede) => centipede.describe(),
            Self::Platform(platform) => platform.describe(),
            Self::Humanoid(humanoid) => humanoid.describe(),
            Self::Quadruped(quadruped) => quadruped.describe(),
            Self::Hand(hand) => hand.describe(),
            Self::Joints(joints) => joints.describe(),
        };
        robot.bodies.iter_mut().for_each(|body| body.joint.normalise());
        Ok(robot)
    }

    fn check(&self) -> Result<(), BadFamily> {
        match self {
            Self::Chain(chain) => chain.check(),
            Self::Tree(tree) => tree.check(),
            Self::BinaryTree(tree) => tree.check(),
            Self::Star(star) => star.check(),
            Self::Snake(snake) => snake.check(),
            Self::Centipede(centipede) => centipede.check(),
            Self::Platform(platform) => platform.check(),
            Self::Humanoid(humanoid) => humanoid.check(),
            Self::Quadruped(_) | Self::Hand(_) | Self::Joints(_) => Ok(()),
        }
    }
}

/// The text that [`Family::parse`] reads back, every parameter written out.
impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.name())?;
        match self {
            Self::Chain(chain) => write!(f, ":{chain}"),
            Self::Tree(tree) => write!(f, ":{tree}"),
            Self::BinaryTree(tree) => write!(f, ":{tree}"),
            Self::Star(star) => write!(f, ":{star}"),
            Self::Snake(snake) => write!(f, ":{snake}"),
            Self::Centipede(centipede) => write!(f, ":{centipede}"),
            Self::Platform(platform) => write!(f, ":{platform}"),
            Self::Humanoid(humanoid) => write!(f, ":{humanoid}"),
            Self::Joints(joints) => write!(f, ":{joints}"),
            Self::Quadruped(_) | Self::Hand(_) => Ok(()),
        }
    }
}
