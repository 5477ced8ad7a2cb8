//! `cargo fmu`: the command line of the sliding contact FMU.

// All output goes through `output`, which handles a closed pipe.
#![deny(clippy::print_stdout)]

mod batch;
mod bench;
mod chart;
mod columns;
mod cycles;
mod golden;
mod output;
mod package;
mod plan;
#[allow(dead_code, reason = "one command does not need every kind of axis, mark and legend")]
mod plot;
mod project;
mod python;
mod realtime;
mod run;
mod scenes;
mod stability;
mod steady;
mod tables;
mod test;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

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
    Run(run::Arguments),
    Test(test::Arguments),
    Bench(bench::Arguments),
    Realtime(realtime::Arguments),
    Steady(steady::Arguments),
    Cycles(cycles::Arguments),
    Tables(tables::Arguments),
    Verify(verify::Arguments),
    Batch(batch::Arguments),
    /// A process of `batch`, which starts it.
    #[command(hide = true)]
    BatchWorker,
    Stability(stability::Arguments),
    Chart(chart::Arguments),
    Plan(plan::Arguments),
    Golden(golden::Arguments),
}

fn main() -> ExitCode {
    let result = match CommandLine::parse().command {
        Command::Package(arguments) => package::execute(&arguments),
        Command::Run(arguments) => run::execute(&arguments),
        Command::Test(arguments) => test::execute(&arguments),
        Command::Bench(arguments) => bench::execute(&arguments),
        Command::Realtime(arguments) => realtime::execute(&arguments),
        Command::Steady(arguments) => steady::execute(&arguments),
        Command::Cycles(arguments) => cycles::execute(&arguments),
        Command::Tables(arguments) => tables::execute(&arguments),
        Command::Verify(arguments) => verify::execute(&arguments),
        Command::Batch(arguments) => batch::execute(&arguments),
        Command::BatchWorker => batch::worker::execute(),
        Command::Stability(arguments) => stability::execute(&arguments),
        Command::Chart(arguments) => chart::execute(&arguments),
        Command::Plan(arguments) => plan::execute(&arguments),
        Command::Golden(arguments) => golden::execute(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
