//! The program `enfilade`; everything it does is in the library, see [`enfilade::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    enfilade::cli::main()
}
