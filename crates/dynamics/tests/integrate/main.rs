//! The tests of integrators, sensitivities and adjoints as one program.

mod adaptive;
#[path = "../common/mod.rs"]
mod common;
mod conservation;
mod order;
mod sensitivity;
mod variational;
mod variational_derivative;
