"""Numbers of the pages beside what their commands compute now.

    python docs/results.py            # all; or the names of some: `python docs/results.py "run disc_brake" paper`
    python docs/results.py --write    # puts those that differ into the pages

A passage of a page has `{}` for each number. Numbers are equal within one unit of the last digit printed. Times are not compared: the
pages give their date.
"""

import argparse
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NUMBER = re.compile(r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?")
STOP = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.3,36,8\n4,0,8\n5,0,0\n"
CHECKS = {}


class Below(float):
    """A number of which the page states a bound."""


def check(name):
    """Names a generator of (page, passage, number, ...)."""
    return lambda function: CHECKS.setdefault(name, function)


def called(*arguments):
    """What a command of `cargo fmu` prints."""
    program = os.environ.get("SLIDING_CONTACT_COMMAND")
    command = [program] if program else ["cargo", "fmu"]
    environment = os.environ | {"CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")} if program else None
    run = subprocess.run([*command, *arguments], cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(f"cargo fmu {' '.join(arguments)}: {run.stderr.strip()}")
    return run.stdout


def result(*arguments):
    """The results of a command as JSON."""
    return json.loads(called(*arguments, "--json"))


def ran(*arguments):
    """The results of an example, its files in a folder of their own."""
    with tempfile.TemporaryDirectory() as folder:
        return result("run", *arguments, "--output", folder)


def simulated(scene, *arguments, inputs=None):
    """Columns of a run by name without the unit, in SI units."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.csv"
        if inputs is not None:
            file = Path(folder) / "in.csv"
            file.write_text(inputs, encoding="utf-8")
            arguments += ("--inputs", str(file))
        called("simulate", scene, "-o", str(out), *arguments)
        with open(out, newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        return {name.split(" [")[0]: [float(row[index]) for row in rows] for index, name in enumerate(header)}


def printed(text, value):
    """A value with the digits of a printed number."""
    mantissa, exponent, _ = text.partition("e")
    decimals = len(mantissa.partition(".")[2])
    sign = "+" if text.startswith("+") else ""
    if isinstance(value, Below):
        return f"{max(value, 1e-300):.0e}".replace("e-0", "e-") if value > float(text) else text
    if exponent:
        return f"{value:{sign}.{decimals}e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{value:{sign}{',' if ',' in text or abs(value) >= 1000 else ''}.{decimals}f}"


def agrees(text, value):
    """Whether a printed number is the value, within one unit of its last digit."""
    text = text.replace(",", "")
    if isinstance(value, Below):
        return value <= float(text)
    mantissa, _, exponent = text.partition("e")
    return abs(float(text) - value) <= 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def compared(page, passage, values):
    """The page with the numbers of one passage as computed, and what differed."""
    parts = [r"\s+".join(map(re.escape, re.split(r"\s+", part))) for part in passage.split("{}")]
    found = list(re.finditer(f"({NUMBER.pattern})".join(parts), page))
    if len(found) != 1:
        return page, [f"{len(found)} passages read {passage!r}"]
    (match,), differing = found, []
    for index in reversed(range(len(values))):
        text = match.group(index + 1)
        if not agrees(text, values[index]):
            differing.append(f"{passage!r}: {text} is {values[index]:.6g}")
            page = page[: match.start(index + 1)] + printed(text, values[index]) + page[match.end(index + 1) :]
    return page, differing


def differences(name, write=False):
    """What differs on the pages from the command of this name."""
    for page, passage, *values in CHECKS[name]():
        path = ROOT / page
        text = path.read_text(encoding="utf-8")
        new, differing = compared(text, passage, values)
        yield from (f"{page}: {what}" for what in differing)
        if write and new != text:
            path.write_text(new, encoding="utf-8")


@check("run disc_brake")
def disc_brake():
    run = ran("disc_brake")
    lumped, line = run["levels"]["lumped"], run["levels"]["line, 17 cells"]
    both = lambda name: (lumped[name], line[name])  # noqa: E731
    hottest, wear = both("contact_temperature_peak_degC"), both("pad_wear_um")
    yield "README.md", "hottest point reaches {} °C ({} °C on", *hottest
    yield "README.md", "loses {} µm ({} µm)", *wear
    page = "docs/usage.md"
    yield page, "hottest point of the contact, at most | {} °C | {} °C |", *hottest
    yield page, "disc, mean, at most | {} °C | {} °C |", *both("disc_temperature_peak_degC")
    yield page, "wear of the pad | {} µm | {} µm |", *wear
    masses = [column[mass] / column["distance_km"] for column in (lumped, line) for mass in ("worn_mass_mg", "airborne_mass_mg")]
    yield page, "of it airborne | {} and {} mg/km | {} and {} mg/km |", *masses
    heat = [number for column in (lumped, line) for number in (column["energy_in_kJ"], 100 * column["heat_share_disc"])]
    yield page, "of it into the disc | {} kJ, {} % | {} kJ, {} % |", *heat
    yield page, "closed to | below {} of it | below {} of it |", *map(Below, both("energy_balance_error"))
    page = "examples/disc_brake/README.md"
    for what, key in (
        ("stopping distance, longest, m", "stopping_distance_longest_m"),
        ("hottest point of the contact, °C", "contact_temperature_peak_degC"),
        ("disc, mean, highest, °C", "disc_temperature_peak_degC"),
        ("least friction coefficient", "friction_coefficient_least"),
        ("wear of the pad, µm", "pad_wear_um"),
    ):
        yield page, f"| {what} | {{}} | {{}} | {{}} | {{}} |", *(level[key] for case in ("stop", "fade") for level in run[case].values())
    lumped, line = run["stop"].values()
    yield page, "leading edge of the pad to {} times the mean", line["pressure_peak_MPa"] / lumped["pressure_peak_MPa"]
    lumped, line = (level["contact_temperature_peak_degC"] for level in run["fade"].values())
    yield page, "levels then differ by {} %", 100.0 * (line / lumped - 1.0)
    constants = (f"--set=strip.{name}" for name in ("property_table.points=0", "conductivity=49.3", "specific_heat=455.5"))
    discs = [own["fade"]["lumped"]["disc_temperature_peak_degC"] for own in (ran("disc_brake", *constants), run)]
    yield page, "end the fade run {} K too hot", discs[0] - discs[1]


@check("drive cycles")
def drive_cycles():
    page, more = "examples/disc_brake/README.md", []
    for cycle, name in (("udds", "UDDS"), ("hwfet", "HWFET"), ("us06", "US06 (`--cycle us06`)"), ("wltc_3b", "WLTC class 3b (`--cycle wltc_3b`)")):
        lumped, line, *_ = ran("--cycle", cycle)["levels"].values()
        masses = [lumped[mass] / lumped["distance_km"] for mass in ("worn_mass_mg", "airborne_mass_mg")]
        hottest = [level["contact_temperature_peak_degC"] for level in (lumped, line)]
        yield page, f"| {name} | {{}} | {{}} | {{}} | {{}}, {{}} °C |", *masses, lumped["worn_mass_mg"] / lumped["stops"], *hottest
        more.append(100.0 * (line["worn_mass_mg"] / lumped["worn_mass_mg"] - 1.0))
    yield page, "line gives {} to {} % more mass", min(more), max(more)


@check("simulate")
def simulate():
    run = simulated("disc_brake", "--set", "punch.width=80 mm", "--set", "solver.fidelity=line", inputs=STOP)
    page, heat = "README.md", run["dissipated_energy"][-1]
    yield page, "hottest point reaches {} °C, the pad", max(run["contact_temperature_max"]) - 273.15
    yield page, "the pad loses {} µm, and", 1e6 * run["wear_depth_punch"][-1]
    yield page, "{} % of {} kJ go into the disc", 100.0 * run["heat_received_strip"][-1] / heat, 1e-3 * heat
    critical = simulated("disc_brake")["critical_speed"][-1]
    yield "docs/usage.md", "Above {} m/s the contact is thermoelastically unstable", critical
    yield "examples/disc_brake/README.md", "above the critical speed of {} m/s", critical


def told(text, label):
    """The numbers behind a label that a command prints."""
    rows = (line for line in text.splitlines() if line.strip().startswith(label))
    return [float(number) for number in re.findall(NUMBER, next(rows).strip()[len(label) :])]


def worst(problem, quantity=""):
    """The largest error of the problems of `verify` with this name."""
    return max(row["error"] for row in result("verify", "--filter", problem) if row["quantity"].startswith(quantity))


@check("paper")
def paper():
    page, punch = "docs/paper.md", "reciprocating_punch"
    hot = called("steady", punch)
    cold = called("steady", punch, "--cold", "--set", "holder.constraint=translate_and_rotate", "--set", "holder.pivot_height=30 mm")
    uneven = called("steady", punch, "--cold", "--return-speed", "4.8e-3")
    yield page, "twice the mean ({} MPa) at the leading edge; range of the worn shape {} µm", told(hot, "forward: peak pressure, MPa")[0], told(hot, "range of the punch's shape, µm")[0]
    yield page, "shape of {} µm", *told(cold, "range of the punch's shape, µm")
    yield page, "tilt jumps by {} µrad, the approach by {}", -told(cold, "jump of the tilt, urad")[0], *told(cold, "jump of the approach, µm")
    yield page, "wear rate {} instead of {} nm/s", *told(uneven, "wear rate of the punch, nm/s"), *told(hot, "wear rate of the punch, nm/s")
    yield page, "| to {}, by time stepping", worst("reciprocating, by 400")
    power = told(hot, "wear dissipation power, W") + told(hot, "friction power, W") + told(hot, "into punch, strip, W")[:1]
    yield page, "| {} W of wear dissipation, {} W of friction, {} W of it into the punch", *power
    page = "examples/reciprocating_punch/README.md"
    yield page, "generates {} W; of this {} W leave through the punch", *told(hot, "friction power, W"), told(hot, "out of the punch's top")[0]
    yield page, "in the steady state {} %", 100.0 * told(hot, "difference of the pressures, rms over the mean")[0]
    page = "docs/paper.md"
    jumps = result("cycles", punch, "--cycles", "1000000")["jumps"][-1]
    yield page, "a million cycles from {} computed ones, the edge pressure to {} of the mean", jumps["cycles_computed"], jumps["pressure_max"] * 6e-8
    heated = [told(part, "range of the punch's shape, µm")[0] for part in reversed(hot.split("with heat"))]
    yield page, "differ by {} of the mean (root mean square), the shape has a range of {} instead of {} µm", *told(hot, "difference of the pressures, rms over the mean"), *heated
    parts = told(hot, "wear, normal to it") + told(hot, "strain of the strip's surface, mean") + [100.0 * told(hot, "turned over by a reversal, elastic")[0]]
    yield page, "by part: wear {}, strain {} in the mean, {} % turned over", *parts
    split = [row["computed"] for row in result("verify", "--filter", "heat split off the contact")]
    yield page, "waves at {} and {} per second with steps of 0.05 and 0.01 s", *split
    yield page, "within {} of 300 stepped cycles", worst("direct reciprocating")
    yield page, "within {} of Galin", worst("a million cycles")
    yield page, "Jaeger's maximum to {} |", worst("moving band by cells, half-plane, Jaeger", "max")
    yield page, "rates within {};", worst("thermoelastic instability")
    yield page, "speed {} times the critical one", *told(called("plan", "hot_spots"), "speed over critical speed")


ELEMENTS = {
    "safety gear of a lift, one stop": "safety_gear",
    "tread block of a tyre": "tread_block",
    "rod seal": "rod_seal",
    "piston ring": "piston_ring",
    "slideway": "slideway",
    "yaw brake": "yaw_brake",
    "drum brake, two stops": "drum_brake",
    "disc brake, cooled between applications": "cooled_disc",
    "disc brake, drag of minutes": "long_drag",
    "face seal": "face_seal",
    "bushing of POM": "pom_bushing",
    "bicycle disc": "bicycle_disc",
    "slip ring": "slip_ring",
    "tread brake of a wagon": "block_brake",
}


@check("machine elements")
def machine_elements():
    found = []
    for name, scene in ELEMENTS.items():
        file = f"tests/applications/{scene}."
        settings = ("--inputs", file + "csv", "--set", "solver.cells=33", "--set", "solver.tolerance=1e-3")
        lumped, line = (simulated(file + "toml", *settings, "--set", f"solver.fidelity={level}") for level in ("lumped", "line"))
        deviations = []
        for output in ("contact_temperature", "contact_temperature_max", "punch.mean_temperature"):
            values, reference = (interpolated(run, output, line["time"]) for run in (lumped, line))
            deviations.append(100.0 * max((a - b for a, b in zip(values, reference)), key=abs) / (max(reference) - reference[0]))
        rise = max(line["contact_temperature"]) - line["contact_temperature"][0]
        found.append([abs(deviation) for deviation in deviations])
        yield "docs/accuracy.md", f"| {name} | {{}} % | {{}} % | {{}} % | {{}} |", *deviations, rise
    # Those without hot spots, whose contact stays whole.
    mean, hottest, _ = zip(*found[:10])
    yield "README.md", "off by {} to {} % of its rise", min(mean), max(mean)
    yield "README.md", "Its hottest point is {} to {} % too low", min(hottest), max(hottest)
    yield "docs/manual.md", "off by {} to {} % of the rise", min(mean), max(mean)


def interpolated(run, output, times):
    """An output at other times."""
    index, values = 0, []
    for time in times:
        while index < len(run["time"]) - 2 and run["time"][index + 1] < time:
            index += 1
        (start, end), (a, b) = run["time"][index : index + 2], run[output][index : index + 2]
        values.append(b if end == start else a + (b - a) * min(max((time - start) / (end - start), 0.0), 1.0))
    return values


@check("run pin_on_disk")
def pin_on_disk():
    page, run = "examples/pin_on_disk/README.md", list(ran("pin_on_disk").values())[:3]
    of = lambda name: [test[name] for test in run]  # noqa: E731
    yield page, "wear of the pin, 0.001 mm³ | {} | {} | {} |", *of("wear of the pin, 1e-3 mm3")
    yield page, "read every metre | {} °C | {} °C | {} °C |", *of("hottest point of the contact, degC")
    yield page, "mean contact temperature at the end | {} °C | {} °C | {} °C |", *of("mean contact temperature at the end, degC")
    yield page, "friction heat | {} kJ | {} kJ | {} kJ |", *of("friction heat, kJ")
    yield page, "into the holder | {} % | {} % | {} % |", *(100.0 * part for part in of("part of it that leaves through the pin"))
    yield page, "estimated error, relative | {} | {} | {} |", *of("estimated error")
    peaks = []
    for speed in ("0.1", "0.2", "0.3"):
        test = simulated("pin_on_disk", inputs=f"time [s],sliding_velocity [m/s],normal_load [N]\n0,{speed},10\n{1000 / float(speed)},{speed},10\n")
        hottest = max(test["contact_temperature_max"])
        peaks += [hottest - 273.15, test["time"][test["contact_temperature_max"].index(hottest)]]
    yield page, "at most | {} °C at {} s | {} °C at {} s | {} °C at {} s |", *peaks
    yield page, "Above {} m/s (the output `critical_speed`)", test["critical_speed"][-1]


@check("run clutch")
def clutch():
    page, run = "examples/clutch/README.md", ran("clutch")
    bristle, hill, judder = run["engagement, bristle, explicit"], run["hill"], run["judder"]
    yield page, "slip ends after | {} s", bristle["slip_ends_s"]
    yield page, "highest torque | {} N m", bristle["torque_peak_N_m"]
    yield page, "hottest point of the contact | {} °C", bristle["contact_temperature_peak_degC"]
    yield page, "friction heat | {} kJ", bristle["friction_heat_kJ"]
    yield page, "wear of the facing | {} µm", bristle["facing_wear_um"]
    yield page, "critical speed of {} m/s", bristle["critical_speed_m_per_s"]
    yield page, "no chatter at {} N m", bristle["torque_stuck_N_m"]
    yield page, "and {} mm of drift in a minute", hill["drift_mm"]
    limit = run["explicit limit, regularised friction"]
    yield page, "up to a step of {} µs, predicted by `friction_slope` to {} %", limit["observed_us"], 100.0 * abs(1.0 - limit["observed_over_predicted"])
    implicit, hot = (run[f"regularised, implicit{what}"] for what in (" at 50 times the limit", ", from 250 degC"))
    yield page, "explicit limit, {} ms, it takes {} iteration a step", implicit["step_ms"], implicit["iterations_mean"]
    yield page, "it takes {} in the mean and at most {}.", hot["iterations_mean"], hot["iterations_most"]
    growth = [judder[f"growth_rate_{what}_per_s"] for what in ("predicted", "observed", "observed_without_stribeck")]
    yield page, "oscillation at {} Hz: growth of {} 1/s by the linear theory, {} 1/s in the run; without the Stribeck effect a decay of {} 1/s", judder["frequency_Hz"], *growth[:2], -growth[2]


@check("run hot_spots")
def hot_spots():
    page, (below, above, *_) = "examples/hot_spots/README.md", ran("hot_spots").values()
    yield page, "growth of the longest wave | {} 1/s | {} 1/s |", above["its growth in theory, 1/s"], above["its growth measured, 1/s"]
    yield page, "| below {} of the energy in |", Below(max(run["energy balance error"] for run in (below, above)))
    yield page, "unstable above {} m/s, because", above["critical speed, m/s"]
    yield page, "one patch of {} % of the ring carries the load at up to {} times", 100.0 * above["least contact fraction"], above["highest pressure over its mean"]


@check("run vehicle_brake")
def vehicle_brake():
    page, run = "examples/vehicle_brake/README.md", ran("vehicle_brake")
    stops = run["cold_stop"], run["descent"]
    yield page, "stopping distance from 80 km/h | {} m | {} m |", *(stop["distance_m"] for stop in stops)
    yield page, "disc before, mean | {}, {} °C | {}, {} °C |", *(stop[f"{axle}_disc_before_degC"] for stop in stops for axle in ("front", "rear"))
    yield page, "front, rear | {}, {} | {}, {} |", *(stop[f"{axle}_friction_lowest"] for stop in stops for axle in ("front", "rear"))
    yield page, "closes to | below {} | below {} |", *(Below(stop["heat_balance_error"]) for stop in stops)
    cycle = run["udds"]
    yield page, "Through the cycle, {} km, the driver keeps the speed to {} km/h", cycle["distance_km"], cycle["speed_error_rms_km_per_h"]
    yield page, "discs reach {} °C, the rear ones {} °C", cycle["front_disc_peak_degC"], cycle["rear_disc_peak_degC"]
    yield page, "lose {} and {} µm", cycle["front_pad_wear_um"], cycle["rear_pad_wear_um"]
    errors = stops[0]["coupling_error"], stops[0]["coupling_error_extrapolated"]
    yield page, "by {} % with inputs held over a step, and by {} with", 100.0 * errors[0], errors[1]


@check("run reciprocating_punch")
def reciprocating_punch():
    page, run = "examples/reciprocating_punch/README.md", ran("reciprocating_punch")
    cold, hot = ([run[holder + heat] for holder in ("translate", "rotate")] for heat in ("", ", hot"))
    of = lambda name, runs=cold: [values[name] for values in runs]  # noqa: E731
    yield page, "falls by e in {} cycles, with rotation in {}.", *(round(cycles, -1) for cycles in of("cycles in which the distance falls by e"))
    yield page, "root mean square) after {} and {} cycles", *(round(cycles, -2) for cycles in of("first cycle within 1 % of it"))
    yield page, "v > 0 | {}, {} | {}, {} |", *(values[f"forward: pressure at x = {edge}a over p_m"] for values in cold for edge in "-+")
    distance = "pressure less the direct one, root mean square, over p_m"
    yield page, "root mean square over p_m | {} | {} |", *of(distance)
    yield page, "most, over p_m | {} | {} |", *of("sum of half-stroke means less 2 p_m, most, over p_m")
    shapes = [1e-3 * value for value in of("range of the worn shape, nm")]
    yield page, "range of {} and {} µm | {} nm | {} nm |", *shapes, *of("worn shape less the direct one, most, nm")
    jumps = [abs(values[name]) for values in cold for name in ("jump of the tilt at reversal, urad", "the same, direct, urad")]
    yield page, "at reversal; direct | {}; {} | {}; {} urad |", *jumps
    yield page, "by {} microradians", jumps[2]
    yield page, "line down to {} of the", run["translate, accelerated"][distance]
    yield page, "contact warms by {} K", run["translate, hot"]["contact temperature at the end, hottest station, degC"] - 20.0
    yield page, "The difference is {} % of the mean pressure for the translating and {} % for the rotating", *(100.0 * value for value in of(distance, hot))


@check("charts")
def charts():
    """Errors of 33 cells at 1e-3 in the tables of the charts."""
    found = {}
    for scene in ("unidirectional_pin", "reciprocating_punch", "brake_stop"):
        with open(ROOT / "docs" / "accuracy" / f"{scene}.csv", newline="", encoding="utf-8") as file:
            rows = csv.DictReader(line for line in file if not line.startswith("#"))
            run = next(row for row in rows if row["family"] == "line, tolerance" and "33 cells, tolerance 1e-3" in row["setting"])
        found[scene] = [100.0 * float(run[f"error_{name}"]) for name in ("wear_depth", "contact_temperature", "friction_force", "peak_pressure")]
    pin, strokes, stop = found.values()
    yield "docs/accuracy.md", "33 cells at 1e-3 give the peak pressure to {} % (pin) and {} % (strokes)", pin[3], strokes[3]
    yield "docs/accuracy.md", "an error of {} % in wear, {} % in temperature and {} % in force", *stop[:3]


@check("stability maps")
def stability_maps():
    page = "docs/stability/README.md"
    with tempfile.TemporaryDirectory() as folder:
        maps = {one["map"]: one["findings"] for one in result("stability", "--output", folder)}
    of = {name: [list(map(float, re.findall(NUMBER, finding))) for finding in findings] for name, findings in maps.items()}
    split, hidden, _, default = of["growth-step"]
    yield page, "speed and step | {} of {} runs; growth hidden in {} |", *default[:3]
    yield page, "hides growth in {} of {} runs above", *hidden[:2]
    yield page, "right sign in all {}, rate wrong by more than a tenth in {} |", split[0], split[3]
    default, thresholds, *_ = of["wear-speed"]
    yield page, "under wear | {} of {}; thresholds within {} of the critical speed", *default[:2], thresholds[0]
    rings, default = of["reversal"]
    yield page, "thermal times | {} of {}; error at most {} | Crank-Nicolson rings in {} |", *default[:2], default[-1], rings[0]
    for name, passage in (("conductance", "conductance of 0 to 1e12 W/(m² K)"), ("conductivity", "1e-8 to 1, insulator")):
        (right, runs, *_, last), *_ = of[name]
        largest = last if name == "conductivity" else float(re.search(f"largest error ({NUMBER.pattern})", maps[name][0])[1])
        yield page, f"{passage} | {{}} of {{}}; error at most {{}} of the heat", right, runs, largest
    right, runs, _, _, largest, implicit, crank = of["peclet"][0]
    yield page, "0 to 1e6 | {} of {}; error at most {} | implicit Euler right in {}, Crank-Nicolson in {} |", right, runs, largest, implicit, crank
    explicit, _, default = of["wear-step"]
    yield page, "explicit bound | {} of {}; error at most {} | explicit Euler grows in all {} runs", *default[:2], default[-1], explicit[0]


@check("run published")
def published():
    """Model and deviation in a row of the table are the nearest results of its case."""
    page, results, case = "examples/published/README.md", ran("published"), ""
    averaged = [result["model"] for result in results if result["case"] == "wear_dissipation"]
    yield "docs/paper.md", "both strokes {} of the minimum", *averaged
    for row in (ROOT / page).read_text(encoding="utf-8").splitlines():
        cells = row.split("|")
        if len(cells) != 9 or not re.search(r"\d", cells[5] + cells[6]):
            continue
        case = (re.findall(r"\((\w+)\.svg\)", cells[1]) or [case])[0]
        own = [result for result in results if result["case"] == case]
        models = [scale * result["model"] for result in own for scale in (1.0, 100.0, 1000.0)]
        deviations = [sign * 100.0 * result["deviation"] for result in own for sign in (1.0, -1.0)]
        values = []
        for cell, known in ((5, models), (6, deviations)):
            values += [min(known, key=lambda value: abs(value - float(number))) for number in re.findall(NUMBER, cells[cell])]
            cells[cell] = re.sub(NUMBER, "{}", cells[cell])
        yield page, "|".join(cells), *values


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("name", nargs="*", help=f"what to compare; all: {', '.join(CHECKS)}")
    parser.add_argument("--write", action="store_true", help="put the numbers that differ into the pages")
    options = parser.parse_args()
    found = [difference for name in options.name or CHECKS for difference in differences(name, options.write)]
    print("\n".join(found) or "all agree")
    return bool(found) and not options.write


if __name__ == "__main__":
    sys.exit(main())
