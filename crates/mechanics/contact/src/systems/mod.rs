//! Contact problems with known answers. Every number is a parameter: the same case runs with others.
//!
//! | case | what is known |
//! |---|---|
//! | [`PainleveRod`] | how many forces obey the laws: 1, 0, 2 or lift-off, from the signs of two numbers |
//! | [`Kane`] | a double pendulum that gains energy under Newton's law |
//! | [`Incline`] | sliding or sticking, round and elliptic cones, pyramids, and the artefact of the convex relaxation |
//! | [`SlidingSphere`] | when sliding becomes rolling: t* = 2v₀/(7μg), then 5v₀/7 |
//! | [`BoxOnBalls`] | rolling without slip: F/(M + 7nm/20), with hundreds of redundant rows |
//! | [`Table`] | four legs: the least forces, and the line of all forces |
//! | [`Stack`] | weights from the top, and the rate of Gauss–Seidel |
//! | [`RockingBlock`] | Housner's ratio 1 − (3/2) sin²α |
//! | [`Cradle`] | balls in a row |
//! | [`Feet`] | flat feet: 12 rows each, of rank 6 |

mod bodies;
mod chains;
mod incline;
mod kane;
mod painleve;
mod supports;

pub use bodies::{BoxOnBalls, RockingBlock, SlidingSphere};
pub use chains::{Cradle, Stack};
pub use incline::{Incline, Section};
pub use kane::Kane;
pub use painleve::{Answers, PainleveRod};
pub use supports::{Feet, Table};

use crate::malformed::Malformed;
use crate::problem::Problem;

/// Every case with its usual numbers, each under a name of its own: the files of `datasets/contact`.
///
/// # Errors
/// None with these numbers; the type is that of each case.
pub fn all() -> Result<Vec<Problem>, Malformed> {
    let (rod, incline) = (PainleveRod::default(), Incline::default());
    let paradox = PainleveRod { friction: 1.5, ..rod };
    Ok(vec![
        rod.problem()?.with_name("painleve_contact"),
        PainleveRod { rate: 4.0, ..rod }.problem()?.with_name("painleve_lift_off"),
        paradox.problem()?.with_name("painleve_none"),
        PainleveRod { rate: 4.0, ..paradox }.problem()?.with_name("painleve_two"),
        paradox.impact(1.0, 1e-3)?,
        Kane::default().problem()?,
        incline.problem()?.with_name("incline_round"),
        Incline { section: Section::Elliptic(0.2), ..incline }.problem()?.with_name("incline_elliptic"),
        Incline { section: Section::Inscribed, ..incline }.problem()?.with_name("incline_inscribed"),
        Incline { section: Section::Box, ..incline }.problem()?.with_name("incline_box"),
        SlidingSphere::default().problem()?,
        BoxOnBalls { balls: 3, force: 18.0, ..BoxOnBalls::default() }.problem()?,
        Table::default().problem()?,
        Stack::two(10.0).problem()?.with_name("stack_two"),
        Stack::equal(8).problem()?.with_name("stack_equal"),
        RockingBlock::default().problem()?,
        Cradle::default().problem()?,
        Feet::default().problem()?,
    ])
}
