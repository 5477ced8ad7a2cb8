//! `cargo fmu package`: the .fmu of a scene, or the scene as a parameter set.

mod archive;
mod description;
mod documentation;
mod glibc;
mod library;
mod licences;
mod parameter_set;
mod reference;
mod terminals;
mod xml;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use clap::{Args, ValueEnum};
use sliding_contact::scene::file::SceneFile;
use sliding_contact::slot;

use crate::{project, scenes};
use archive::Files;
use description::MODEL_IDENTIFIER;

/// Drawn by modelDescription/icons.py.
const MODEL_ICON: &[u8] = include_bytes!("../../../modelDescription/model.png");
const TERMINAL_ICON: &[u8] = include_bytes!("../../../modelDescription/terminalsAndIcons/terminal.png");
const TERMINAL_ICON_PATH: &str = "terminalsAndIcons/terminal.png";

/// Makes the FMU of a scene.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene file, or name of a built-in scene; without one the stock FMU is made
    scene: Option<String>,
    /// File to write [default: target/fmu/SlidingContact.fmu, with the scene's name before the ending]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the scene as an SSP parameter set (.ssv) for the stock FMU instead
    #[arg(long)]
    ssv: bool,
    /// Platforms whose library the FMU holds
    #[arg(long, value_delimiter = ',', default_value = "linux64")]
    platform: Vec<Platform>,
    /// Only write modelDescription/modelDescription.xml of this source tree anew
    #[arg(long, conflicts_with_all = ["scene", "output", "ssv"])]
    write_description: bool,
}

/// Platforms under the names of FMI 2.0.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, ValueEnum)]
pub enum Platform {
    /// Linux on x86-64, glibc 2.17 or newer
    Linux64,
    /// Windows on x86-64
    Win64,
    /// macOS
    Darwin64,
}

impl Platform {
    /// Path of the library in the FMU.
    fn library_path(self) -> String {
        let (folder, ending) = match self {
            Platform::Linux64 => ("linux64", "so"),
            Platform::Win64 => ("win64", "dll"),
            Platform::Darwin64 => ("darwin64", "dylib"),
        };
        format!("binaries/{folder}/{MODEL_IDENTIFIER}.{ending}")
    }

    /// What it takes to build for a platform that this command does not build for.
    fn requirement(self) -> &'static str {
        match self {
            Platform::Linux64 => "linux64 is built by this command",
            Platform::Win64 => {
                "win64 is not built by this command yet; it needs the Rust target x86_64-pc-windows-gnu \
                 (`rustup target add x86_64-pc-windows-gnu`) and the mingw-w64 linker"
            }
            Platform::Darwin64 => {
                "darwin64 is not built by this command yet; it needs the Rust target x86_64-apple-darwin \
                 (`rustup target add x86_64-apple-darwin`) and Apple's SDK"
            }
        }
    }
}

/// How to package.
#[derive(Clone, Debug)]
pub struct Options {
    /// File to write; `None`: `target/fmu/SlidingContact.fmu`, with the scene's name before the ending.
    pub output: Option<PathBuf>,
    /// Platforms whose library the FMU holds.
    pub platforms: Vec<Platform>,
}

impl Default for Options {
    fn default() -> Self {
        Options { output: None, platforms: vec![Platform::Linux64] }
    }
}

/// Runs the command.
///
/// # Errors
/// As [`build`].
pub fn execute(arguments: &Arguments) -> Result<()> {
    if arguments.write_description {
        let path = project::root().join("modelDescription/modelDescription.xml");
        write(&path, description::write(&slot::Packaged::stock(), "").as_bytes())?;
        println!("{}", path.display());
        return Ok(());
    }
    let scene = arguments.scene.as_deref();
    let path = if arguments.ssv {
        let scene = scenes::load(scene)?;
        let path = arguments.output.clone().unwrap_or_else(|| default_path(&scene, "ssv"));
        write(&path, parameter_set::write(&scene).as_bytes())?;
        path
    } else {
        build(scene, &Options { output: arguments.output.clone(), platforms: arguments.platform.clone() })?
    };
    println!("{}", path.display());
    Ok(())
}

/// Makes the FMU of a scene (file or built-in name; `None`: stock) and returns its path. Building the library the
/// first time takes a minute; afterwards only the scene is filled in.
///
/// # Errors
/// Everything wrong with the scene, a failed build, or a file that cannot be written.
pub fn build(scene: Option<&str>, options: &Options) -> Result<PathBuf> {
    let scene = scenes::load(scene)?;
    let path = options.output.clone().unwrap_or_else(|| default_path(&scene, "fmu"));
    write(&path, &archive::pack(&files(&scene, &options.platforms)?)?)?;
    Ok(path)
}

fn default_path(scene: &SceneFile, ending: &str) -> PathBuf {
    let name = scene.packaged.name.as_str();
    let stem = if name == slot::STOCK_NAME { MODEL_IDENTIFIER.into() } else { format!("{MODEL_IDENTIFIER}.{name}") };
    project::target().join("fmu").join(format!("{stem}.{ending}"))
}

/// Everything in the FMU.
fn files(scene: &SceneFile, platforms: &[Platform]) -> Result<Files> {
    let mut files = Files::new();
    for &platform in platforms {
        let mut library = library::build(platform)?;
        slot::fill(&mut library, &scene.packaged).map_err(|reason| anyhow!(reason))?;
        if platform == Platform::Linux64 {
            report_glibc(&library)?;
        }
        files.insert(platform.library_path(), library);
    }
    let texts = [
        ("modelDescription.xml", description::write(&scene.packaged, &scene.description)),
        ("documentation/index.html", documentation::write(scene)),
        ("terminalsAndIcons/terminalsAndIcons.xml", terminals::write()),
    ];
    files.extend(texts.map(|(path, text)| (path.to_owned(), text.into_bytes())));
    let pictures =
        [("model.png", MODEL_ICON), ("terminalsAndIcons/icon.png", MODEL_ICON), (TERMINAL_ICON_PATH, TERMINAL_ICON)];
    files.extend(pictures.map(|(path, bytes)| (path.to_owned(), bytes.to_vec())));
    licences::add(&mut files)?;
    reference::add(&mut files, &scene.packaged)?;
    Ok(files)
}

fn report_glibc(library: &[u8]) -> Result<()> {
    let Some((major, minor)) = glibc::highest(library)? else { return Ok(()) };
    eprintln!("The Linux library needs glibc {major}.{minor} or newer.");
    if (major, minor) > glibc::WANTED {
        let (wanted_major, wanted_minor) = glibc::WANTED;
        eprintln!("warning: distributions with glibc {wanted_major}.{wanted_minor} cannot load it");
    }
    Ok(())
}

/// Writes a file and the folders above it; a reader never sees half of it.
fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let context = || format!("writing {}", path.display());
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).with_context(context)?;
    }
    let mut partial = path.as_os_str().to_owned();
    partial.push(format!(".{}.partial", std::process::id()));
    fs::write(&partial, bytes).with_context(context)?;
    fs::rename(&partial, path).with_context(context)
}
