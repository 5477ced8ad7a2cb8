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

use clap::{CommandFactory, Parser, Subcommand};
use fmu_build::{arguments, columns, drawing, output, package, parquet, plot, project, python, scenes};

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

fn main() -> ExitCode {
    output::status(match CommandLine::parse().command {
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
        Command::Man(arguments) => man::execute(&arguments, CommandLine::command()),
    })
}

#[cfg(test)]
mod tests {
    use super::CommandLine;
    use clap::CommandFactory;
    use fmu_build::native;

    #[test]
    fn cargo_fmu_lists_every_command_as_it_describes_itself() {
        let own = CommandLine::command();
        let own: Vec<(&str, String)> = own
            .get_subcommands()
            .filter(|command| !command.is_hide_set())
            .map(|command| (command.get_name(), command.get_about().map(ToString::to_string).unwrap_or_default()))
            .collect();
        let listed: Vec<(&str, String)> =
            native::COMMANDS.iter().map(|&(name, about)| (name, about.to_owned())).collect();
        assert_eq!(listed, own);
    }
}
