//! The tests of integrators, sensitivities and adjoints.

mod adaptive;
mod conservation;
mod order;
mod sensitivity;
