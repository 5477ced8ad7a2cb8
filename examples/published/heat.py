"""Cases of heat: stops, flash temperatures, discs."""

from collections.abc import Callable

import closed_forms as published
import numpy as np
from model import Model
from results import Comparison, Curve, Result, rise, table_of

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
