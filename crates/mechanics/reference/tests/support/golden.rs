//! The golden data: their contents, how they are derived, what they depend on.

use super::{Case, State, project};
use featherbench_reference::{Error, Motion, Mp, Precision, Robot};
use std::path::{Path, PathBuf};

/// Significant digits of a golden number: what a pair of doubles holds (106 bits).
pub const DIGITS: usize = 31;
/// The seed of the golden states.
pub const SEED: u64 = 1;
/// The columns of a golden file.
pub const COLUMNS: [&str; 4] = ["id", "fd", "mass_diagonal", "mass_times_a"];

pub fn folder() -> PathBuf {
    project().join("datasets/truth")
}

/// The answers of the Rust witness for one state.
pub struct Answers {
    pub id: Vec<Mp>,
    pub fd: Vec<Mp>,
    /// The mass matrix, row by row.
    pub mass_matrix: Vec<Mp>,
    /// M a.
    pub product: Vec<Mp>,
}

impl Answers {
    pub fn derive(case: &Case, state: &State) -> Result<Self, Error> {
        let description = case.describe();
        let robot = Robot::new(&description, Precision::for_dofs(description.nv()))?;
        let motion: Motion = robot.moving(&state.q, &state.v)?;
        let a = robot.numbers("a", &state.a)?;
        let mass = motion.mass_matrix();
        Ok(Self {
            id: motion.inverse_dynamics(&a)?,
            fd: motion.forward_dynamics(&robot.numbers("tau", &state.tau)?)?,
            product: mass.apply(&a),
            mass_matrix: mass.entries().to_vec(),
        })
    }

    /// The column of this name.
    pub fn column(&self, name: &str) -> Vec<Mp> {
        let n = self.id.len();
        match name {
            "id" => self.id.clone(),
            "fd" => self.fd.clone(),
            "mass_diagonal" => (0..n).map(|i| self.mass_matrix[i * n + i].clone()).collect(),
            "mass_times_a" => self.product.clone(),
            other => panic!("there is no column {other}"),
        }
    }

    /// The golden text of a column: decimal numbers. A number that is the rounding error of a zero is written as zero.
    pub fn text(&self, name: &str) -> Vec<String> {
        let column = self.column(name);
        let scale = column.iter().fold(Mp::zero(), |scale, x| scale.max(x.abs()));
        let is_noise = |x: &Mp| (x.abs() * Precision::STANDARD.number(1e60).unwrap()) <= scale;
        let text = |x: &Mp| if is_noise(x) { "0".to_owned() } else { x.to_decimal(DIGITS).trim_end_matches("e0").to_owned() };
        column.iter().map(text).collect()
    }
}

/// The first 16 bytes of BLAKE3 in hexadecimal, as everywhere in the project.
fn finish(hasher: &blake3::Hasher) -> String {
    hasher.finalize().to_hex()[..32].to_owned()
}

/// The hash of the doubles nearest to some numbers, bit by bit.
pub fn hash_of_doubles(numbers: &[f64]) -> String {
    let mut hasher = blake3::Hasher::new();
    numbers.iter().for_each(|x| {
        hasher.update(&x.to_le_bytes());
    });
    finish(&hasher)
}

/// The hash of a state.
pub fn hash_of_state(state: &State) -> String {
    hash_of_doubles(&[&state.q[..], &state.v, &state.a, &state.tau].concat())
}

/// The hash of the Rust witness: all sources of this crate.
pub fn hash_of_rust() -> String {
    let root = project().join("crates/mechanics/reference/src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    hash_of_files(&root, &files)
}

/// The hash of the Python witness.
pub fn hash_of_python() -> String {
    let root = project().join("oracles/featherbench_oracles");
    let mut files = Vec::new();
    collect(&root.join("truth"), &mut files);
    // Python leaves compiled files beside its sources.
    files.retain(|file| file.extension().is_some_and(|ending| ending == "py"));
    files.sort();
    hash_of_files(&root, &files)
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { collect(&path, files) } else { files.push(path) }
    }
}

fn hash_of_files(root: &Path, files: &[PathBuf]) -> String {
    let mut hasher = blake3::Hasher::new();
    for file in files {
        let name = file.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
        let text = std::fs::read_to_string(file).unwrap().replace("\r\n", "\n");
        hasher.update(name.as_bytes()).update(&[0]).update(text.as_bytes()).update(&[0]);
    }
    finish(&hasher)
}
