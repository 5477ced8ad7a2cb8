//! `cargo fmu man`: man pages and completions from the definitions of the arguments.

use crate::output::{self, print_line};
use anyhow::{Context, Result};
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use fmu_build::command_line::CommandLine;
use std::fs;
use std::path::{Path, PathBuf};

/// Shells with a completion.
const SHELLS: [Shell; 3] = [Shell::Bash, Shell::Zsh, Shell::Fish];

/// Name under which `cargo fmu` has its pages and completions.
const NAME: &str = "cargo-fmu";

#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Folder to write to.
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
}

/// Runs the command; `own`: the commands of this program.
pub(crate) fn execute(arguments: &Arguments, own: Command) -> Result<()> {
    output::check_folder(Some(&arguments.output))?;
    write(&arguments.output, whole(own)).with_context(|| format!("writing {}", arguments.output.display()))?;
    print_line!("{}", arguments.output.display());
    Ok(())
}

/// `cargo fmu` with the commands of this program in the place of those that are forwarded to it.
fn whole(own: Command) -> Command {
    let own = own.get_subcommands().filter(|command| !command.is_hide_set()).cloned();
    let whole =
        own.fold(CommandLine::command(), |all, command| all.mut_subcommand(command.get_name(), |_| command.clone()));
    whole.name(NAME).bin_name(NAME)
}

fn write(folder: &Path, mut whole: Command) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    for shell in SHELLS {
        clap_complete::generate_to(shell, &mut whole.clone(), NAME, folder)?;
    }
    whole.build();
    clap_mangen::generate_to(whole, folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_and_its_options_are_completed() {
        let folder = std::env::temp_dir().join(format!("fmu-man-{}", std::process::id()));
        write(&folder, whole(crate::CommandLine::command())).unwrap();
        let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
        for command in CommandLine::command().get_subcommands().filter(|command| !command.is_hide_set()) {
            let page = read(&format!("{NAME}-{}.1", command.get_name()));
            assert!(page.contains("SYNOPSIS"), "{page}");
        }
        // Of a command that is forwarded.
        assert!(read("cargo-fmu-simulate.1").contains("measured"));
        for shell in ["cargo-fmu.bash", "_cargo-fmu", "cargo-fmu.fish"] {
            assert!(read(shell).contains("measured"), "{shell}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
