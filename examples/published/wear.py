"""Cases of wear: worn profiles, cycles, emissions."""

import sys

import closed_forms as published
import numpy as np
from model import FOLDER, Model, Run
from results import Comparison, Curve, Result, rise, table_of

sys.path.append(str(FOLDER.parent / "disc_brake"))

import road_load  # noqa: E402  (of the example beside this one)


def uniform_wear(model: Model) -> Result:
    run = model.simulate("uniform_wear", "inputs.csv")
    inner, outer = 0.075, 0.125
    pressure = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2)
    wear = 0.5 * (inner + outer)
    distance, radius = 1e-3 * run["distance"], 1e3 * run["radius"]
    ends = np.array([distance[0], distance[-1]])
    return Result(
        "Torque of a facing that runs in",
        "distance slid (km)",
        "effective radius (mm)",
        [
            Comparison("radius, uniform pressure", "mm", 1e3 * pressure, radius[0], (-1e-4, 1e-4)),
            Comparison("radius, uniform wear", "mm", 1e3 * wear, radius[-1], (-1e-4, 1e-3)),
        ],
        [
            Curve("uniform pressure", ends, np.full(2, 1e3 * pressure), True),
            Curve("uniform wear", ends, np.full(2, 1e3 * wear), True),
            Curve("model", distance, radius, False),
        ],
    )


def flat_punch_wear(model: Model) -> Result:
    taus = (0.1, 0.5, 1.0)
    run = model.simulate("flat_punch_wear", "inputs.csv", at=tuple(100.0 * tau for tau in taus))
    mean, comparisons, curves = 50e6, [], []
    fine = np.linspace(-0.985, 0.985, 400)
    for index, tau in enumerate(taus):
        x, p = run.profile(index, "x") / 0.01, run.profile(index, "pressure") / mean
        inside = np.abs(x) < 0.95
        for name, place in (("centre", 0.0), ("half the half-width", 0.5)):
            at = int(np.argmin(np.abs(x - place)))
            exact = float(published.worn_flat_punch(np.array([x[at]]), tau)[0])
            comparisons.append(Comparison(f"pressure at τ = {tau:g}, {name}", "p/pₘ", exact, p[at], (-2e-3, 2e-3)))
        curves.append(Curve(f"τ = {tau:g}", fine, published.worn_flat_punch(fine, tau), True))
        curves.append(Curve("model", x[inside], p[inside], False))
    return Result("Wear of a flat punch", "x over the half-width", "pressure over its mean", comparisons, curves, (0.5, 2.5))


def sliding_punch(model: Model) -> Result:
    run = model.simulate("sliding_punch", "inputs.csv", at=(1.0,))
    x, p = run.profile(0, "x") / 0.01, run.profile(0, "pressure") / 50e6
    fine = np.linspace(-0.985, 0.985, 400)
    comparisons = []
    for place in (-0.75, 0.0, 0.75):
        at = int(np.argmin(np.abs(x - place)))
        # The station is the mean over its interval.
        near = np.linspace(x[at] - 1.0 / 32.0, x[at] + 1.0 / 32.0, 101)
        exact = float(np.trapezoid(published.sliding_punch(near, 0.5, 0.3), near) * 16.0)
        comparisons.append(Comparison(f"pressure at x = {x[at]:g} a", "p/pₘ", exact, p[at], (-1e-3, 1e-3)))
    inside = np.abs(x) < 0.95
    return Result(
        "Flat punch that slides with friction 0.5",
        "x over the half-width",
        "pressure over its mean",
        comparisons,
        [Curve("half-plane", fine, published.sliding_punch(fine, 0.5, 0.3), True), Curve("model", x[inside], p[inside], False)],
    )


PERIOD, CYCLES = 0.62837, 120  # of the reciprocating punch, s


def strokes(model: Model, cycles: tuple[int, ...]) -> Run:
    """Cold reciprocating punch that wears 100 times faster, with the profiles at mid-stroke, forward and backward, of these cycles."""
    settings = ("punch.wear_coefficient=3.9e-3 mm3/(N.m)", "solver.fidelity=line", "solver.cells=65",
                "contact.friction_coefficient=0.25", "punch.thermal_expansion=0", "strip.thermal_expansion=0", "solver.heat=mean",
                f"nominal.duration={CYCLES * PERIOD}")  # fmt: skip
    at = tuple((cycle - part) * PERIOD for cycle in cycles for part in (0.75, 0.25))
    return model.simulate("reciprocating_punch", settings=settings, at=at, step=0.0314)


def wear_dissipation(model: Model) -> Result:
    cycles = (*range(1, 30), *range(30, CYCLES + 1, 5))
    run, mean = strokes(model, cycles), 10e3 / (0.06 * 0.01)

    def over_uniform(squares: np.ndarray) -> float:
        return float(np.trapezoid(squares, dx=1.0 / (squares.size - 1))) / mean**2

    averaged, whole = [], []
    for index in range(len(cycles)):
        there, back = (run.profile(2 * index + turn, "pressure") for turn in (0, 1))
        averaged.append(over_uniform((0.5 * (there + back)) ** 2))
        whole.append(over_uniform(0.5 * (there**2 + back**2)))
    counts = np.array(cycles, dtype=float)
    return Result(
        "Averaged wear dissipation",
        "cycles, wear 100 times faster",
        "wear dissipation over k v F²/A",
        [Comparison("averaged wear dissipation, run in", "k v F²/A", 1.0, averaged[-1], (0.0, 2e-3))],
        [
            Curve("minimum", counts, np.ones_like(counts), True),
            Curve("model, of the mean pressure\nof both strokes", counts, np.array(averaged), False),
            Curve("model, mean of both strokes", counts, np.array(whole), False),
        ],
        (0.95, 1.55),
    )


def reciprocating(model: Model) -> Result:
    run = strokes(model, (CYCLES,))
    x = 1e3 * run.profile(0, "x")
    there, back = (run.profile(index, "pressure") / (10e3 / (0.06 * 0.01)) for index in (0, 1))
    comparisons = []
    for place in (-20.0, 0.0, 20.0):
        at = int(np.argmin(np.abs(x - place)))
        comparisons.append(Comparison(f"(p₊ + p₋)/pₘ at x = {x[at]:.0f} mm", "1", 2.0, there[at] + back[at], (-0.01, 0.01)))
    return Result(
        "Reciprocating punch, run in",
        "x (mm)",
        "pressure over its mean",
        comparisons,
        [
            Curve("half the sum is 1", x, np.ones_like(x), True),
            Curve("forward", x, there, False),
            Curve("backward", x, back, False),
            Curve("half the sum", x, 0.5 * (there + back), False),
        ],
        (-0.05, 2.15),
    )


def ball_wear(model: Model) -> Result:
    radius, worn, scar = 5e-3, 0.198e-9, 2.11e-3
    depth, width = 1.8565e-3, 2.4e-3
    run = model.simulate("ball_wear", "inputs.csv")
    distance, flat = run["distance"], width * run["fraction"]
    circle = np.sqrt(4.0 / np.pi * flat * depth)
    fine = np.linspace(0.5, 1000.0, 400)
    cylinder = published.worn_cylinder(radius, depth, worn * fine / 1000.0)
    ball = published.worn_ball(radius, worn * fine / 1000.0)
    # Two half-spaces share the heat of a circle, the ball at rest on it and the disk moving under it.
    conductivity, diffusivity = 45.0, 45.0 / (7800.0 * 460.0)
    flux = 0.6 * 10.0 * 0.1 / (np.pi * 0.5 * scar * conductivity)
    ball_alone = flux * published.flash_mean(0.0)
    disk_alone = flux * published.flash_mean(0.1 * 0.5 * scar / (2.0 * diffusivity))
    flash = ball_alone * disk_alone / (ball_alone + disk_alone)
    comparisons = []
    # The flat grows by two cells at once: 7 % of its width at 100 m, 3 % at 1,000 m.
    for place, band in ((100.0, 0.04), (1000.0, 0.02)):
        at = int(np.searchsorted(distance, place - 1e-6))
        exact = float(published.worn_cylinder(radius, depth, np.array(worn * place / 1000.0)))
        comparisons.append(Comparison(f"width after {place:g} m, cylinder", "mm", 1e3 * exact, 1e3 * flat[at], (-band, band)))
    later = distance >= 10.0
    exponent = np.polyfit(np.log(distance[later]), np.log(flat[later]), 1)[0]
    comparisons += [
        Comparison("exponent of the width", "1", 1.0 / 3.0, exponent, (-0.01, 0.01)),
        Comparison("scar after 1000 m, measured", "mm", 1e3 * scar, 1e3 * circle[-1], (-0.02, 0.01)),
        Comparison("scar after 1000 m, ball", "mm", 1e3 * ball[-1], 1e3 * circle[-1], (-0.02, 0.01)),
        Comparison(
            "scar after 100 m, ball",
            "mm",
            1e3 * float(published.worn_ball(radius, np.array(0.1 * worn))),
            1e3 * float(np.interp(100.0, distance, circle)),
            (0.15, 0.25),
        ),
        Comparison("mean contact rise after 1000 m", "K", float(flash), run["temperature"][-1] - 296.15, (0.4, 0.52)),
    ]
    # The width is a whole number of cells: it is drawn at the middle of the distance over which it stays.
    first = np.flatnonzero(np.diff(flat, prepend=-1.0) != 0.0)
    last = np.append(first[1:] - 1, flat.size - 1)
    middle = np.where(first == 0, 0.0, 0.5 * (distance[first] + distance[last]))
    return Result(
        "Growth of the flat on a ball",
        "distance slid (m)",
        "width or diameter (mm)",
        comparisons,
        [
            Curve("width, cylinder", fine, 1e3 * cylinder, True),
            Curve("model, width", middle, 1e3 * flat[first], False),
            Curve("scar, ball", fine, 1e3 * ball, True),
            Curve("model, circle of equal area", middle, 1e3 * circle[first], False),
            Curve("scar, measured", np.array([1000.0]), np.array([1e3 * scar]), True, points=True),
        ],
        (0.0, 2.3),
    )


def block_on_ring(model: Model) -> Result:
    distances = np.array([800.0, 1600.0, 2400.0, 3600.0])
    fine = np.arange(40.0, 3601.0, 40.0)
    run = model.simulate("block_on_ring", "inputs.csv", at=tuple((fine / 0.5).tolist()))
    course = np.array([1e6 * run.profile(index, "worn_punch").max() for index in range(fine.size)])
    depths = np.interp(distances, fine, course)
    mesh_motion = np.array([16.166, 25.555, 33.417, 43.707])
    level_sets = np.array([16.155, 25.709])
    measured = np.array([46.3, 44.5, 48.7])
    comparisons = []
    for distance, one, other in zip(distances, mesh_motion, depths, strict=True):
        comparisons.append(Comparison(f"depth after {distance:g} m, mesh motion", "µm", one, other, (-0.005, 0.01)))
    for distance, one, other in zip(distances[:2], level_sets, depths[:2], strict=True):
        comparisons.append(Comparison(f"depth after {distance:g} m, level sets", "µm", one, other, (-0.005, 0.005)))
    comparisons.append(Comparison("depth after 3600 m, measured", "µm", measured.mean(), depths[-1], (-0.08, -0.03)))
    return Result(
        "Block on ring",
        "distance slid (m)",
        "greatest worn depth of the block (µm)",
        comparisons,
        [
            Curve("finite elements,\nmesh motion", distances, mesh_motion, True, points=True),
            Curve("finite elements,\nlevel sets", distances[:2], level_sets, True, points=True),
            Curve("measured, 3 tests", np.full(3, 3600.0), measured, True, points=True),
            Curve("model", fine, course, False),
        ],
        (0.0, 50.0),
    )


def fretting(model: Model) -> Result:
    count, acceleration, peak = 180, 100, 0.2e-3
    # Displacement 25 µm to both sides, from the middle: the speed is linear between its extremes.
    rows = ["time [s],sliding_velocity [m/s],normal_load [N]", f"0,{peak},185"]
    for cycle in range(count):
        rows += [f"{cycle + 0.5},{-peak},185", f"{cycle + 1.0},{peak},185"]
    inputs = "\n".join(rows) + "\n"
    cycles, fine = np.array([1000.0, 5000.0, 10000.0, 18000.0]), np.arange(200.0, 18001.0, 200.0)
    level_sets, mesh_motion, measured = np.array([0.3784, 1.1311, 1.8145, 2.713]), np.array([2.706]), np.array([2.89])

    def drawn(label: str, counts: np.ndarray, depths: np.ndarray, points: bool) -> Curve:
        # The depth of a parabola that wears grows with the power 2/3: over it the curves can be told apart.
        return Curve(label, 1e-3 * counts, 1e3 * depths / counts ** (2.0 / 3.0), points, points)

    # Friction force over the tangential displacement of both bodies at full slip, 166.5 N over 0.48 µm.
    elastic = "contact.tangential_compliance=elastic"
    curves = [
        drawn("finite elements,\nlevel sets", cycles, level_sets, True),
        drawn("finite elements,\nmesh motion", cycles[-1:], mesh_motion, True),
        drawn("measured", cycles[-1:], measured, True),
    ]
    comparisons = []
    for name, settings, band in (("with elastic slip", (elastic,), (-0.003, 0.005)), ("without", (), (0.01, 0.02))):
        run = model.simulate("fretting", inputs, settings, at=tuple((fine / acceleration).tolist()), step=0.02)
        course = np.array([1e6 * run.profile(index, "worn_strip").max() for index in range(fine.size)])
        depths = np.interp(cycles, fine, course)
        for cycle, one, other in zip(cycles, level_sets, depths, strict=True):
            comparisons.append(Comparison(f"depth, {cycle:g} cycles, {name}", "µm", one, other, band))
        comparisons.append(Comparison(f"the same, mesh motion, {name}", "µm", mesh_motion[0], depths[-1], (band[0], band[1] + 0.003)))
        comparisons.append(Comparison(f"the same, measured, {name}", "µm", measured[0], depths[-1], (-0.08, -0.03)))
        curves.append(drawn(f"model, {name}", fine, course, False))
    return Result(
        "Fretting in gross slip",
        "cycles (thousands)",
        "depth over cycles to the 2/3 (nm)",
        comparisons,
        curves,
        (3.4, 4.3),
    )


def brake_emissions(model: Model) -> Result:
    # A front brake takes 35 % of the braking; of what becomes airborne 86 % are PM10.
    share, particles = 0.35, 0.86
    brake = road_load.Brake(mean_radius=0.1175, friction_coefficient=0.4, faces=2, pad_area=0.095 * 0.055)
    names, means, masses = ("udds", "wltc_3b", "us06", "hwfet"), [], []
    for name in names:
        drive = road_load.front_brake(*road_load.read_cycle(FOLDER.parent / "data" / f"{name}.csv"), brake)
        run = model.simulate("disc_brake", table_of(drive.time, drive.sliding_velocity, drive.normal_load))
        distance = float(np.trapezoid(drive.speed, drive.time))
        means.append(3.6 * distance / drive.time[-1])
        masses.append(1e9 * particles * float(run["airborne"][-1]) / distance)
    cars = np.array(masses) / share
    comparisons = [
        Comparison(f"{name}, car at {mean:.0f} km/h, EMEP/EEA", "mg/km", float(published.brake_emission(np.array(mean))), car, band)
        for name, mean, car, band in zip(names, means, cars, ((-0.5, 0.0), (-0.6, -0.2), (0.3, 1.2), (-0.8, -0.4)), strict=True)
    ]
    comparisons.append(Comparison("front brake, WLTC, measured", "mg/km", 4.5, masses[1], (-0.65, -0.4)))
    fine = np.linspace(20.0, 100.0, 401)
    return Result(
        "PM10 from the brakes of a car",
        "mean speed (km/h)",
        "PM10 (mg/km)",
        comparisons,
        [
            Curve("EMEP/EEA, car", fine, published.brake_emission(fine), True),
            Curve("measured, one front brake,\na cycle of real drives", fine[[0, -1]], np.full(2, 4.5), True),
            Curve("model, car: UDDS, WLTC,\nUS06, HWFET", np.array(means), cars, False),
            Curve("model, one front brake", np.array(means), np.array(masses), False),
        ],
        (0.0, 14.0),
    )
