//! `cargo fmu`.
mod bench;
mod package;
mod project;
mod python;
mod run;
mod scenes;
mod test;
use clap::Parser;
#[derive(Parser)]
#[command(name = "cargo fmu", bin_name = "cargo fmu")]
enum Commands {
    Run(run::Arguments),
    Test(test::Arguments),
    Bench(bench::Arguments),
}
fn main() -> std::process::ExitCode {
    let result = match Commands::parse() {
        Commands::Run(arguments) => run::execute(&arguments),
        Commands::Test(arguments) => test::execute(&arguments),
        Commands::Bench(arguments) => bench::execute(&arguments),
    };
    if let Err(error) = result {
        eprintln!("error: {error:#}");
        return std::process::ExitCode::FAILURE;
    }
    std::process::ExitCode::SUCCESS
}
