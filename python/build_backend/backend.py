"""Makes the wheel for pip by `cargo fmu wheel` of the source tree around this folder."""

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    if not (ROOT / "Cargo.toml").is_file():
        raise SystemExit(f"{ROOT} is not the source tree of the sliding contact; install from there, or a wheel")
    if shutil.which("cargo") is None:
        raise SystemExit("compiling needs Rust (https://rustup.rs) and a C compiler; install a wheel to do without")
    command = ["cargo", "fmu", "wheel", "--output", os.path.abspath(wheel_directory)]
    run = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if run.returncode:
        raise SystemExit("cargo fmu wheel failed; its messages are above")
    return os.path.basename(run.stdout.strip().splitlines()[-1])


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("there is no source distribution of the folder python alone: the model's sources are around it")
