//! The tests of kernels as one program: they share what is compiled for them.

mod accuracy;
mod aligned;
mod allocation;
mod batch;
mod closed_forms;
mod common;
mod configuration;
mod derivative_structure;
mod derivatives;
mod errors;
mod extended;
mod fd_derivatives;
mod id_derivatives;
mod identities;
mod ltdl;
mod packed;
mod packed_kinematics;
mod refined;
mod structure;
