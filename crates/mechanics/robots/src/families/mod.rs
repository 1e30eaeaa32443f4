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

words! {
    /// The base of the robot.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum Base {
        /// The world.
        #[default]
        Fixed => "fixed",
        /// A free base body, six dofs and one body more than the fixed robot.
        Free => "free",
    }
}

/// Declares [`Family`]: its variants, each of the type of that name, with the families' names.
macro_rules! families {
    ($($(#[$of:meta])* $family:ident => $name:literal),+ $(,)?) => {
        /// A family of generated robots, with its parameters.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Family {
            $($(#[$of])* $family($family)),+
        }

        impl Family {
            /// The families' names.
            pub const NAMES: [&'static str; [$($name),+].len()] = [$($name),+];

            /// The family's name.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$family(_) => $name),+
                }
            }

            /// The name and the reader of the family of this name.
            fn reader(name: &str) -> Option<(&'static str, Reader)> {
                match name {
                    $($name => Some(($name, |given| $family::read(given).map(Self::$family))),)+
                    _ => None,
                }
            }

            fn check(&self) -> Result<(), BadFamily> {
                match self {
                    $(Self::$family(family) => family.check()),+
                }
            }

            fn describe(&self) -> Description {
                match self {
                    $(Self::$family(family) => family.describe()),+
                }
            }

            fn written(&self) -> String {
                match self {
                    $(Self::$family(family) => family.written()),+
                }
            }
        }
    };
}

type Reader = fn(&mut Parameters) -> Result<Family, BadFamily>;

/// What a family has that takes no parameters, or does with all that can be read. A family's own functions come before these.
trait Plain: Default {
    fn read(_: &mut Parameters) -> Result<Self, BadFamily> {
        Ok(Self::default())
    }

    fn check(&self) -> Result<(), BadFamily> {
        Ok(())
    }

    fn written(&self) -> String {
        String::new()
    }
}

impl Plain for Hand {}
impl Plain for Joints {}
impl Plain for Quadruped {}

families! {
    /// Identical links in a row.
    Chain => "chain",
    /// A random tree with random bodies.
    Tree => "tree",
    /// A balanced binary tree.
    BinaryTree => "binary_tree",
    /// Links that are all joined to the world.
    Star => "star",
    /// A floating chain whose axes alternate.
    Snake => "snake",
    /// A floating spine with two legs on each link.
    Centipede => "centipede",
    /// Many arms that share one floating base.
    Platform => "platform",
    /// A 36-dof humanoid.
    Humanoid => "humanoid",
    /// An 18-dof quadruped.
    Quadruped => "quadruped",
    /// A 26-dof floating hand.
    Hand => "hand",
    /// A small branched tree that shows one kind of joint in its middle and at its tips.
    Joints => "joints",
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
    /// The family with this name and these parameters; the others have their defaults.
    ///
    /// # Errors
    /// [`BadFamily`], naming the family, the parameter and what it takes.
    pub fn from_parameters<'a>(name: &str, given: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, BadFamily> {
        let Some((family, read)) = Self::reader(name) else {
            return Err(BadFamily::UnknownFamily { name: name.to_owned() });
        };
        let mut parameters = Parameters::new(family, given)?;
        let result = read(&mut parameters)?;
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
        let mut robot = self.describe();
        robot.bodies.iter_mut().for_each(|body| body.joint.normalise());
        Ok(robot)
    }
}

/// The text that [`Family::parse`] reads back, every parameter written out.
impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.name(), self.written())
    }
}
