"""Folder of a release: complete, checksums that hold, FMUs without a finding, and a bill of materials of what is linked."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def folder():
    given = os.environ.get("SLIDING_CONTACT_RELEASE")
    if given is None:
        pytest.fail("SLIDING_CONTACT_RELEASE is not set: make the folder with `cargo fmu release -o FOLDER`")
    return Path(given)


def scenes():
    return sorted(path.parent.name for path in ROOT.glob("examples/*/scene.toml"))


def test_the_folder_is_complete(folder):
    names = {path.name for path in folder.iterdir()}
    fmus = {"SlidingContact.fmu"} | {f"SlidingContact.{name}.fmu" for name in scenes()}
    assert fmus == {name for name in names if name.endswith(".fmu")} and len(fmus) > 4
    assert len([name for name in names if name.endswith(".whl")]) == 1
    others = {name for name in names - fmus if not name.endswith(".whl")}
    assert others == {"RELEASE_NOTES.md", "SHA256SUMS", *BILLS}
    assert all(path.stat().st_size > 0 for path in folder.iterdir())


def test_checksums_hold_for_every_file(folder):
    checked = subprocess.run(["sha256sum", "--strict", "-c", "SHA256SUMS"], cwd=folder, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    listed = {line.split("  ", 1)[1] for line in (folder / "SHA256SUMS").read_text().splitlines()}
    assert listed == {path.name for path in folder.iterdir()} - {"SHA256SUMS"}


def test_every_fmu_is_valid(folder):
    for path in sorted(folder.glob("*.fmu")):
        assert validate_fmu(str(path)) == [], path.name


def linked(package, profile):
    """Packages linked into a library on this platform: those that cargo compiles for it when it builds the library as it is shipped.

    Macros and build scripts are compiled for the machine that builds, whose units name no platform.
    """
    command = ["cargo", "rustc", "--unit-graph", "-Zunstable-options", "--locked", "--package", package, "--lib"]
    command += ["--crate-type", "cdylib", "--profile", profile, "--target", "x86_64-unknown-linux-gnu"]
    environment = {**os.environ, "RUSTC_BOOTSTRAP": "1"}
    graph = json.loads(subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=True).stdout)
    units, found, seen, waiting = graph["units"], set(), set(), list(graph["roots"])
    while waiting:
        at = waiting.pop()
        unit = units[at]
        if at in seen or unit["platform"] is None or unit["mode"] != "build":
            continue
        seen.add(at)
        waiting.extend(each["index"] for each in unit["dependencies"])
        # name@version, or the folder's name alone where that is the package's: #version.
        name, version = unit["pkg_id"].rsplit("#", 1)
        found.add(tuple(version.split("@")) if "@" in version else (name.rsplit("/", 1)[1], version))
    return {each for each in found if each[0] != package}


BILLS = {"sbom.cdx.json": ("sliding-contact", "fmu"), "sbom.python.cdx.json": ("sliding-contact-python", "wheel")}


@pytest.mark.parametrize("name", BILLS)
def test_the_bill_lists_exactly_what_is_linked(folder, name):
    package, profile = BILLS[name]
    bill = json.loads((folder / name).read_text())
    assert bill["bomFormat"] == "CycloneDX" and bill["specVersion"] == "1.5"
    assert bill["metadata"]["component"]["name"] == package
    listed = {(each["name"], each["version"]) for each in bill["components"]}
    assert len(listed) == len(bill["components"])
    assert listed == linked(package, profile)
    names = {name for name, _ in listed}
    for own in ("numerics", "scene", "elasticity", "conduction", "contact", "model", "steady"):
        assert f"sliding-contact-{own}" in names
    assert {"faer", "nalgebra", "libm", "libc", "pulp"} <= names
    if package == "sliding-contact":
        assert not names & {"toml", "clap", "sliding-contact-exact", "sliding-contact-verification"}
    for each in bill["components"]:
        # What comes from a registry has a checksum there.
        if not each["name"].startswith(("sliding-contact", "fmu-")):
            (digest,) = each["hashes"]
            assert digest["alg"] == "SHA-256" and len(digest["content"]) == 64
        assert each["licenses"] and each["purl"].startswith("pkg:cargo/")
    known = listed | {(package, bill["metadata"]["component"]["version"])}
    assert {each["ref"] for each in bill["dependencies"]} == {f"{name}@{version}" for name, version in known}
