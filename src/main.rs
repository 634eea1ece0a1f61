//! Arguments -> exit code: hands the command line to `cli` and returns what it says.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(cli::run(std::env::args_os()))
}
