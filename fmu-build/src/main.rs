//! `cargo fmu`: the command line of the sliding contact FMU.

// All output goes through `output`, which handles a closed pipe.
#![deny(clippy::print_stdout)]

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use fmu_build::native::Forwarded;
use fmu_build::{batch, bench, fit, native, output, package, realtime, reference, release, run, site, soak, test};

/// Wear and heat in a sliding contact: makes, runs and tests the FMU.
#[derive(Parser, Debug)]
#[command(name = "cargo fmu", bin_name = "cargo fmu", version, arg_required_else_help = true)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    Package(package::Arguments),
    Wheel(package::wheel::Arguments),
    Release(release::Arguments),
    Run(run::Arguments),
    Test(test::Arguments),
    Bench(bench::Arguments),
    Realtime(realtime::Arguments),
    Site(site::Arguments),
    Reference(reference::Arguments),
    Soak(soak::Arguments),
    #[command(about = native::SIMULATE)]
    Simulate(Forwarded),
    #[command(about = native::STEADY)]
    Steady(Forwarded),
    #[command(about = native::CYCLES)]
    Cycles(Forwarded),
    #[command(about = native::TABLES)]
    Tables(Forwarded),
    #[command(about = native::VERIFY)]
    Verify(Forwarded),
    Batch(batch::Arguments),
    Fit(fit::Arguments),
    /// A process of `batch`, which starts it.
    #[command(hide = true)]
    BatchWorker,
    #[command(about = native::STABILITY)]
    Stability(Forwarded),
    #[command(about = native::CHART)]
    Chart(Forwarded),
    #[command(about = native::PLAN)]
    Plan(Forwarded),
    #[command(about = native::GOLDEN)]
    Golden(Forwarded),
    #[command(about = native::FUZZ)]
    Fuzz(Forwarded),
}

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
            Command::Simulate(_)
            | Command::Steady(_)
            | Command::Cycles(_)
            | Command::Tables(_)
            | Command::Verify(_)
            | Command::Stability(_)
            | Command::Chart(_)
            | Command::Plan(_)
            | Command::Golden(_)
            | Command::Fuzz(_) => native::forward(&arguments),
        },
    };
    output::status(result)
}
