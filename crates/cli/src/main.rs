//! The `featherbench` command: wires engines and studies into the harness.

mod args;
mod check;
mod compare;
mod diff;
mod engines;
mod explain;
mod external;
mod fail;
mod filter;
mod generate;
mod history;
mod list;
mod native;
mod offers;
mod oracles;
mod outcome;
mod package;
mod patience;
mod progress;
mod ranges;
mod rapier;
mod record;
mod report;
mod robot_file;
mod robots;
mod root;
mod run;
mod shell;
mod table;

use args::{Cli, Command, OraclesAction, RunArgs};
use clap::Parser;
use fail::Fail;
use root::Root;
use std::process::ExitCode;

fn main() -> ExitCode {
    match dispatch(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fail) => {
            eprintln!("error: {fail}");
            fail.code()
        }
    }
}

/// Finds the project's folder for the commands that need it: a run's folder can be looked at without.
fn dispatch(cli: Cli) -> Result<(), Fail> {
    let root = || Root::find(cli.root.as_deref());
    let default = || Command::Run(RunArgs::default_suite());
    match cli.command.unwrap_or_else(default) {
        Command::Run(args) => run::run(&root()?, &args),
        Command::Compare(args) => compare::compare(&root()?, &args),
        Command::Report(args) => report::write(&args.folder),
        Command::Gate(args) => report::gate(&root()?, &args),
        Command::Diff(args) => diff::compare(&args),
        Command::History(args) => history::append(&root, &args),
        Command::List(args) => list::list(&root()?, &args),
        Command::Explain(args) => explain::explain(&args),
        Command::Record(args) => record::record(&root()?, &args),
        Command::Gen(args) => generate::generate(&root()?, &args),
        Command::Oracles(args) => match args.action {
            OraclesAction::Install(args) => {
                let root = root()?;
                if args.rapier {
                    let program = rapier::install(&root)?;
                    eprintln!("rapier is built: {}", program.display());
                }
                if args.native || !args.rapier {
                    oracles::install(&root)?;
                }
                if args.native { native::install(&root) } else { Ok(()) }
            }
            OraclesAction::Status => oracles::status(&root()?),
            OraclesAction::Check(args) => check::check(root().ok().as_ref(), &args),
        },
        Command::Peer(args) => featherbench_engines::peer::serve(&args.library, args.core).map_err(Fail::input),
    }
}
