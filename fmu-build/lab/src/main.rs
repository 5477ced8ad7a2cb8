//! `fmu-lab`: commands of `cargo fmu` that compute with the model natively, which forwards them to here.

// Help texts have units in brackets, as the headers of columns.
#![allow(rustdoc::broken_intra_doc_links)]
// Everything is printed by `output`, which bears that nobody reads it to the end.
#![deny(clippy::print_stdout)]

mod bench;
mod chart;
mod ctrl_c;
mod cycles;
mod fuzz;
mod golden;
mod man;
mod plan;
mod simulate;
mod stability;
mod steady;
mod tables;
mod verify;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use fmu_build::{arguments, columns, drawing, native, output, package, parquet, plot, project, python, scenes};

/// Commands of `cargo fmu` that compute natively.
#[derive(Parser, Debug)]
#[command(name = "cargo fmu", bin_name = "cargo fmu", version, arg_required_else_help = true)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// The half of `cargo fmu bench` that calls the solvers and not the library in the FMU.
    #[command(hide = true)]
    Bench(bench::Arguments),
    Simulate(simulate::Arguments),
    Steady(steady::Arguments),
    Cycles(cycles::Arguments),
    Tables(tables::Arguments),
    Verify(verify::Arguments),
    Stability(stability::Arguments),
    Chart(chart::Arguments),
    Plan(plan::Arguments),
    Golden(golden::Arguments),
    Fuzz(fuzz::Arguments),
    Man(man::Arguments),
}

/// The commands, described as `cargo fmu` lists them, and by their arguments beyond that.
fn commands() -> clap::Command {
    native::COMMANDS.iter().fold(CommandLine::command(), |all, &(name, about)| {
        all.mut_subcommand(name, |own| {
            // clap takes the full stop from a single paragraph.
            let single = own.get_about().map(|text| format!("{text}."));
            match own.get_long_about().map(ToString::to_string).or(single) {
                Some(more) => own.about(about).long_about(format!("{about}\n\n{more}")),
                None => own.about(about),
            }
        })
    })
}

fn main() -> ExitCode {
    let given = CommandLine::from_arg_matches(&commands().get_matches()).unwrap_or_else(|wrong| wrong.exit());
    output::status(match given.command {
        Command::Bench(arguments) => bench::execute(&arguments),
        Command::Simulate(arguments) => simulate::execute(&arguments),
        Command::Steady(arguments) => steady::execute(&arguments),
        Command::Cycles(arguments) => cycles::execute(&arguments),
        Command::Tables(arguments) => tables::execute(&arguments),
        Command::Verify(arguments) => verify::execute(&arguments),
        Command::Stability(arguments) => stability::execute(&arguments),
        Command::Chart(arguments) => chart::execute(&arguments),
        Command::Plan(arguments) => plan::execute(&arguments),
        Command::Golden(arguments) => golden::execute(&arguments),
        Command::Fuzz(arguments) => fuzz::execute(&arguments),
        Command::Man(arguments) => man::execute(&arguments, commands()),
    })
}
