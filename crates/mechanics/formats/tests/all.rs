//! The tests of formats as one program: they share what is compiled for them.

mod continua;
mod datasets;
mod loops;
mod mjcf_import;
mod mjcf_told;
mod neutral;
mod residuals;
mod robots;
#[path = "../../robots/tests/share.rs"]
mod share;
mod support;
mod uncertain;
mod urdf_errors;
mod urdf_export;
mod urdf_import;
mod urdf_versions;
