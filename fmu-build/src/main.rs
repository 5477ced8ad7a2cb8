//! `cargo fmu`: the command line of the sliding contact FMU.

// All output goes through `output`, which handles a closed pipe.
#![deny(clippy::print_stdout)]

use std::process::ExitCode;

use clap::Parser;
use fmu_build::command_line::{Command, CommandLine};
use fmu_build::{batch, bench, fit, native, output, package, realtime, reference, release, run, site, soak, test};

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    // `cargo fmu help steady`: the help of a forwarded command is its own.
    let result = match arguments.as_slice() {
        [help, name, ..] if help == "help" && native::has(name) => native::forward(&arguments),
        _ => match CommandLine::parse().command {
            Command::Package(arguments) => package::execute(&arguments),
            Command::Wheel(arguments) => package::wheel::execute(&arguments),
            Command::Release(arguments) => release::execute(&arguments),
            Command::Run(arguments) => run::execute(&arguments),
            Command::Test(arguments) => test::execute(&arguments),
            Command::Bench(arguments) => bench::execute(&arguments),
            Command::Realtime(arguments) => realtime::execute(&arguments),
            Command::Site(arguments) => site::execute(&arguments),
            Command::Reference(arguments) => reference::execute(&arguments),
            Command::Soak(arguments) => soak::execute(&arguments),
            Command::Batch(arguments) => batch::execute(&arguments),
            Command::Fit(arguments) => fit::execute(&arguments),
            Command::BatchWorker => batch::worker::execute(),
            _ => native::forward(&arguments),
        },
    };
    output::status(result)
}
