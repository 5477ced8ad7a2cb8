//! Incomplete Python installations, simulated by shell scripts: tests of every way to an environment with pip.
//!
//! A stand-in for Python implements the few calls that making an environment requires and records each in a list. Its
//! missing parts are named by files beside it. The environments that it makes contain a stand-in of their own, which has pip once
//! a file `pip` is in its package folder.

use super::{Helpers, Interpreter, create};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// `missing NAME`: whether something is missing in the stand-in. `make FOLDER [pip]`: makes an environment.
const COMMON: &str = r#"#!/bin/sh
here='HERE'
echo "$(basename "$0") $*" >> "$here/calls"
missing() { [ -e "$here/no-$1" ]; }
make() {
    mkdir -p "$1/bin" "$1/packages"
    cp "$here/environment" "$1/bin/python"
    if [ "$2" = pip ]; then touch "$1/packages/pip"; fi
}
"#;

const BASE: &str = r#"case "$*" in
    "-c import venv") ! missing venv ;;
    "-c import ensurepip") ! missing ensurepip ;;
    "-c import pip") ! missing pip ;;
    "-m venv --clear --without-pip "*) ! missing venv && make "$5" ;;
    # As on a system that ships ensurepip without its wheels, if so told.
    "-m venv --clear "*) missing wheels && exit 1; make "$4" pip ;;
    "-m pip install --no-input --target "*) ! missing pip && [ "$7" = "pip==25.3" ] && touch "$6/pip" ;;
    "-m virtualenv "*) ! missing virtualenv-module && make "$3" pip ;;
    *) exit 2 ;;
esac
"#;

const ENVIRONMENT: &str = r#"packages="$(dirname "$0")/../packages"
case "$*" in
    "-m pip --version") [ -e "$packages/pip" ] ;;
    "-c import sysconfig"*) echo "$packages" ;;
    *".whl/pip install --no-input pip==25.3") touch "$packages/pip" ;;
    *) exit 2 ;;
esac
"#;

const VIRTUALENV: &str = r#"! missing virtualenv && [ ! -e "$3" ] && [ "$1 $2" = "--python $here/python3" ] && make "$3" pip
"#;

const UV: &str = r#"! missing uv && [ ! -e "$5" ] && [ "$1 $2 $3 $4" = "venv --seed --python $here/python3" ] && make "$5" pip
"#;

/// A folder with the stand-ins, removed in the end.
struct System {
    folder: PathBuf,
    helpers: Helpers,
}

impl Drop for System {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl System {
    fn without(test: &str, missing: &[&str]) -> Self {
        let folder = std::env::temp_dir().join(format!("sliding-contact-limited-{test}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let common = COMMON.replace("HERE", folder.to_str().unwrap());
        for (name, rest) in [("python3", BASE), ("environment", ENVIRONMENT), ("virtualenv", VIRTUALENV), ("uv", UV)] {
            let path = folder.join(name);
            fs::write(&path, format!("{common}{rest}")).unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        }
        for name in missing {
            fs::write(folder.join(format!("no-{name}")), "").unwrap();
        }
        let wheels = if missing.contains(&"wheel") { Vec::new() } else { vec![folder.join("pip-25.3.whl")] };
        let helpers = Helpers { wheels, virtualenv: folder.join("virtualenv"), uv: folder.join("uv") };
        Self { folder, helpers }
    }

    fn environment(&self) -> PathBuf {
        self.folder.join("made")
    }

    /// Makes the environment; what was called for it in the end (but the questions), or the message.
    fn create(&self) -> Result<String, String> {
        let base = Interpreter { path: self.folder.join("python3"), version: (3, 12, 7) };
        create(&base, &self.environment(), &self.helpers).map_err(|error| error.to_string())?;
        let calls = fs::read_to_string(self.folder.join("calls")).unwrap();
        let last = calls.lines().rfind(|call| !call.ends_with("-m pip --version")).unwrap();
        Ok(last.replace(self.folder.to_str().unwrap(), ""))
    }
}

fn last_call(test: &str, missing: &[&str]) -> String {
    let system = System::without(test, missing);
    let call = system.create().unwrap();
    assert!(has_pip(&system.environment()), "{call}");
    call
}

fn has_pip(environment: &Path) -> bool {
    environment.join("packages/pip").exists()
}

#[test]
fn a_whole_interpreter_makes_it_alone() {
    assert_eq!(last_call("whole", &[]), "python3 -m venv --clear /made");
}

#[test]
fn without_ensurepip_the_interpreters_own_pip_is_put_in() {
    for missing in [["ensurepip"], ["wheels"]] {
        let call = last_call(missing[0], &missing);
        assert!(call.starts_with("python3 -m pip install --no-input --target /made/"), "{call}");
    }
}

#[test]
fn without_any_pip_it_comes_from_the_distributions_wheel() {
    let call = last_call("no-pip", &["ensurepip", "pip"]);
    assert_eq!(call, "python /pip-25.3.whl/pip install --no-input pip==25.3");
}

#[test]
fn without_venv_virtualenv_makes_it_as_a_module_or_as_a_program() {
    assert_eq!(last_call("no-venv", &["venv"]), "python3 -m virtualenv /made");
    // The incomplete environment of venv is removed before the next tool starts.
    let missing = ["ensurepip", "pip", "wheel", "virtualenv-module"];
    assert_eq!(last_call("no-module", &missing), "virtualenv --python /python3 /made");
}

#[test]
fn uv_is_the_last_way() {
    let missing = ["ensurepip", "pip", "wheel", "virtualenv-module", "virtualenv"];
    assert_eq!(last_call("no-virtualenv", &missing), "uv venv --seed --python /python3 /made");
}

#[test]
fn where_nothing_helps_one_sentence_says_what_to_type() {
    let nothing = ["venv", "virtualenv-module", "virtualenv", "uv"];
    for (also, remedy) in [
        (&[][..], "PYTHON3 -m pip install virtualenv"),
        (&["pip"], "PYTHON3 -m ensurepip"),
        (&["pip", "ensurepip"], "export PYTHON=PATH_OF_ANOTHER_PYTHON"),
    ] {
        let system = System::without("nothing", &[&nothing[..], also].concat());
        let python = system.folder.join("python3").display().to_string();
        let remedy = remedy.replace("PYTHON3", &python);
        assert_eq!(
            system.create().unwrap_err(),
            format!(
                "Python 3.12.7 at {python} can make no environment with pip in it; type `{remedy}` and run this command again."
            )
        );
        assert!(!system.environment().exists());
    }
}
