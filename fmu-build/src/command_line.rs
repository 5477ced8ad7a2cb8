//! The table of commands of `cargo fmu`. Those that compute natively are described in `fmu-lab`, which makes man pages and completions
//! of both.

use crate::native::{self, Forwarded};
use crate::{batch, bench, fit, package, realtime, reference, release, run, site, soak, test};
use clap::{Parser, Subcommand};

/// Wear and heat in a sliding contact: makes, runs and tests the FMU.
#[derive(Parser, Debug)]
#[command(name = "cargo fmu", bin_name = "cargo fmu", version, arg_required_else_help = true)]
pub struct CommandLine {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The table of commands.
#[derive(Subcommand, Debug)]
#[allow(missing_docs, reason = "each is described by its arguments")]
pub enum Command {
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
    #[command(about = native::MAN)]
    Man(Forwarded),
}
