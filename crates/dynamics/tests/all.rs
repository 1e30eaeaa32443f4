//! The tests of kernels as one program: they share what is compiled for them.

mod accuracy;
mod aligned;
mod allocation;
mod batch;
mod batch_derivatives;
mod closed_forms;
mod common;
mod configuration;
mod derivative_structure;
mod derivatives;
mod errors;
mod extended;
mod factors;
mod fd_derivatives;
mod floating_base;
mod id_derivatives;
mod identities;
mod ltdl;
mod ltl;
mod packed;
mod packed_kinematics;
mod parents;
mod refined;
mod regressors;
mod structure;
mod updates;
