"""Cases of thermoelastic growth: critical speeds and rates."""

import closed_forms as published
import numpy as np
from model import Model
from results import Comparison, Curve, Result


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
