//! Arguments to calls, results to text.

use std::process::ExitCode;

/// Runs the command line.
pub fn main() -> ExitCode {
    todo!()
}
