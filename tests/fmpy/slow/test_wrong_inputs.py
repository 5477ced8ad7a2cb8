"""Ten wrong inputs and more for every command of `cargo fmu`.

Each is refused before anything is done: with a message that names file, line or variable, value and what is accepted, a status other
than 0, and no file written, replaced or left half-written.
"""

import os
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT, file_of

SECONDS = 60.0

# Files that stand in the folder of every case.
FILES = {
    "in.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.2,36,4\n1,0,4\n",
    "unit.csv": "time [s],sliding_velocity [kN],normal_load [kN]\n0,36,0\n1,36,4\n",
    "bare.csv": "time [s],sliding_velocity,normal_load [kN]\n0,36,0\n1,36,4\n",
    "name.csv": "time [s],pace [km/h],normal_load [kN]\n0,36,0\n1,36,4\n",
    "word.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n1,fast,4\n",
    "nan.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n1,nan,4\n",
    "back.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n2,36,4\n1,36,4\n",
    "twice.csv": "time [s],normal_load [kN],normal_load [N]\n0,36,0\n1,36,4\n",
    "short.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n1,36\n",
    "one.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n",
    "rowless.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n",
    "empty.csv": "",
    "binary.csv": b"\xff\xfe\x00\x01\n\x80",
    "huge.csv": "time [s],sliding_velocity [m/s],normal_load [N]\n0,1e300,1\n1,1,1\n",
    "pull.csv": "time [s],sliding_velocity [m/s],normal_load [N]\n0,1,-1\n1,1,-1\n",
    "late.csv": "time [s],contact_temperature [degC]\n1000,20\n2000,30\n",
    "output.csv": "time [s],brake_temperature [degC]\n0,20\n1,30\n",
    "cycle.csv": "time [s],speed [km/h]\n0,0\n10,36\n",
    "cycle_bare.csv": "time,speed\n0,0\n10,36\n",
    "cycle_fast.csv": "time [s],speed [km/h]\n0,0\n10,1000\n",
    "cycle_back.csv": "time [s],speed [km/h]\n0,0\n10,-36\n",
    "cycle_one.csv": "time [s],speed [km/h]\n0,0\n",
    "design.csv": "punch.width\n0.1\n0.11\n",
    "design_mm.csv": "punch.widht [mm]\n100\n",
    "design_name.csv": "punch.widht\n0.1\n",
    "design_unit.csv": "punch.width [kN]\n0.1\n",
    "design_twice.csv": "punch.width,punch.width\n0.1,0.1\n",
    "design_rowless.csv": "punch.width\n",
    "design_depth.csv": "width [mm]\n0.1\n",
    "design_short.csv": "punch.width,punch.height\n0.1\n",
    "design_factor.csv": "normal_laod.factor\n0.1\n",
    "design_output.csv": "wear_depth\n0.1\n",
    "design_input.csv": "normal_load [N]\n100\n",
    "design_comma.csv": "punch.width\n0,1\n",
    "comma.csv": "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n1,\"36,5\",4\n",
    "table.toml": 'name = "mine"\n[contact.friction_table]\npoints = 3\nspeed = [0, 1]\ncoefficient = [0.4, 0.3, 0.2]\n',
    "tests.csv": "load [N],speed [m/s],distance [m],volume [mm3]\n10,0.1,1000,0.1\n20,0.1,1000,0.2\n40,0.1,1000,0.4\n",
    "tests_unit.csv": "load [m/s],speed [m/s],distance [m],volume [mm3]\n10,0.1,1000,0.1\n",
    "tests_name.csv": "force [N],speed [m/s],distance [m],volume [mm3]\n10,0.1,1000,0.1\n",
    "tests_missing.csv": "load [N],speed [m/s],distance [m]\n10,0.1,1000\n",
    "tests_word.csv": "load [N],speed [m/s],distance [m],volume [mm3]\n10,0.1,1000,0.1\nheavy,0.1,1000,0.2\n",
    "tests_zero.csv": "load [N],speed [m/s],distance [m],volume [mm3]\n10,0.1,1000,0\n",
    "scene.toml": 'name = "mine"\n[punch]\nmaterial = "brake_lining"\n[strip]\nmaterial = "grey_cast_iron"\n',
    "name.toml": 'name = "mine"\n[punch]\nwidht = 0.1\n',
    "unit.toml": 'name = "mine"\n[punch]\nwidth = "80 kN"\n',
    "value.toml": 'name = "mine"\n[punch]\nwidth = -1\n',
    "item.toml": 'name = "mine"\n[solver]\nfidelity = "best"\n',
    "type.toml": 'name = "mine"\n[punch]\nwidth = true\n',
    "syntax.toml": 'name = "mine"\n[punch\nwidth = 1\n',
    "material.toml": 'name = "mine"\n[punch]\nmaterial = "cheese"\n',
    "empty.toml": "",
    "no.fmu": "this is no archive",
    "kept.csv": "mine\n",
    "clock.csv": "time [s],sliding_velocity [m/s],normal_load [N]\n24:61,1,1\n24:62,1,1\n",
    "hole.csv": "time [s],sliding_velocity [m/s],normal_load [N]\n0,1,1\n1,,1\n",
    "same.csv": "time [s],sliding_velocity [m/s],normal_load [N]\n0,1,1\n0,1,1\n",
    "untimed.csv": "sliding_velocity [m/s],normal_load [N]\n1,1\n2,1\n",
    "measured_unit.csv": "time [s],contact_temperature [MPa]\n0,20\n1,30\n",
    "cycle_hole.csv": "time [s],speed [km/h]\n0,0\n1,\n",
    "cycle_name.csv": "time [s],pace [km/h]\n0,0\n1,5\n",
    "design_cells.csv": "solver.cells\n3.5\n",
    "design_element.csv": "contact.friction_table.speed[20]\n1\n",
    "tests_loss.csv": "load [N],speed [m/s],distance [m],volume [mm3]\n10,0.1,1000,-0.1\n",
    "order.toml": 'name = "mine"\n[contact.friction_table]\npoints = 3\nspeed = [0, 2, 1]\ncoefficient = [0.4, 0.3, 0.2]\n',
    "unused.toml": 'name = "mine"\n[contact.friction_table]\npoints = 0\nspeed = [0, 1, 2]\ncoefficient = [0.4, 0.3, 0.2]\n',
    "infinite.toml": 'name = "mine"\n[punch]\nwidth = inf\n',
    "kelvin.toml": 'name = "mine"\nambient_temperature = "-300 degC"\n',
    "result.toml": 'name = "mine"\nwear_depth = "1 mm"\n',
}

# The scene in a file, for the commands that take one: what is wrong, and what the message says.
SCENES = [
    ("disc_break", ["there is no scene \"disc_break\"", "disc_brake", "pin_on_disk"]),
    ("none.toml", ["none.toml", "cannot be read"]),
    ("scen.toml", ["scen.toml", "cannot be read", "did you mean scene.toml?"]),
    ("no.fmu", ["no.fmu", "is an FMU", "scene file"]),
    ("table.toml", ["table.toml", "line 4", "contact.friction_table.speed", "has 2 elements", "points = 3"]),
    ("name.toml", ["name.toml", "line 3", "punch.widht", "did you mean punch.width?"]),
    ("unit.toml", ["unit.toml", "line 3", "punch.width", "\"80 kN\"", "accepted are m, mm"]),
    ("value.toml", ["value.toml", "line 3", "punch.width", "-1 m", "from 0.000001 m to 10 m"]),
    ("item.toml", ["item.toml", "line 3", "solver.fidelity", "\"best\"", "auto, lumped, line"]),
    ("type.toml", ["type.toml", "line 3", "punch.width", "true", "must be a number"]),
    ("syntax.toml", ["syntax.toml", "line 2"]),
    ("material.toml", ["material.toml", "line 3", "punch.material", "cheese", "grey_cast_iron"]),
    ("empty.toml", ["empty.toml", "name"]),
    ("order.toml", ["contact.friction_table.speed[3] = 1 m/s must be above contact.friction_table.speed[2] = 2 m/s"]),
    ("unused.toml", ["contact.friction_table", "has no effect while contact.friction_table.points = 0"]),
    ("infinite.toml", ["infinite.toml", "line 3", "punch.width: inf is not a finite number"]),
    ("kelvin.toml", ["kelvin.toml", "line 2", "-300 degC", "from -272.15 degC to 9726.85 degC"]),
    ("result.toml", ["result.toml", "line 2", "wear_depth", "calculated"]),
    (".", ["\".\"", "disc_brake"]),
]
SETTINGS = [
    ("--set punch.widht=1", ["punch.widht", "did you mean punch.width?"]),
    ("--set punch.width", ["KEY=VALUE"]),
    ("--set punch.width=0,08", ["punch.width", "\"0,08\"", "numbers have a decimal point"]),
    ("--set punch.width=80:kN", ["punch.width", "80 kN", "accepted are m, mm"]),
    ("--set punch.width=-1", ["punch.width", "-1 m", "from 0.000001 m to 10 m"]),
    ("--set wear_depth=1", ["wear_depth"]),
    ("--set name=x", ["name is no variable of the scene"]),
    ("--set solver.cells=33.5", ["solver.cells", "33.5", "must be an integer"]),
    ("--set contact.friction_table.speed[17]=1", ["contact.friction_table.speed has the elements 1 to 16"]),
]


def scenes(command):
    return [(f"{command} {scene}", parts) for scene, parts in SCENES]


def settings(command):
    return [(f"{command} {setting}", parts) for setting, parts in SETTINGS]


PLATFORMS = ["linux64, win64, aarch64-linux, darwin64"]
WRONG = {
    "man": [
        ("man docs", ["docs"]),
        ("man -o kept.csv", ["kept.csv", "folder"]),
        ("man -o kept.csv/man", ["kept.csv", "is no folder"]),
        ("man --output=kept.csv", ["--output kept.csv", "folder"]),
        ("man -o", ["--output <FOLDER>", "value"]),
        ("man --output=", ["--output <FOLDER>", "value"]),
        ("man --outptu here", ["--outptu"]),
        ("man -o here -o there", ["--output <FOLDER>", "multiple times"]),
        ("man --json", ["--json"]),
        ("man --open", ["--open"]),
    ],
    "package": [
        *scenes("package"),
        ("package clutch -o clutch.zip", ["clutch.zip", ".fmu is written, not .zip"]),
        ("package clutch --ssv -o clutch.fmu", ["clutch.fmu", ".ssv is written, not .fmu"]),
        ("package --ssv --platform win64", ["--ssv", "--platform"]),
        ("package --platform atari", ["atari", *PLATFORMS]),
        ("package clutch disc_brake", ["disc_brake"]),
        ("package --write-description clutch", ["--write-description"]),
        ("package scene.toml -o folder.fmu", ["folder.fmu", "name a file"]),
        ("package scene.toml --ssv -o kept.csv/scene.ssv", ["kept.csv"]),
        ("package --platform darwin64", ["darwin64", "macOS"]),
    ],
    "wheel": [
        ("wheel --platform atari", ["atari", *PLATFORMS]),
        ("wheel --platform", ["--platform"]),
        ("wheel --platform darwin64", ["darwin64", "macOS"]),
        ("wheel --platform linux64,win64", ["linux64,win64", *PLATFORMS]),
        ("wheel -o", ["--output <FOLDER>"]),
        ("wheel -o kept.csv", ["kept.csv", "folder"]),
        ("wheel -o kept.csv/dist", ["kept.csv"]),
        ("wheel -o wheel.csv", ["wheel.csv", "folder"]),
        ("wheel disc_brake", ["disc_brake"]),
        ("wheel --json", ["--json"]),
        ("wheel --output a --output b", ["--output"]),
    ],
    "release": [
        ("release --platform atari", ["atari", *PLATFORMS]),
        ("release --platform", ["--platform"]),
        ("release --platform darwin64", ["darwin64", "macOS"]),
        ("release --platform linux64,darwin64", ["darwin64", "macOS"]),
        ("release -o", ["--output <FOLDER>"]),
        ("release -o .", ["not empty", "new folder"]),
        ("release -o kept.csv", ["kept.csv", "folder"]),
        ("release -o kept.csv/dist", ["kept.csv"]),
        ("release -o release.csv", ["release.csv", "folder"]),
        ("release disc_brake", ["disc_brake"]),
        ("release --json", ["--json"]),
    ],
    "run": [
        ("run disc_break", ["disc_break", "disc_brake", "vehicle_brake"]),
        ("run --scene disc_break", ["\"disc_break\"", "pin_on_disk"]),
        ("run --scene name.toml", ["name.toml", "line 3", "punch.widht", "did you mean punch.width?"]),
        ("run --scene clutch", ["contact.geometry = annular"]),
        ("run clutch --scene disc_brake", ["contact.geometry = line"]),
        ("run --fmu none.fmu", ["none.fmu"]),
        ("run --fmu no.fmu", ["no.fmu"]),
        ("run --cycle none", ["--cycle none", "udds, hwfet"]),
        ("run --cycle cycle_bare.csv", ["cycle_bare.csv", "does not say its unit", "speed [m/s or km/h"]),
        ("run --cycle cycle_fast.csv", ["cycle_fast.csv", "line 3", "1000 km/h", "100 m/s"]),
        ("run --cycle cycle_back.csv", ["cycle_back.csv", "line 3", "-10 m/s"]),
        ("run --cycle cycle_one.csv", ["cycle_one.csv", "two rows"]),
        ("run clutch --cycle hwfet", ["--cycle hwfet", "clutch", "disc_brake"]),
        ("run --step 0", ["--step", "0 s", "above 0"]),
        ("run --step -1", ["--step -1 s", "above 0"]),
        ("run --step abc", ["--step", "abc", "must be a number"]),
        ("run --step 0,1", ["--step", "0,1", "numbers have a decimal point"]),
        ("run --step nan", ["--step NaN s", "above 0 s"]),
        ("run --cycle cycle_hole.csv", ["cycle_hole.csv, lines 2 to 3", "speed has no value"]),
        ("run --cycle cycle_name.csv", ["cycle_name.csv", "pace [km/h]", "speed"]),
        ("run --cycle .", ["--cycle .", "udds, hwfet"]),
        ("run hot_spots --step 0.1", ["--step 0.1", "hot_spots", "disc_brake takes it"]),
        ("run -o kept.csv", ["kept.csv", "folder"]),
        ("run published --scene clutch", ["--scene", "published"]),
    ],
    "test": [
        ("test --only", ["--only", "--importers", "--platforms"]),
        ("test --fast --importers", ["--fast", "--importers"]),
        ("test --fast --platforms", ["--fast", "--platforms"]),
        ("test --fast --all", ["--fast", "--all"]),
        ("test --fast --only", ["--fast", "--only"]),
        ("test --only --all", ["--only", "--all"]),
        ("test --importer", ["--importer", "--importers"]),
        ("test fmpy", ["fmpy"]),
        ("test --fast=yes", ["--fast"]),
        ("test --fast --fast", ["--fast"]),
        ("test --seconds 3", ["--seconds"]),
    ],
    "bench": [
        *scenes("bench"),
        ("bench --lines", ["--lines", "--line"]),
        ("bench disc_brake clutch", ["clutch"]),
        ("bench --cells 9", ["--cells"]),
        ("bench --line clutch", ["--line", "[SCENE]"]),
    ],
    "realtime": [
        ("realtime --contact warm", ["warm", "cold, heat"]),
        ("realtime --cells 0", ["--cells", "0"]),
        ("realtime --cells 2000", ["--cells", "2000", "a whole number from 3 to 1025"]),
        ("realtime --cells nine", ["--cells", "nine", "a whole number from 3 to 1025"]),
        ("realtime --cells -1", ["--cells", "-1", "a whole number from 3 to 1025"]),
        ("realtime --speed 0", ["--speed 0", "above 0 and at most 100"]),
        ("realtime --speed -1", ["--speed -1", "above 0 and at most 100"]),
        ("realtime --speed 1e300", ["--speed 1e300", "above 0 and at most 100"]),
        ("realtime --seconds 1e300", ["--seconds 1e300", "from 0.001 to 100000"]),
        ("realtime --seconds 0", ["--seconds 0", "from 0.001"]),
        ("realtime --seconds -1", ["--seconds -1", "from 0.001"]),
        ("realtime --seconds nan", ["--seconds", "NaN"]),
        ("realtime --seconds inf", ["--seconds", "inf"]),
        ("realtime --speed fast", ["--speed", "fast"]),
        ("realtime --speed nan", ["--speed", "NaN"]),
        ("realtime -o kept.csv", ["kept.csv", "folder"]),
        ("realtime disc_brake", ["disc_brake"]),
    ],
    "reference": [
        ("reference docs", ["docs"]),
        ("reference -o kept.csv", ["kept.csv", "folder"]),
        ("reference -o kept.csv/reference", ["kept.csv", "is no folder"]),
        ("reference --output=kept.csv", ["--output kept.csv", "folder"]),
        ("reference -o", ["--output <FOLDER>", "value"]),
        ("reference --output=", ["--output <FOLDER>", "value"]),
        ("reference --outptu here", ["--outptu"]),
        ("reference -o here -o there", ["--output <FOLDER>", "multiple times"]),
        ("reference --json", ["--json"]),
        ("reference --open", ["--open"]),
    ],
    "site": [
        ("site docs", ["docs"]),
        ("site -o kept.csv", ["kept.csv", "folder"]),
        ("site -o kept.csv/site", ["kept.csv", "is no folder"]),
        ("site --output=kept.csv", ["--output kept.csv", "folder"]),
        ("site -o", ["--output <FOLDER>", "value"]),
        ("site --output=", ["--output <FOLDER>", "value"]),
        ("site --outptu here", ["--outptu"]),
        ("site -o here -o there", ["--output <FOLDER>", "multiple times"]),
        ("site --json", ["--json"]),
        ("site --open", ["--open"]),
    ],
    "soak": [
        ("soak --lumped -1", ["-1"]),
        ("soak --lumped many", ["--lumped", "many", "a whole number from 0"]),
        ("soak --states -3", ["--states", "-3", "a whole number from 0"]),
        ("soak --lumped 1.5", ["--lumped", "1.5"]),
        ("soak --line 1e6", ["--line", "1e6"]),
        ("soak --states 99999999999999999999999", ["--states", "99999999999999999999999"]),
        ("soak --rounds nan", ["--rounds", "nan"]),
        ("soak --rounds", ["--rounds <ROUNDS>", "value"]),
        ("soak --short --lumped 5", ["--short", "--lumped"]),
        ("soak --cells 5", ["--cells"]),
        ("soak disc_brake", ["disc_brake"]),
    ],
    "simulate": [
        *scenes("simulate"),
        *settings("simulate disc_brake"),
        ("simulate", ["<SCENE>"]),
        ("simulate disc_brake --inputs none.csv", ["none.csv"]),
        ("simulate disc_brake --inputs unit.csv", ["unit.csv", "line 1", "sliding_velocity [kN]", "accepted are m/s, km/h"]),
        ("simulate disc_brake --inputs bare.csv", ["bare.csv", "line 1", "sliding_velocity", "does not say its unit", "km/h"]),
        ("simulate disc_brake --inputs name.csv --strict", ["name.csv", "pace [km/h]"]),
        ("simulate disc_brake --inputs word.csv", ["word.csv", "line 3", "sliding_velocity", "\"fast\""]),
        ("simulate disc_brake --inputs nan.csv", ["nan.csv, lines 2 to 3", "sliding_velocity has no value"]),
        ("simulate disc_brake --inputs back.csv", ["back.csv", "line 4", "time", "1", "2"]),
        ("simulate disc_brake --inputs twice.csv", ["twice.csv", "line 1", "column 3", "normal_load", "column 2"]),
        ("simulate disc_brake --inputs same.csv", ["same.csv, line 3", "a run needs a time interval"]),
        ("simulate disc_brake --inputs hole.csv", ["hole.csv, lines 2 to 3", "sliding_velocity has no value"]),
        ("simulate disc_brake --inputs clock.csv", ["clock.csv, line 2, column 1 (time [s])", "24:61", "is no time of day"]),
        ("simulate disc_brake --inputs untimed.csv", ["untimed.csv, line 1: no column time", "found are sliding_velocity"]),
        ("simulate disc_brake --inputs .", [". is a folder; a CSV file is needed"]),
        ("simulate disc_brake --measured measured_unit.csv", ["measured_unit.csv, line 1, column 2", "MPa", "accepted are K, degC"]),
        ("simulate disc_brake --at -1", ["at = -1 s is outside of the simulated time, 0 s to 93 s"]),
        ("simulate disc_brake --step 1e-300", ["93 s in steps of at most 1e-300 s", "at most 2e6"]),
        ("simulate disc_brake --inputs short.csv", ["short.csv", "line"]),
        ("simulate disc_brake --inputs one.csv", ["one.csv", "one row", "two"]),
        ("simulate disc_brake --inputs rowless.csv", ["rowless.csv", "no row"]),
        ("simulate disc_brake --inputs empty.csv", ["empty.csv", "time [s"]),
        ("simulate disc_brake --inputs binary.csv", ["binary.csv"]),
        ("simulate disc_brake --inputs huge.csv", ["huge.csv", "line 2", "sliding_velocity", "1e300"]),
        ("simulate disc_brake --inputs in.csv --measured output.csv", ["output.csv has the column time only", "inputs and outputs of the FMU"]),
        ("simulate disc_brake --inputs in.csv --measured late.csv", ["late.csv", "1000"]),
        ("simulate disc_brake --inputs in.csv --at 5", ["at = 5 s is outside"]),
        ("simulate disc_brake --inputs in.csv --at abc", ["--at", "abc"]),
        ("simulate disc_brake --inputs in.csv --step 0", ["--step", "0 s must be above 0 s"]),
        ("simulate disc_brake --inputs in.csv --step 5:kN", ["--step", "5 kN", "accepted are s, min, h, ms"]),
        ("simulate disc_brake --inputs in.csv --step 1e-9", ["1e-9 s", "at most 2e6"]),
        ("simulate disc_brake --inputs in.csv -o in.csv", ["--output in.csv", "read"]),
        ("simulate disc_brake --inputs in.csv --plot in.csv", ["in.csv"]),
        ("simulate disc_brake --inputs in.csv -o out.xlsx", ["out.xlsx", ".csv or .parquet is written, not .xlsx"]),
        ("simulate disc_brake --inputs in.csv --plot out.jpg", ["out.jpg", "svg"]),
        ("simulate disc_brake --inputs in.csv -o kept.csv/out.csv", ["kept.csv is no folder"]),
        ("simulate scene.toml --inputs in.csv -o scene.toml", ["scene.toml"]),
    ],
    "steady": [
        *scenes("steady"),
        *settings("steady reciprocating_punch"),
        ("steady reciprocating_punch --cells 0", ["--cells", "0"]),
        ("steady reciprocating_punch --cells 2", ["--cells", "2", "a whole number from 3 to 1025"]),
        ("steady reciprocating_punch --cells 100000", ["--cells", "100000"]),
        ("steady reciprocating_punch --cells nine", ["--cells", "nine", "a whole number from 3 to 1025"]),
        ("steady reciprocating_punch --cells -5", ["--cells", "-5", "a whole number from 3 to 1025"]),
        ("steady disc_brake --return-speed 3", ["nominal.stroke = 0 m"]),
        ("steady reciprocating_punch --return-speed 0", ["return_speed = 0 m/s", "above 0"]),
        ("steady reciprocating_punch --return-speed 1e300", ["return_speed = 1e300 m/s", "at most 10000 m/s"]),
        ("steady reciprocating_punch --return-speed fast", ["--return-speed", "fast", "must be a number"]),
        ("steady reciprocating_punch --return-speed nan", ["return_speed", "NaN"]),
        ("steady disc_brake --return-speed 3", ["nominal.stroke = 0 m"]),
        ("steady reciprocating_punch -o st.jpg", ["st.jpg", ".svg, .pdf, .png are drawn, not .jpg"]),
        ("steady reciprocating_punch -o kept.csv", ["kept.csv", ".svg, .pdf, .png are drawn, not .csv"]),
        ("steady reciprocating_punch -o kept.csv/st.svg", ["kept.csv is no folder"]),
        ("steady reciprocating_punch --law --cold", ["--law", "--cold"]),
    ],
    "cycles": [
        *scenes("cycles"),
        *settings("cycles reciprocating_punch"),
        ("cycles disc_brake", ["nominal.stroke = 0 m"]),
        ("cycles reciprocating_punch --cycles 0", ["0", "cycle"]),
        ("cycles reciprocating_punch --cycles nan", ["NaN", "cycle"]),
        ("cycles reciprocating_punch --cycles ten", ["--cycles", "ten", "must be a number"]),
        ("cycles reciprocating_punch --cells -3", ["--cells", "-3", "a whole number from 3 to 1025"]),
        ("cycles reciprocating_punch --set nominal.load=0", ["nominal.load = 0 N", "above 0 N"]),
        ("cycles reciprocating_punch --set nominal.velocity=0", ["nominal.velocity = 0 m/s"]),
        ("cycles reciprocating_punch --tolerance 0", ["tolerance = 0 must be"]),
        ("cycles reciprocating_punch --tolerance 7", ["tolerance = 7 must be"]),
        ("cycles reciprocating_punch --cells 0", ["--cells", "0"]),
        ("cycles reciprocating_punch --cells 100000", ["--cells", "100000"]),
        ("cycles reciprocating_punch -o c.jpg", ["c.jpg", ".svg, .pdf, .png are drawn, not .jpg"]),
        ("cycles reciprocating_punch -o kept.csv/c.svg", ["kept.csv is no folder"]),
    ],
    "tables": [
        *scenes("tables"),
        ("tables --tolerance 0", ["--tolerance", "from 1e-10 to 0.5"]),
        ("tables --tolerance 7", ["--tolerance", "from 1e-10 to 0.5"]),
        ("tables --tolerance 1e-300", ["--tolerance", "1e-300", "from 1e-10 to 0.5"]),
        ("tables --tolerance five", ["--tolerance", "five", "from 1e-10 to 0.5"]),
        ("tables --tolerance nan", ["--tolerance", "from 1e-10 to 0.5"]),
        ("tables disc_brake clutch", ["clutch"]),
    ],
    "verify": [
        ("verify --filter nosuchproblem", ["nosuchproblem"]),
        ("verify --filter", ["--filter"]),
        ("verify --filter=", ["--filter", "value is required"]),
        ("verify galin", ["galin"]),
        ("verify --tolerance 1", ["--tolerance"]),
        ("verify --jsn", ["--jsn", "--json"]),
        ("verify --json=yes", ["--json"]),
        ("verify --filter a --filter b", ["--filter"]),
        ("verify -o out.csv", ["-o"]),
        ("verify --cells 3", ["--cells"]),
        ("verify --list", ["--list"]),
    ],
    "batch": [
        ("batch none.csv --fmu FMU --inputs in.csv -o out.csv", ["none.csv"]),
        ("batch design.csv --fmu none.fmu --inputs in.csv -o out.csv", ["none.fmu"]),
        ("batch design.csv --fmu no.fmu --inputs in.csv -o out.csv", ["no.fmu", "zip archive"]),
        ("batch design.csv --scene disc_break --inputs in.csv -o out.csv", ["disc_break", "disc_brake"]),
        ("batch design.csv --scene name.toml --inputs in.csv -o out.csv", ["name.toml", "line 3", "punch.widht"]),
        ("batch design.csv --inputs in.csv -o out.csv", ["--scene", "--fmu", "design.csv"]),
        ("batch in.csv --fmu FMU -o out.csv", ["in.csv, line 1, column 1 (time [s])", "--inputs takes a file of inputs over time"]),
        ("batch scene.toml --fmu FMU -o out.csv", ["scene.toml is a scene file", "--scene takes it"]),
        ("batch design.csv --fmu scene.toml -o out.csv", ["scene.toml is a scene file", "--scene takes it"]),
        ("batch design.csv --fmu FMU --inputs bare.csv -o out.csv", ["bare.csv, line 1, column 2", "does not say its unit", "sliding_velocity [m/s"]),
        ("batch design.csv --fmu FMU -o out.csv --step 20parsecs", ["--step", "parsecs", "accepted are s, min, h, ms"]),
        ("batch design.csv --fmu FMU -o out.csv --peak punch.width", ["--peak punch.width is a parameter", "accepted are outputs"]),
        ("batch design_depth.csv --fmu FMU -o out.csv", ["design_depth.csv, line 1, column 1 (width [mm])", "did you mean punch.width?", "accepted are parameters"]),
        ("batch design.csv --fmu FMU --scene disc_brake --inputs in.csv -o out.csv", ["--scene", "--fmu"]),
        ("batch design.csv --fmu FMU", ["--output"]),
        ("batch design.csv --fmu FMU -o kept.csv", ["kept.csv", "no result of a batch", "--replace"]),
        ("batch design_input.csv --fmu FMU -o out.csv", ["design_input.csv", "normal_load", "accepted are normal_load.factor"]),
        ("batch design_comma.csv --fmu FMU -o out.csv", ["design_comma.csv, line 2", "numbers have a decimal point"]),
        ("batch design.csv --fmu FMU --inputs comma.csv -o out.csv", ["comma.csv, line 3", "\"36,5\"", "numbers have a decimal point"]),
        ("batch design_name.csv --fmu FMU --inputs in.csv -o out.csv", ["design_name.csv", "punch.widht", "did you mean punch.width?"]),
        ("batch design_mm.csv --fmu FMU --inputs in.csv -o out.csv", ["design_mm.csv", "punch.widht [mm]", "did you mean punch.width?"]),
        ("batch design_unit.csv --fmu FMU --inputs in.csv -o out.csv", ["design_unit.csv", "punch.width [kN]", "accepted are m, mm"]),
        ("batch design_twice.csv --fmu FMU --inputs in.csv -o out.csv", ["design_twice.csv", "punch.width"]),
        ("batch design_rowless.csv --fmu FMU --inputs in.csv -o out.csv", ["design_rowless.csv", "no row"]),
        ("batch design_short.csv --fmu FMU --inputs in.csv -o out.csv", ["design_short.csv", "line"]),
        ("batch design_factor.csv --fmu FMU --inputs in.csv -o out.csv", ["design_factor.csv", "normal_laod.factor", "normal_load.factor"]),
        ("batch design_output.csv --fmu FMU --inputs in.csv -o out.csv", ["design_output.csv", "wear_depth", "parameter"]),
        ("batch design.csv --fmu FMU --inputs unit.csv -o out.csv", ["unit.csv", "line 1", "sliding_velocity [kN]"]),
        ("batch design.csv --fmu FMU --inputs word.csv -o out.csv", ["word.csv", "line 3", "\"fast\""]),
        ("batch design.csv --fmu FMU --inputs back.csv -o out.csv", ["back.csv", "line 4"]),
        ("batch design.csv --fmu FMU --inputs one.csv -o out.csv", ["one.csv"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o design.csv", ["design.csv", "read"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.xlsx", [".csv or .parquet is written, not .xlsx"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --step 0", ["--step", "0"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --step -1", ["--step -1 s", "above 0 s"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --step 0.3", ["--step", "0.3"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --step 0.1 --every 0.15", ["--every", "--step"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --jobs 0", ["--jobs", "0", "a whole number from 1 to 1024"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --jobs -1", ["--jobs", "-1", "a whole number from 1 to 1024"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --jobs 1e3", ["--jobs", "1e3", "a whole number from 1 to 1024"]),
        ("batch design_element.csv --fmu FMU -o out.csv", ["design_element.csv, line 1, column 1", "speed[20]", "accepted are"]),
        ("batch . --fmu FMU -o out.csv", [". is a folder; a CSV file is needed"]),
        ("batch design.csv --fmu FMU -o out.csv --inputs .", [". is a folder; a CSV file is needed"]),
        ("batch design.csv --fmu FMU -o out.csv --record normal_laod", ["--record normal_laod", "normal_load"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --record wear_dpeth", ["--record", "wear_dpeth", "did you mean wear_depth"]),
        ("batch design.csv --fmu FMU --inputs in.csv -o out.csv --interpolation cubic", ["cubic", "hold, sample, linear"]),
        ("batch --example sweeps", ["sweeps", "sweep"]),
        ("batch --example sweep --step 3", ["--step"]),
    ],
    "fit": [
        ("fit none.csv", ["none.csv"]),
        ("fit tests.csv --scene disc_break", ["\"disc_break\"", "pin_on_disk"]),
        ("fit tests.csv --scene name.toml", ["name.toml", "line 3", "punch.widht"]),
        ("fit tests.csv --parameters load", ["load"]),
        ("fit tests.csv --confidence 1", ["--confidence 1", "below 1"]),
        ("fit tests.csv --confidence nan", ["--confidence NaN", "below 1"]),
        ("fit tests.csv -o kept.csv", ["kept.csv", "folder"]),
        ("fit tests.csv --step 3", ["--step"]),
        ("fit tests_unit.csv", ["tests_unit.csv, line 1", '"load [m/s]"', "accepted are N, kN"]),
        ("fit tests_name.csv", ["tests_name.csv, line 1", "no column load [N or kN", "force [N]"]),
        ("fit tests_missing.csv", ["tests_missing.csv", "no column of a result, as volume"]),
        ("fit tests_word.csv", ["tests_word.csv, line 3", '(load [N]): "heavy" is no number']),
        ("fit tests_zero.csv", ["tests_zero.csv, line 2", '(volume [mm3]): "0"', "above 0"]),
        ("fit tests_loss.csv", ["tests_loss.csv, line 2, column 4 (volume [mm3])", "-0.1", "above 0"]),
        ("fit tests.csv --confidence high", ["--confidence", "high", "must be a number"]),
        ("fit tests.csv --scene no.fmu", ["no.fmu is an FMU", "scene file"]),
        ("fit .", [". is a folder; a CSV file is needed"]),
        ("fit rowless.csv", ["rowless.csv has no row below its header"]),
    ],
    "stability": [
        ("stability --map nosuchmap", ["nosuchmap", "wear-step"]),
        ("stability --map", ["--map"]),
        ("stability --map wear-step --map nosuchmap", ["nosuchmap", "wear-step"]),
        ("stability -o maps.svg", ["maps.svg", "folder"]),
        ("stability -o kept.csv", ["kept.csv", "folder"]),
        ("stability -o kept.csv/maps --map wear-step", ["kept.csv"]),
        ("stability --list --json", ["--list", "--json"]),
        ("stability wear-step", ["wear-step"]),
        ("stability --fine=2", ["--fine"]),
        ("stability --cells 3", ["--cells"]),
    ],
    "chart": [
        ("chart --scene nosuchscene", ["nosuchscene", "hot_punch"]),
        ("chart --scene", ["--scene"]),
        ("chart hot_punch", ["hot_punch"]),
        ("chart -o chart.svg", ["chart.svg", "folder"]),
        ("chart -o kept.csv", ["kept.csv", "folder"]),
        ("chart -o kept.csv/chart --scene hot_punch", ["kept.csv"]),
        ("chart --list --json", ["--list", "--json"]),
        ("chart --quick=1", ["--quick"]),
        ("chart --peers", ["--peers"]),
        ("chart --write-truth --scene nosuchscene", ["nosuchscene", "hot_punch"]),
    ],
    "plan": [
        *scenes("plan"),
        *settings("plan disc_brake"),
        ("plan --tolerance 7", ["--tolerance", "from 1e-10 to 0.5"]),
        ("plan --tolerance -1", ["--tolerance", "from 1e-10 to 0.5"]),
        ("plan disc_brake --inputs none.csv", ["none.csv"]),
        ("plan disc_brake --inputs word.csv", ["word.csv", "line 3", "\"fast\""]),
        ("plan disc_brake --inputs unit.csv", ["unit.csv", "line 1", "sliding_velocity [kN]"]),
        ("plan disc_brake --inputs one.csv", ["one.csv", "two"]),
        ("plan disc_brake --write", ["--write", "--inputs"]),
        ("plan disc_brake --write --inputs in.csv", ["--write", "shipped scene", "examples/disc_brake/scene.toml"]),
        ("plan disc_brake --inputs same.csv", ["same.csv, line 3", "a run needs a time interval"]),
        ("plan disc_brake --inputs .", [". is a folder; a CSV file is needed"]),
    ],
    "golden": [
        ("golden compare lumped_hold", ["\"lumped_hold\"", "lumped_held"]),
        ("golden record lumped_hold", ["\"lumped_hold\"", "lumped_held"]),
        ("golden compare --tolerance 7", ["--tolerance", "7 must be above 0 and at most 0.5"]),
        ("golden compare --tolerance nan", ["--tolerance"]),
        ("golden compare lumped_held --folder nowhere", ["nowhere"]),
        ("golden compare lumped_held --folder kept.csv", ["kept.csv"]),
        ("golden record lumped_held --folder kept.csv", ["kept.csv"]),
        ("golden record lumped_held --tolerance 0.1", ["--tolerance"]),
        ("golden", ["record", "compare"]),
        ("golden check", ["check"]),
        ("golden compare lumped_held lumped_hold", ["\"lumped_hold\"", "lumped_held"]),
    ],
    "fuzz": [
        ("fuzz --target brakes", ["brakes", "calls, states, scenes, batch"]),
        ("fuzz --seed abc", ["--seed", "abc"]),
        ("fuzz --seed -1", ["--seed", "-1", "a whole number from 0 on"]),
        ("fuzz --from -1", ["--from", "-1", "a whole number from 0 on"]),
        ("fuzz --executions 1.5", ["--executions", "1.5", "a whole number from 1 on"]),
        ("fuzz --seed 1", ["--seed", "--target"]),
        ("fuzz --seconds 0", ["--seconds", "0"]),
        ("fuzz --seconds -1", ["--seconds -1 s", "above 0 s"]),
        ("fuzz --seconds nan", ["--seconds", "NaN"]),
        ("fuzz --executions 0", ["--executions", "0"]),
        ("fuzz --executions many", ["--executions", "many"]),
        ("fuzz --limit 0", ["--limit", "0"]),
        ("fuzz --limit nan", ["--limit", "NaN"]),
        ("fuzz disc_brake", ["disc_brake"]),
    ],
}
CASES = [case for cases in WRONG.values() for case in cases]


def needed(variable):
    value = os.environ.get(variable)
    if value is None:
        pytest.fail(f"{variable} is not set: `cargo fmu test --slow` sets it")
    return value


def contents(folder):
    """Every path below a folder, with the bytes and the time of change of a file."""
    kept = {}
    for path in sorted(folder.rglob("*")):
        kept[str(path.relative_to(folder))] = (path.read_bytes(), path.stat().st_mtime_ns) if path.is_file() else None
    return kept


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("wrong")
    for name, content in FILES.items():
        (made / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    (made / "folder.fmu").mkdir()
    return made


@pytest.fixture(scope="module")
def environment():
    """As a user starts it, but for the program of the commands that compute: cargo takes a while to find that it is up to date."""
    own = {**os.environ, "CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")}
    lab = Path(needed("SLIDING_CONTACT_COMMAND")).with_name("fmu-lab")
    return own | ({"SLIDING_CONTACT_LAB": str(lab)} if lab.is_file() else {})


@pytest.mark.parametrize("line, parts", CASES, ids=[line for line, _ in CASES])
def test_it_is_refused_with_what_is_accepted_and_nothing_is_touched(folder, environment, line, parts):
    # A colon stands for a space within an argument.
    arguments = [word.replace(":", " ") if "=" in word or word[0].isdigit() else word for word in line.split()]
    arguments = [str(file_of("disc_brake")) if word == "FMU" else word for word in arguments]
    before = contents(folder)
    command = [needed("SLIDING_CONTACT_COMMAND"), *arguments]
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=SECONDS)
    told = run.stdout + run.stderr
    assert run.returncode not in (0, 101) and run.returncode > 0, told
    assert run.stderr.count("error: ") >= 1 or "Usage:" in told, told
    missing = [part for part in parts if part not in run.stderr]
    assert not missing, f"{missing} in: {told}"
    assert "panicked" not in told and "backtrace" not in told.lower() and "Traceback" not in told, told
    assert contents(folder) == before, sorted(set(contents(folder)) ^ set(before))


def test_every_command_has_ten():
    listed = subprocess.run([needed("SLIDING_CONTACT_COMMAND"), "--help"], capture_output=True, text=True, check=True).stdout
    names = [line.split()[0] for line in listed.split("Commands:")[1].split("Options:")[0].splitlines() if line.startswith("  ") and line[2] != " "]
    assert set(names) - {"help"} == set(WRONG), "every command, and no other"
    assert all(len(cases) >= 10 for cases in WRONG.values())
