//! `cargo fmu package`: the .fmu of a scene, or the scene as a parameter set.

mod glibc;
mod imports;
mod library;
pub(crate) mod licences;
mod platform;
mod toolchain;
pub mod wheel;

pub use fmu_file::description::write as model_description;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, anyhow};
use clap::Args;
use scene::slot;
use scene_file::SceneFile;

use crate::output::{self, print_line};
use crate::{project, scenes};
use fmu_file::archive::{self, Files};
use fmu_file::description::{self, MODEL_IDENTIFIER};
use fmu_file::{documentation, parameter_set, reference};
pub(crate) use platform::Platform;

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
    #[arg(long, conflicts_with = "platform")]
    ssv: bool,
    /// Platforms whose library the FMU holds; give it several times, or several with commas [default: that of this machine]
    #[arg(long, value_delimiter = ',')]
    platform: Vec<Platform>,
    /// Only write modelDescription.xml, which is made from the variable table, in this source tree anew
    #[arg(long, conflicts_with_all = ["scene", "output", "ssv", "platform"])]
    write_description: bool,
}

/// Packaging options.
#[derive(Clone, Debug)]
pub struct Options {
    /// File to write; `None`: `target/fmu/SlidingContact.fmu`, with the scene's name before the ending.
    pub output: Option<PathBuf>,
    /// Platforms whose library the FMU holds.
    pub platforms: Vec<Platform>,
}

impl Default for Options {
    fn default() -> Self {
        Options { output: None, platforms: vec![Platform::host().unwrap_or(Platform::Linux64)] }
    }
}

/// Runs the command.
pub fn execute(arguments: &Arguments) -> Result<()> {
    if arguments.write_description {
        let path = project::root().join("modelDescription/modelDescription.xml");
        write(&path, description::write(&slot::Packaged::stock(), "").as_bytes())?;
        print_line!("{}", path.display());
        return Ok(());
    }
    output::check_ending(arguments.output.as_deref(), if arguments.ssv { &["ssv"] } else { &["fmu"] })?;
    let scene = arguments.scene.as_deref();
    let path = if arguments.ssv {
        let scene = scenes::load(scene)?;
        scenes::warn(&scene);
        let path = arguments.output.clone().unwrap_or_else(|| default_path(&scene, "ssv"));
        write(&path, parameter_set::write(&scene).as_bytes())?;
        path
    } else {
        let scene = scenes::load(scene)?;
        build_scene(&scene, &Options { output: arguments.output.clone(), platforms: platforms(&arguments.platform)? })?
    };
    print_line!("{}", path.display());
    Ok(())
}

/// The platforms named, else that of this machine, which goes to the error stream.
fn platforms(named: &[Platform]) -> Result<Vec<Platform>> {
    if !named.is_empty() {
        return Ok(named.to_vec());
    }
    let (system, processor) = (std::env::consts::OS, std::env::consts::ARCH);
    let host = Platform::host().with_context(|| {
        format!("no library is made for {system} on {processor}, this machine; name platforms by --platform")
    })?;
    eprintln!("The FMU runs on {}, the platform of this machine; --platform names others.", host.folder());
    Ok(vec![host])
}

/// Makes the FMU of a scene (file or built-in name; `None`: stock) and returns its path. Building the library the
/// first time takes a minute; afterwards only the scene is filled in.
///
/// # Errors
/// Everything wrong with the scene, a failed build, or a file that cannot be written.
pub fn build(scene: Option<&str>, options: &Options) -> Result<PathBuf> {
    build_scene(&scenes::load(scene)?, options)
}

/// As [`build`], of a scene that has been read, and perhaps changed.
pub(crate) fn build_scene(scene: &SceneFile, options: &Options) -> Result<PathBuf> {
    check_platforms(&options.platforms)?;
    scenes::warn(scene);
    let path = options.output.clone().unwrap_or_else(|| default_path(scene, "fmu"));
    write(&path, &archive::pack(&files(scene, &options.platforms)?)?)?;
    Ok(path)
}

/// As [`build`], of a scene with these changes, for this machine.
pub(crate) fn build_changed(scene: Option<&str>, changes: &[String], output: PathBuf) -> Result<PathBuf> {
    build_scene(&scenes::changed(scene, changes)?, &Options { output: Some(output), ..Options::default() })
}

fn default_path(scene: &SceneFile, ending: &str) -> PathBuf {
    let name = scene.packaged.name.as_str();
    let stem = if name == slot::STOCK_NAME { MODEL_IDENTIFIER.into() } else { format!("{MODEL_IDENTIFIER}.{name}") };
    project::target().join("fmu").join(format!("{stem}.{ending}"))
}

fn files(scene: &SceneFile, platforms: &[Platform]) -> Result<Files> {
    let mut files = Files::new();
    for &platform in platforms {
        let mut library = library::build(platform, &library::FMU)?;
        slot::fill(&mut library, &scene.packaged).map_err(|reason| anyhow!(reason))?;
        match platform {
            Platform::Linux64 | Platform::Aarch64Linux => report_glibc(platform, &library)?,
            Platform::Win64 => imports::check(&library)?,
            Platform::Darwin64 => {}
        }
        files.insert(platform.library_path(), library);
    }
    fmu_file::add_texts(&mut files, scene);
    let pictures =
        [("model.png", MODEL_ICON), ("terminalsAndIcons/icon.png", MODEL_ICON), (TERMINAL_ICON_PATH, TERMINAL_ICON)];
    files.extend(pictures.map(|(path, bytes)| (path.to_owned(), bytes.to_vec())));
    files.extend(documentation::PICTURES.map(|(name, bytes)| (format!("documentation/{name}"), bytes.to_vec())));
    licences::add(&mut files, "sliding-contact", licences::FOLDER)?;
    add_reference(&mut files, &scene.packaged)?;
    Ok(files)
}

/// Runs the FMU on this machine for the reference in it.
fn add_reference(files: &mut Files, scene: &slot::Packaged) -> Result<()> {
    // The one for macOS is for x86-64, whatever this Mac is.
    let runs = !cfg!(all(target_os = "macos", target_arch = "aarch64"));
    let library = match files.get(&fmu_file::own_library()).filter(|_| runs) {
        Some(packaged) => packaged.clone(),
        None => {
            let mut library = library::for_this_machine(&library::FMU)?;
            slot::fill(&mut library, scene).map_err(|reason| anyhow!(reason))?;
            library
        }
    };
    // The system takes a library for one that is loaded already where their paths are the same.
    static RUNS: AtomicUsize = AtomicUsize::new(0);
    let run = RUNS.fetch_add(1, Ordering::Relaxed);
    let folder = project::target().join("fmu").join(format!("reference.{}.{run}", std::process::id()));
    reference::add(files, scene, library, &folder)
}

fn report_glibc(platform: Platform, library: &[u8]) -> Result<()> {
    let Some((major, minor)) = glibc::highest(library)? else { return Ok(()) };
    eprintln!("The library for {} needs glibc {major}.{minor} or newer.", platform.folder());
    if (major, minor) > glibc::WANTED {
        let (wanted_major, wanted_minor) = glibc::WANTED;
        eprintln!("warning: distributions with glibc {wanted_major}.{wanted_minor} cannot load it");
    }
    Ok(())
}

/// Refuses platforms that cannot be built here, before one of the others is.
pub(crate) fn check_platforms(platforms: &[Platform]) -> Result<()> {
    match platforms.iter().find_map(|&platform| missing(platform)) {
        Some(reason) => Err(anyhow!(reason)),
        None => Ok(()),
    }
}

/// Software to install before this platform's library can be built here; `None` where nothing is missing.
pub(crate) fn missing(platform: Platform) -> Option<String> {
    if platform == Platform::Linux64 { None } else { toolchain::Toolchain::find(platform).err() }
}

/// Writes a file and the folders above it; the file is complete or absent.
fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let context = || format!("writing {}", path.display());
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).with_context(context)?;
    }
    let path = &project::replaceable(path)?;
    let mut partial = path.as_os_str().to_owned();
    partial.push(format!(".{}.partial", std::process::id()));
    fs::write(&partial, bytes).with_context(context)?;
    fs::rename(&partial, path).with_context(context)
}
