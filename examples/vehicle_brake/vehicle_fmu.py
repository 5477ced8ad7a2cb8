"""Packs the vehicle (folder vehicle/, C) as an FMU: the library is compiled here, the model description written from
the one list of variables, and the manoeuvre - speed over time, grade of the road over position - put in as resources.
"""

import hashlib
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from functools import cache
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy

SOURCES = Path(__file__).resolve().parent / "vehicle"
HEADERS = Path(fmpy.__file__).parent / "c-code"  # the FMI headers, as fmpy brings them
IDENTIFIER = "Vehicle"
LINE = re.compile(r'^VARIABLE\((\w+), (\w+), ([-+.\de]+), "([^"]*)", "([^"]*)"\)$', re.MULTILINE)
# SI units by the exponents of their base units.
UNITS = {
    "1": "",
    "kg": 'kg="1"',
    "m": 'm="1"',
    "m2": 'm="2"',
    "s": 's="1"',
    "1/s": 's="-1"',
    "1/s2": 's="-2"',
    "m/s": 'm="1" s="-1"',
    "m/s2": 'm="1" s="-2"',
    "N": 'kg="1" m="1" s="-2"',
    "J": 'kg="1" m="2" s="-2"',
}
PLATFORMS = {
    "Linux": ("linux64", ".so"),
    "Darwin": ("darwin64", ".dylib"),
    "Windows": ("win64", ".dll"),
}


def variables():
    """Rows (name, causality, start, unit, description); a row's index is its value reference."""
    text = (SOURCES / "variables.h").read_text(encoding="utf-8")
    rows = [(name, causality, float(start), unit, about) for name, causality, start, unit, about in LINE.findall(text)]
    if len(rows) != text.count("\nVARIABLE("):
        raise ValueError("variables.h has a line that is not VARIABLE(name, causality, start, \"unit\", \"description\")")
    return rows


def guid():
    """Identifies sources and variables."""
    digest = hashlib.sha256()
    for path in sorted(SOURCES.iterdir()):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return "{" + digest.hexdigest()[:32] + "}"


def model_description():
    rows = variables()
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<fmiModelDescription fmiVersion="2.0" modelName="{IDENTIFIER}" guid="{guid()}"',
        '  description="Longitudinal dynamics of a car with its driver" variableNamingConvention="flat">',
        f'  <CoSimulation modelIdentifier="{IDENTIFIER}" canHandleVariableCommunicationStepSize="true"'
        ' canGetAndSetFMUstate="true" canInterpolateInputs="true"/>',
        "  <UnitDefinitions>",
    ]
    for unit, exponents in UNITS.items():
        lines.append(f'    <Unit name="{unit}"><BaseUnit {exponents}/></Unit>')
    lines += ["  </UnitDefinitions>", "  <ModelVariables>"]
    attributes = {
        "parameter": 'causality="parameter" variability="fixed" initial="exact"',
        "input": 'causality="input" variability="continuous"',
        "output": 'causality="output" variability="continuous" initial="calculated"',
    }
    for reference, (name, causality, start, unit, about) in enumerate(rows):
        value = "" if causality == "output" else f' start="{start!r}"'
        lines.append(
            f'    <ScalarVariable name="{name}" valueReference="{reference}" {attributes[causality]}'
            f' description={quoteattr(about)}><Real unit="{unit}"{value}/></ScalarVariable>'
        )
    outputs = [index + 1 for index, row in enumerate(rows) if row[1] == "output"]
    unknowns = "".join(f'<Unknown index="{index}"/>' for index in outputs)
    lines += [
        "  </ModelVariables>",
        "  <ModelStructure>",
        f"    <Outputs>{unknowns}</Outputs>",
        f"    <InitialUnknowns>{unknowns}</InitialUnknowns>",
        "  </ModelStructure>",
        "</fmiModelDescription>",
    ]
    return "\n".join(lines) + "\n"


def compilers():
    """Commands that may compile C here: what CC names, else the system's compiler, else the one of the environment."""
    if os.environ.get("CC"):
        return [os.environ["CC"].split()]
    found = [[path] for path in map(shutil.which, ("cc", "gcc", "clang")) if path]
    return [*found, [sys.executable, "-m", "ziglang", "cc"]]


@cache
def library():
    """Bytes of the compiled library."""
    # No contraction into fused operations: every compiler gives the same trajectory.
    options = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", f'-DVEHICLE_GUID="{guid()}"', f"-I{HEADERS}"]
    sources = [str(path) for path in sorted(SOURCES.glob("*.c"))]
    reasons = []
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / (IDENTIFIER + PLATFORMS[platform.system()][1])
        for compiler in compilers():
            command = [*compiler, *options, *sources, "-o", str(target), "-lm"]
            try:
                result = subprocess.run(command, capture_output=True, text=True)
            except OSError as error:
                reasons.append(f"{' '.join(compiler)}: {error}")
                continue
            if result.returncode == 0:
                return target.read_bytes()
            reasons.append(f"{' '.join(compiler)}: {result.stderr.strip()}")
    raise RuntimeError("the vehicle could not be compiled; name a C compiler in CC\n" + "\n".join(reasons))


def csv_of(headings, x, y):
    rows = "".join(f"{float(a)!r},{float(b)!r}\n" for a, b in zip(x, y, strict=True))
    return f"{headings}\n{rows}"


def pack(path, manoeuvre):
    """Writes the FMU for a manoeuvre (see manoeuvres.py)."""
    folder, ending = PLATFORMS[platform.system()]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", model_description())
        archive.writestr(f"binaries/{folder}/{IDENTIFIER}{ending}", library())
        archive.writestr("resources/speed.csv", csv_of("time_s,speed_m_per_s", *manoeuvre.speed))
        archive.writestr("resources/road.csv", csv_of("position_m,grade", *manoeuvre.road))
    return path
