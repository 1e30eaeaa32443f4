//! What analyses one robot.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  featherbench identify arm.urdf --excite motion.csv              a motion within the limits that tells the parameters
  featherbench identify arm.urdf log.csv                          inertias, viscous and Coulomb friction; who fits how well
  featherbench identify arm.urdf log.parquet --method log_cholesky --out arm_identified.urdf
  featherbench identify arm.json log.csv --terms armature,viscous,coulomb,offset --json

The log has the columns time, q.JOINT, tau.JOINT, and v.JOINT and a.JOINT if they were measured, as CSV or Parquet (plain or Snappy). What is not
measured is differentiated: a polynomial of --order over --window rows around each row. Positions, velocities and torques get the same filter. A
sample is taken every --stride rows.

Gaps in time, saturated torques and combinations of parameters that the motion does not tell are flagged with their line and consequence. A missing
column, NaN, or times that do not rise are refused.

Methods: ordinary, weighted and total least squares; log_cholesky and semidefinite give bodies that can exist. semidefinite asks Clarabel
(`featherbench oracles install clarabel`). Intervals are of 95 %.

Exit codes: 0 good, 1 what is held out is predicted worse than by the description, 2 usage or bad input, 3 a required engine is missing.")]
pub struct IdentifyArgs {
    /// The robot: a description, URDF or MJCF file.
    #[arg(value_name = "ROBOT")]
    pub robot: PathBuf,
    /// The log: CSV or Parquet.
    #[arg(value_name = "LOG", required_unless_present = "excite")]
    pub log: Option<PathBuf>,
    /// Write a motion that tells the parameters, as a log, instead of reading one.
    #[arg(long, value_name = "FILE", conflicts_with = "log")]
    pub excite: Option<PathBuf>,
    /// Give a URDF's base six degrees of freedom.
    #[arg(long)]
    pub floating: bool,
    /// The estimator.
    #[arg(long, value_enum, default_value = "weighted")]
    pub method: Estimator,
    /// What is identified beside inertias: armature, viscous, coulomb, offset, or none.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "TERMS", default_value = "viscous,coulomb")]
    pub terms: Vec<Term>,
    /// Rows of the window that derivatives are taken by: an odd number; 1 takes the log as it is.
    #[arg(long, value_name = "ROWS", default_value_t = 21)]
    pub window: usize,
    /// The order of the polynomial.
    #[arg(long, default_value_t = 4)]
    pub order: usize,
    /// Rows from one sample to the next; by default the window, so that samples share no noise.
    #[arg(long, value_name = "ROWS")]
    pub stride: Option<usize>,
    /// The share of samples, at the end, that is not fitted but predicted.
    #[arg(long, value_name = "SHARE", default_value_t = 0.25)]
    pub held_out: f64,
    /// Base frequency of --excite, Hz.
    #[arg(long, value_name = "HZ", default_value_t = 0.1)]
    pub frequency: f64,
    /// Write the robot with its new parameters: .json, .urdf or .xml.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Leave out what the format of --out cannot hold, naming it, instead of refusing.
    #[arg(long)]
    pub lossy: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// An estimator of `identify`.
#[derive(Debug, Clone, Copy, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Estimator {
    Ordinary,
    Weighted,
    Total,
    LogCholesky,
    Semidefinite,
}

/// What `identify` identifies beside inertias.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Term {
    Armature,
    Viscous,
    Coulomb,
    Offset,
    None,
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  featherbench uncertainty panda                                    every mass ± 20 %, at a drawn state
  featherbench uncertainty robot.json --method chaos                the section 'uncertain' of the file, by polynomial chaos
  featherbench uncertainty robot.urdf --spread 0.05 --indices       which mass matters for which joint
  featherbench uncertainty chain:n=7,layout=spatial --method random --samples 100000000 --threads 2

Methods: first-order (y(μ) and J Σ Jᵀ), unscented, chaos (Gauss quadrature, exact for smooth answers of few parameters), random (Monte Carlo), sobol
(scrambled Sobol' points; the default). The last two have standard errors, quantiles and densities, and the same digits for any number of threads.

A state file is {\"q\":[…],\"v\":[…],\"drive\":[…]}; drive is joint forces, or with --torque accelerations.

Exit codes: 0 good, 2 usage or bad input.")]
pub struct UncertaintyArgs {
    /// A description (.json) or URDF file, a robot of datasets/models, or a family of generated robots.
    pub robot: String,
    /// How the uncertainty is propagated.
    #[arg(long, value_enum, default_value_t = Propagation::Sobol)]
    pub method: Propagation,
    /// Samples, of the methods that sample.
    #[arg(long, default_value_t = 65536, value_name = "N")]
    pub samples: u64,
    /// Threads; by default all cores.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// The seed of the samples, and of the state if none is given.
    #[arg(long, default_value_t = 1, value_parser = super::seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// The state: a JSON file.
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Make each mass uniform within this part of its value, in the place of what the description says. Without either, 0.2.
    #[arg(long, value_name = "PART")]
    pub spread: Option<f64>,
    /// The order of polynomial chaos; by default the largest up to 6 that takes at most 100 000 nodes.
    #[arg(long, value_name = "P")]
    pub order: Option<usize>,
    /// Torques of accelerations, instead of accelerations of torques.
    #[arg(long)]
    pub torque: bool,
    /// Also Sobol' indices: the part of the variance that each parameter explains.
    #[arg(long)]
    pub indices: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// How uncertainty is propagated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Propagation {
    /// First order.
    FirstOrder,
    /// The unscented transform.
    Unscented,
    /// Polynomial chaos.
    Chaos,
    /// Random points: Monte Carlo.
    Random,
    /// Scrambled Sobol' points.
    Sobol,
}

impl Propagation {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstOrder => "first_order",
            Self::Unscented => "unscented",
            Self::Chaos => "chaos",
            Self::Random => "random",
            Self::Sobol => "sobol",
        }
    }
}
