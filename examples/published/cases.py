"""The cases: for each the published solution, the model's and what is drawn. Sources are in README.md."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field

import closed_forms as published
import numpy as np
from model import FOLDER, Model, Run

sys.path.append(str(FOLDER.parent / "disc_brake"))

import road_load  # noqa: E402  (of the example beside this one)

AMBIENT = 293.15


@dataclass(frozen=True)
class Comparison:
    """One number: deviation is (model - published) / published, and has to stay within `band`, (lowest, highest)."""

    quantity: str
    unit: str
    published: float
    model: float
    band: tuple[float, float]

    @property
    def deviation(self) -> float:
        return self.model / self.published - 1.0

    @property
    def holds(self) -> bool:
        return self.band[0] <= self.deviation <= self.band[1]


@dataclass(frozen=True)
class Curve:
    label: str
    x: np.ndarray
    y: np.ndarray
    published: bool
    points: bool = False  # published values that are marked one by one


@dataclass(frozen=True)
class Result:
    title: str
    x: str
    y: str
    comparisons: list[Comparison]
    curves: list[Curve] = field(default_factory=list)
    limits: tuple[float, float] | None = None  # of the vertical axis


@dataclass(frozen=True)
class Case:
    compute: Callable[[Model], Result]
    change: str  # a change of the model that its bands must not survive


def rise(run: Run, name: str = "temperature") -> np.ndarray:
    return run[name] - AMBIENT


def table_of(times: np.ndarray, velocities: np.ndarray, loads: np.ndarray) -> str:
    """Inputs as a file has them."""
    rows = zip(times.tolist(), velocities.tolist(), loads.tolist(), strict=True)
    return "time [s],sliding_velocity [m/s],normal_load [N]\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in rows)


FLUX, STOP = 1e6, 4.0  # W/m2 at the start, s
IRON = (54.0, 7200.0 * 460.0)  # W/(m.K), J/(m3.K)


def single_stop(model: Model) -> Result:
    run = model.simulate("single_stop", "inputs.csv")
    time, conductivity, capacity = run["time"], *IRON
    effusivity = np.sqrt(conductivity * capacity)
    disc = published.stop_disc(FLUX, STOP, 0.011, conductivity, conductivity / capacity, time)
    half_space = published.stop_half_space(FLUX, STOP, effusivity, time)
    limpert = np.sqrt(5.0 / 18.0) * FLUX * np.sqrt(STOP) / effusivity
    # As far as heat has not reached the mid plane the disc is a half-space.
    early = np.searchsorted(time, 0.4)
    return Result(
        "Single stop",
        "time (s)",
        "rise at the surface (K)",
        [
            Comparison("highest rise, disc", "K", disc.max(), rise(run).max(), (-1e-3, 1e-3)),
            Comparison("rise after 0.4 s, half-space", "K", half_space[early], rise(run)[early], (-2e-3, 2e-3)),
            Comparison("highest rise, formula for thick discs", "K", limpert, rise(run).max(), (0.01, 0.025)),
        ],
        [
            Curve("disc of 22 mm", time, disc, True),
            Curve("half-space", time, half_space, True),
            Curve("model", time, rise(run), False),
        ],
    )


def repeated_stops(model: Model) -> Result:
    count, interval, transfer = 15, 60.0, 100.0
    ramp = 1e-3
    rows = ["time [s],sliding_velocity [m/s],normal_load [kN]", "0,10,9.625"]
    for index in range(count):
        start = index * interval
        rows += [f"{start + STOP},0,9.625", f"{start + STOP + ramp},0,0", f"{start + interval - ramp},10,0"]
        rows += [f"{start + interval},10,9.625"] if index + 1 < count else []
    settings = (f"strip.convection={transfer}", "strip.cooled_area=0.0385", "nominal.duration=60")
    run = model.simulate("single_stop", "\n".join(rows) + "\n", settings, step=0.2)
    time, capacity = run["time"], IRON[1] * 0.011
    stops = np.arange(1, count + 1)
    after = published.repeated_stops(FLUX * STOP / 2.0 / capacity, transfer * interval / capacity, stops)
    ends = (stops - 1) * interval + STOP
    computed = np.interp(ends, time, rise(run, "disc"))
    return Result(
        "Fifteen stops, one a minute",
        "time (s)",
        "mean rise of the disc (K)",
        [
            Comparison("rise after the first stop", "K", after[0], computed[0], (-0.02, 0.0)),
            Comparison("rise after the fifteenth stop", "K", after[-1], computed[-1], (-0.05, 0.0)),
        ],
        [Curve("after a stop", ends, after, True, points=True), Curve("model", time, rise(run, "disc"), False)],
    )


def clutch_engagement(model: Model) -> Result:
    run = model.simulate("clutch_engagement", "inputs.csv")
    plate, facing = np.sqrt(45.0 * 7800.0 * 460.0), np.sqrt(10.0 * 5500.0 * 460.0)
    rises = published.stop_half_space(FLUX, 1.0, plate + facing, run["time"])
    share = run["strip_heat"][-1] / run["heat"][-1]
    return Result(
        "Engagement of a clutch",
        "time (s)",
        "rise at the interface (K)",
        [
            Comparison("highest rise", "K", rises.max(), rise(run).max(), (-1e-3, 1e-3)),
            Comparison("heat into the plate", "1", plate / (plate + facing), share, (-2e-3, 2e-3)),
        ],
        [Curve("two half-spaces", run["time"], rises, True), Curve("model", run["time"], rise(run), False)],
    )


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


def flash_temperature(model: Model) -> Result:
    conductivity, diffusivity, half = 45.0, 45.0 / (7800.0 * 460.0), 1e-3
    comparisons, means, maxima, peclets = [], [], [], (0.5, 1.0, 2.0, 5.0, 10.0)
    for peclet in peclets:
        speed = 2.0 * peclet * diffusivity / half
        # A band: 1 m deep, so that nothing spreads to its sides.
        settings = (f"nominal.velocity={speed!r}", f"nominal.duration={2.0 / speed!r}")
        run = model.simulate("flash_temperature", settings=settings)
        scale = conductivity / (0.5 * 1e3 / (2e-3 * 1.0) * speed * half)
        means.append(rise(run)[-1] * scale)
        maxima.append(rise(run, "highest")[-1] * scale)
    places = np.linspace(-1.0, 1.0, 2001)
    exact = [published.band_source(peclet, places) for peclet in peclets]
    for peclet, field_, mean, top in zip(peclets, exact, means, maxima, strict=True):
        if peclet in (1.0, 10.0):
            comparisons.append(Comparison(f"mean at Pe = {peclet:g}", "TK/(ql)", field_.mean(), mean, (-0.01, 0.01)))
            comparisons.append(Comparison(f"highest at Pe = {peclet:g}", "TK/(ql)", field_.max(), top, (-0.02, 0.01)))
    fine = np.geomspace(0.5, 10.0, 25)
    fields = [published.band_source(peclet, places) for peclet in fine]
    return Result(
        "Band source on a half-space",
        "Péclet number V l/(2κ)",
        "rise × K/(q l)",
        comparisons,
        [
            Curve("highest", fine, np.array([values.max() for values in fields]), True),
            Curve("model", np.array(peclets), np.array(maxima), False),
            Curve("mean", fine, np.array([values.mean() for values in fields]), True),
            Curve("model", np.array(peclets), np.array(means), False),
        ],
    )


def pin_flash_temperature(model: Model) -> Result:
    conductivity, diffusivity, half = 45.0, 45.0 / (7800.0 * 460.0), 1e-3
    peclets, means, maxima = (0.5, 1.0, 2.0, 5.0, 10.0), [], []
    for peclet in peclets:
        speed = 2.0 * peclet * diffusivity / half
        settings = (f"nominal.velocity={speed!r}", f"nominal.duration={0.2 / speed!r}", "depth=2 mm", "nominal.load=2 N")
        run = model.simulate("flash_temperature", settings=settings)
        scale = conductivity / (0.5 * 2.0 / 4e-6 * speed * half)
        means.append(rise(run)[-1] * scale)
        maxima.append(rise(run, "highest")[-1] * scale)
    # The circle of the square's area.
    radius = 2.0 / np.sqrt(np.pi)

    def mean(peclet: published.ArrayLike) -> published.ArrayLike:
        return radius * published.flash_mean(radius * peclet)

    comparisons = []
    for index in (1, 4):
        peclet = peclets[index]
        comparisons.append(Comparison(f"mean at Pe = {peclet:g}", "TK/(ql)", float(mean(peclet)), means[index], (-0.01, 0.03)))
        highest = float(published.flash_maximum(peclet))
        comparisons.append(Comparison(f"highest at Pe = {peclet:g}", "TK/(ql)", highest, maxima[index], (-0.12, -0.05)))
    fine = np.geomspace(0.5, 10.0, 60)
    return Result(
        "Square pin on a plate",
        "Péclet number V l/(2κ)",
        "rise × K/(q l)",
        comparisons,
        [
            Curve("highest, on the axis", fine, np.asarray(published.flash_maximum(fine)), True),
            Curve("model, highest", np.array(peclets), np.array(maxima), False),
            Curve("mean, circle of equal area", fine, np.asarray(mean(fine)), True),
            Curve("model, mean", np.array(peclets), np.array(means), False),
        ],
    )


def hot_spot_growth(model: Model) -> Result:
    diffusivity, wave = 45.0 / (7800.0 * 460.0), 2.0 * np.pi / 0.01
    critical = 2.0 * 45.0 * wave * 0.7 / (0.3 * 200e9 * 12e-6)
    ratios, rates = (1.5, 2.0, 3.0, 4.0, 6.0), []
    for ratio in ratios:
        duration = 6.0 / max(abs(float(published.growth(ratio))) * diffusivity * wave**2, 1.0)
        speed = ratio * critical
        settings = (f"nominal.velocity={speed!r}", f"nominal.duration={duration!r}")
        times = tuple(duration * (0.5 + 0.1 * index) for index in range(6))
        run = model.simulate("hot_spot_growth", settings=settings, at=times, step=duration / 200.0)
        waves = []
        for index in range(len(times)):
            x, p = run.profile(index, "x")[:-1], run.profile(index, "pressure")[:-1]
            waves.append(np.log(abs(np.sum(p * np.exp(1j * wave * x)))))
        rates.append(np.polyfit(times, waves, 1)[0] / (diffusivity * wave**2))
    fine = np.linspace(1.0, 6.5, 100)
    comparisons = [Comparison("critical speed", "m/s", critical, float(run["critical"][-1]), (-0.01, 0.01))]
    for ratio, rate in zip(ratios, rates, strict=True):
        comparisons.append(
            Comparison(f"growth rate at {ratio:g} times it", "b/(κm²)", float(published.growth(ratio)), rate, (-0.03, 0.03))
        )
    return Result(
        "Growth of hot spots",
        "speed over the critical speed",
        "growth rate over κ m²",
        comparisons,
        [Curve("half-plane on insulator", fine, published.growth(fine), True), Curve("model", np.array(ratios), np.array(rates), False)],
    )


def disc_critical_speed(model: Model) -> Result:
    pad = published.Solid(0.53e9, 0.25, 30e-6, 0.5, 0.5 / (1859.0 * 1000.0))
    disc = published.Solid(125e9, 0.25, 12e-6, 54.0, 54.0 / (7200.0 * 577.8))
    halves, computed, exact = (4.0, 5.5, 8.0), [], []

    def least(half: float) -> float:
        waves = [2.0 * np.pi * count / 0.8 for count in range(2, 12)]
        return min(published.disc_critical_speed(pad, disc, half, 0.4, wave) for wave in waves)

    for half in halves:
        run = model.simulate("disc_critical_speed", settings=(f"strip.height={half} mm", "solver.fidelity=lumped"))
        computed.append(float(run["critical"][0]))
        exact.append(least(1e-3 * half))
    fine = np.linspace(3.5, 8.5, 101)
    return Result(
        "Critical speed of a disc between pads",
        "half-thickness of the disc (mm)",
        "critical speed (m/s)",
        [
            Comparison(f"critical speed, disc of {2.0 * half:g} mm", "m/s", one, other, (-0.01, 0.01))
            for half, one, other in zip(halves, exact, computed, strict=True)
        ],
        [
            Curve("layer between half-planes,\nwhole waves round the ring", fine, np.array([least(1e-3 * half) for half in fine]), True),
            Curve("model", np.array(halves), np.array(computed), False),
        ],
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


def hot_bands(model: Model) -> Result:
    bronze = published.Solid(30e9, 0.3, 18e-6, 10.0, 10.0 / (5500.0 * 460.0))
    steel = published.Solid(200e9, 0.3, 12e-6, 45.0, 45.0 / (7800.0 * 460.0))
    bodies, friction, half = (bronze, steel), 0.3, 6e-3
    wave = 2.0 * np.pi / 3e-3
    critical = published.band_speed(bodies, friction, wave, 0.0)
    scale = steel.diffusivity * wave**2

    # Gap under which a uniform pressure presses two half-planes together, a fifth less for the thermal crowning; and a wave
    # that fades out towards the edges.
    stations = np.linspace(-half, half, 33)
    near, far = half - np.abs(stations), half + np.abs(stations)
    even = far * np.log(far) + np.where(near > 0.0, near * np.log(np.maximum(near, 1e-9)), 0.0)
    compliance = sum((1.0 - body.poisson**2) / body.modulus for body in bodies)
    crown = 0.8 * 2.0 * 1e6 * compliance / np.pi * (even - even.min())
    ripple = 3e-11 * np.cos(0.5 * np.pi * stations / half) ** 2 * np.cos(wave * stations)

    # At 6 times it the bands that grow from the edges open the contact within the time of the fit.
    ratios, exact, rates = (2.0, 3.0, 4.0, 5.0), [], []
    for ratio in ratios:
        rate = published.band_growth(bodies, friction, wave, ratio * critical)
        duration = 4.0 / rate
        times = tuple(duration * (0.5 + 0.1 * index) for index in range(5))
        settings = (f"nominal.velocity={ratio * critical!r}", f"nominal.duration={duration!r}")
        profiles = []
        for sign in (-1.0, 1.0):
            gap = crown + 6e-11 + sign * ripple
            table = tuple(f"contact.initial_gap[{index + 1}]={float(value)!r}" for index, value in enumerate(gap))
            run = model.simulate("hot_bands", settings=settings + table, at=times, step=duration / 100.0)
            x = run.profile(0, "x")
            profiles.append(np.array([run.profile(index, "pressure") for index in range(len(times))]))
        # The bands that grow from the edges are the same in both runs.
        amplitudes = np.abs((profiles[1] - profiles[0]) @ np.exp(1j * wave * x))
        exact.append(rate / scale)
        rates.append(np.polyfit(times, np.log(amplitudes), 1)[0] / scale)
    # Arcs shorter than the width is wide, so that no longer wave round the ring comes first; together they cover it.
    arcs = ("contact.mean_radius=1 m", "punch.count=1000", "depth=6.2706 mm", "solver.fidelity=lumped")
    run = model.simulate("hot_bands", settings=arcs)
    longest = published.band_speed(bodies, friction, 0.5 * np.pi / half, 0.0)
    comparisons = [Comparison("critical speed, half a wave across", "m/s", longest, float(run["critical"][0]), (-0.01, 0.01))]
    for ratio, one, other in zip(ratios, exact, rates, strict=True):
        comparisons.append(Comparison(f"growth rate at {ratio:g} times it", "b/(κm²)", one, other, (-0.03, 0.03)))
    fine = np.linspace(1.0, 5.5, 100)
    growth = np.array([published.band_growth(bodies, friction, wave, ratio * critical) for ratio in fine]) / scale
    return Result(
        "Bands across the radius of two rings",
        "speed over the critical speed of the wave",
        "growth rate over κ m² of the steel",
        comparisons,
        [
            Curve("wave at rest in\ntwo half-planes", fine, growth, True),
            Curve("model", np.array(ratios), np.array(rates), False),
        ],
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


def railway_disc(model: Model) -> Result:
    run = model.simulate("railway_disc", "inputs.csv")
    ambient = 60.0
    # Read off the vector figure of the source: the finite elements smoothed over 30 steps, the measurement averaged over a second.
    times = np.array([10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 48.0])
    elements = np.array([155.8, 177.5, 192.0, 199.1, 205.8, 204.8, 202.1, 198.8, 197.3])
    measured = np.array([148.6, 201.8, 199.9, 196.8, 200.4, 199.4, 195.6, 192.9, 188.3])
    course = run["temperature"] - 273.15
    at = np.interp(times, run["time"], course) - ambient
    comparisons = [
        Comparison("highest rise, finite elements", "K", elements.max() - ambient, course.max() - ambient, (-0.02, 0.02)),
        Comparison("highest rise, measured", "K", measured.max() - ambient, course.max() - ambient, (0.0, 0.05)),
        Comparison("rise after 20 s, finite elements", "K", elements[2] - ambient, at[2], (-0.06, -0.02)),
        Comparison("rise after 20 s, measured", "K", measured[2] - ambient, at[2], (-0.12, -0.07)),
        Comparison("rise after 48 s, measured", "K", measured[-1] - ambient, at[-1], (0.06, 0.1)),
    ]
    return Result(
        "Railway disc, stop from 160 km/h",
        "time (s)",
        "temperature of the face (°C)",
        comparisons,
        [
            Curve("finite elements", times, elements, True, points=True),
            Curve("measured", times, measured, True, points=True),
            Curve("model", run["time"], course, False),
        ],
    )


def ring_disc(model: Model) -> Result:
    share = share_of_disc(51.0 / np.sqrt(1.44e-5), 34.3 / np.sqrt(1.46e-5))
    duration, start = 3.96, 293.15

    def flux(r: np.ndarray, time: float, face: np.ndarray) -> np.ndarray:
        return share * 0.5 * 88.464 * 1.47e6 / (2.0 * np.pi - 0.8) * r * (1.0 - time / duration)

    constant = (lambda value: np.full_like(value, 51.0), lambda value: np.full_like(value, 51.0 / 1.44e-5))
    r, face, highest = published.heated_annulus((0.066, 0.0755, 0.1135), 5.5e-3, flux, duration, *constant, start)
    run = model.simulate("ring_disc", "inputs.csv", at=(duration,))
    radii = 94.5 + 1e3 * run.profile(0, "x")
    temperature = run.profile(0, "local_temperature") - 273.15
    comparisons = [
        Comparison("rise at the rim, finite volumes", "K", face[-1] - start, temperature[-1] - 20.0, (-0.003, 0.003)),
        Comparison("highest rise, finite volumes", "K", highest - start, run["highest"].max() - start, (-0.003, 0.003)),
        Comparison(
            "rise under the pad's inner edge, ring from 66 mm",
            "K",
            float(np.interp(0.0755, r, face)) - start,
            temperature[0] - 20.0,
            (0.8, 1.2),
        ),
        Comparison("rise at the rim, printed", "K", 88.224 - 20.0, temperature[-1] - 20.0, (0.12, 0.17)),
    ]
    return Result(
        "Disc of 113.5 mm at the end of a stop",
        "radius (mm)",
        "temperature of the face (°C)",
        comparisons,
        [
            Curve("ring from 66 mm,\nfinite volumes", 1e3 * r, face - 273.15, True),
            Curve("printed extremes", np.array([66.0, 113.5]), np.array([34.179, 88.224]), True, points=True),
            Curve("model, ring from 75.5 mm", radii, temperature, False),
        ],
    )


def share_of_disc(disc: published.ArrayLike, pad: float) -> published.ArrayLike:
    """Part of the heat that enters the disc, by effusivities."""
    return disc / (disc + pad)


Laws = tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray]]


def car_disc(model: Model) -> Result:
    start, duration, mass, drag = 298.0, 5.0, 1200.0, 0.5 * 1.2 * 0.6
    friction, wheel, radius, density = 0.4, 0.3, 0.1225, 7200.0
    pad, patch, covered = np.sqrt(2.5 * 1900.0 * 950.0), 0.00587958, 50.0 / 360.0

    def conductivity(value: np.ndarray) -> np.ndarray:
        return 40.792345 - 8.2209906e-5 * (value - 490.413792) ** 2

    def capacity(value: np.ndarray) -> np.ndarray:
        return 2.67410206e6 + 2067.65696 * value

    def share(value: np.ndarray, laws: Laws) -> np.ndarray:
        return share_of_disc(np.sqrt(laws[0](value) * laws[1](value)), pad)

    def force(first: float, speed: published.ArrayLike) -> published.ArrayLike:
        # One face takes an eighth of what brakes the car.
        return (mass * first / duration - drag * speed**2) / 8.0

    def heated(first: float, laws: Laws) -> float:
        def flux(r: np.ndarray, time: float, face: np.ndarray) -> np.ndarray:
            speed = first * (1.0 - time / duration)
            return share(face, laws) * force(first, speed) * speed / patch * covered

        return published.heated_annulus((0.08, 0.095, 0.15), 7.5e-3, flux, duration, *laws, start)[2] - start

    def modelled(first: float, laws: Laws, settings: tuple[str, ...]) -> float:
        times = np.linspace(0.0, duration, 101)
        speed, face = first * (1.0 - times / duration), np.full_like(times, start)
        # The share follows the temperature of the face: that of the run before.
        for _ in range(4):
            load = share(face, laws) * force(first, speed) / friction * wheel / radius
            run = model.simulate("car_disc", table_of(times, speed * radius / wheel, load), settings)
            face = np.interp(times, run["time"], run["temperature"])
        return float(run["temperature"].max()) - start

    points = np.linspace(start, start + 330.0, 12)
    columns = {"temperature": points, "conductivity": conductivity(points), "specific_heat": capacity(points) / density}
    tables = tuple(
        f"strip.property_table.{name}[{index + 1}]={float(values[index])!r}" for name, values in columns.items() for index in range(12)
    )
    first = (conductivity(np.array(start)), capacity(np.array(start)))
    constants = (lambda value: np.full_like(value, first[0]), lambda value: np.full_like(value, first[1]))
    kinds = ((constants, ()), ((conductivity, capacity), ("strip.property_table.points=12", *tables)))
    speeds = np.array([50.0, 100.0, 150.0, 200.0, 250.0])
    elements = np.array([[13.816, 52.235, 111.621, 191.502, 287.948], [13.771, 51.595, 108.718, 183.283, 270.098]])
    volumes = np.array([[heated(speed / 3.6, laws) for speed in speeds] for laws, _ in kinds])
    runs = np.array([[modelled(speed / 3.6, laws, settings) for speed in speeds] for laws, settings in kinds])
    comparisons = []
    for index in (1, 4):
        at = f"{speeds[index]:g} km/h"
        for kind, text in enumerate(("constants", "tables")):
            band = (-0.003, 0.003)
            comparisons.append(Comparison(f"{at}, {text}, finite volumes", "K", volumes[kind, index], runs[kind, index], band))
        comparisons.append(Comparison(f"{at}, tables, finite elements", "K", elements[1, index], runs[1, index], (-0.02, 0.13)))
    lowered = [1.0 - values[1, -1] / values[0, -1] for values in (elements, runs)]
    comparisons.append(Comparison("tables lower 250 km/h by, finite elements", "1", *lowered, (-0.2, 0.0)))
    scale = (speeds / 100.0) ** 2
    return Result(
        "Properties over temperature in a stop of 5 s",
        "speed at the start (km/h)",
        "rise over speed² (K/(100 km/h)²)",
        comparisons,
        [
            Curve("finite elements, constants", speeds, elements[0] / scale, True, points=True),
            Curve("finite elements, tables", speeds, elements[1] / scale, True, points=True),
            Curve("finite volumes, constants", speeds, volumes[0] / scale, True),
            Curve("finite volumes, tables", speeds, volumes[1] / scale, True),
            Curve("model, constants", speeds, runs[0] / scale, False),
            Curve("model, tables", speeds, runs[1] / scale, False),
        ],
        (42.0, 57.0),
    )


def moving_source(model: Model) -> Result:
    start, duration = 293.15, 16.0
    inputs = "time [s],sliding_velocity [m/s],normal_load [kN]\n0,1,96\n16,1,96\n"
    geometry = (0.2, 0.011, 0.04, 1.0, 6e6, duration)
    times, *exact = published.moving_source(*geometry, published.steel_conductivity, published.steel_capacity, start, 0.1)
    # Constants of 20 degC, at every point of the table.
    cold = {
        "conductivity": float(published.steel_conductivity(np.array(start))),
        "specific_heat": float(published.steel_capacity(np.array(start))) / 7850.0,
    }
    constants = tuple(f"strip.property_table.{name}[{index + 1}]={value!r}" for name, value in cold.items() for index in range(16))
    quantities = ("disc", "temperature", "highest")
    names = ("mean of the strip", "contact", "hottest point")
    comparisons, curves = [], []
    levels = (
        ("line", (), ((0.0, 0.005), (-0.005, 0.0), (-0.005, 0.0))),
        ("lumped", ("solver.fidelity=lumped",), ((0.0, 0.005), (-0.005, 0.01), (-0.07, -0.05))),
        ("line, constants", constants, ((0.15, 0.3), (0.1, 0.2), (0.08, 0.2))),
    )
    for label, settings, bands in levels:
        run = model.simulate("moving_source", inputs, settings)
        for quantity, name, values, band in zip(quantities, names, exact, bands, strict=True):
            course = np.interp(times, run["time"], run[quantity])
            # Where it is furthest off over the highest rise, from 0.2 s on: five times the length of the contact.
            worst = int(np.argmax(np.where(times >= 0.2, np.abs(course - values), 0.0)))
            top = float(values.max()) - start
            comparisons.append(Comparison(f"{label}, {name}", "K", top, top + float(course[worst] - values[worst]), band))
            if (label, quantity) in (("line", "highest"), ("line", "disc"), ("line, constants", "disc")):
                curves.append(Curve(f"{label}, {name}", run["time"], run[quantity] - 273.15, False))
    return Result(
        "Properties over temperature under a moving source",
        "time (s)",
        "temperature (°C)",
        comparisons,
        [
            Curve("local properties, hottest point", times, exact[2] - 273.15, True),
            Curve("local properties, mean", times, exact[0] - 273.15, True),
            *curves,
        ],
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


CASES = {
    "single_stop": Case(single_stop, "strip.conductivity=50"),
    "repeated_stops": Case(repeated_stops, "strip.density=6800"),
    "clutch_engagement": Case(clutch_engagement, "punch.conductivity=11"),
    "uniform_wear": Case(uniform_wear, "punch.wear_velocity_exponent=0.9"),
    "flat_punch_wear": Case(flat_punch_wear, "punch.poissons_ratio=0.25"),
    "sliding_punch": Case(sliding_punch, "contact.shear_coupling=false"),
    "flash_temperature": Case(flash_temperature, "strip.conductivity=42"),
    "pin_flash_temperature": Case(pin_flash_temperature, "strip.conductivity=42"),
    "hot_spot_growth": Case(hot_spot_growth, "punch.thermal_expansion=11e-6"),
    "disc_critical_speed": Case(disc_critical_speed, "strip.thermal_expansion=11e-6"),
    "hot_bands": Case(hot_bands, "strip.conductivity=50"),
    "block_on_ring": Case(block_on_ring, "punch.wear_coefficient=2.1e-15"),
    "fretting": Case(fretting, "contact.tangential_compliance=neglected"),
    "ball_wear": Case(ball_wear, "contact.initial_radius=4.6 mm"),
    "railway_disc": Case(railway_disc, "strip.density=7200"),
    "ring_disc": Case(ring_disc, "strip.specific_heat=480"),
    "car_disc": Case(car_disc, "strip.density=6900"),
    "moving_source": Case(moving_source, "strip.density=7700"),
    "brake_emissions": Case(brake_emissions, "punch.wear_coefficient=4e-5 mm3/(N.m)"),
    "wear_dissipation": Case(wear_dissipation, "punch.wear_pressure_exponent=0.8"),
    "reciprocating": Case(reciprocating, "punch.wear_pressure_exponent=0.8"),
}
