//! The tests of contact problems as one program: they share what is compiled for them.

mod certificates;
mod draws;
mod first_order;
mod grounded;
mod impacts;
mod known;
mod painleve;
mod proofs;
mod reader;
mod relaxation;
#[path = "../../robots/tests/share.rs"]
mod share;
