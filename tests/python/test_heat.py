"""Temperatures of the contact line against a solver that shares no code and no reduction with it.

Fourier series along the strip, finite volumes in its depth and in the punch, implicit Euler with steps h and h/2 extrapolated. Springs on a
rigid strip keep the pressure uniform; the contact is so deep that no heat spreads across it.
"""

import numpy as np
import pytest

from sliding_contact import Scene

AMBIENT, DEPTH, FRICTION = 300.0, 10.0, 0.4
METAL = {"conductivity": 50.0, "capacity": 3.9e6}
LINING = {"conductivity": 2.0, "capacity": 2.2e6}


def layers(height, count=30):
    """Thicknesses that grow from both faces towards the middle, m."""
    half = 1.15 ** np.arange(count)
    both = np.concatenate([half, half[::-1]])
    return both * (height / both.sum())


class Bodies:
    """Punch of `width` in m on a closed strip of `ratio` widths. Cooling by convection, wind and radiation, W/(m2 K); all SI units."""

    def __init__(self, step, width, ratio, points, punch, strip, conductance, cooling, start):
        self.step, self.ratio, self.cells, self.spacing = step, ratio, points // ratio, width * ratio / points
        self.conductance, self.cooling = conductance, cooling
        self.wave = 2.0 * np.pi * np.fft.rfftfreq(points, self.spacing)
        self.strip, self.punch = layers(strip["height"]), layers(punch["height"])
        self.half = [0.5 * d[0] / b["conductivity"] for d, b in ((self.punch, punch), (self.strip, strip))]
        # One layered system for each Fourier mode of the strip and each cosine of the punch, whose sides are insulated.
        across = np.pi * np.arange(self.cells) / width
        self.cosines = np.cos(across * (np.arange(self.cells)[:, None] + 0.5) * self.spacing)
        self.analysis = np.linalg.inv(self.cosines)
        systems = [self.system(self.punch, punch, across), self.system(self.strip, strip, self.wave)]
        self.inverse, self.storage = zip(*systems)
        surface = [inverse[:, 0, 0] + half for inverse, half in zip(self.inverse, self.half)]
        self.by_punch = self.cosines @ (surface[0][:, None] * self.analysis)
        around = np.fft.irfft(surface[1], points)
        self.by_strip = around[(np.arange(points)[:, None] - np.arange(points)) % points]
        self.states = [np.zeros((len(across), len(self.punch))), np.zeros((len(self.wave), len(self.strip)), complex)]
        self.states[0][0], self.states[1][0] = start[0], start[1] * points
        self.position, self.top = 0.0, np.full(points, float(start[1]))
        self.far = [float(value) for value in start]

    def system(self, thickness, body, wave):
        between = body["conductivity"] / (0.5 * (thickness[1:] + thickness[:-1]))
        storage = body["capacity"] * thickness / self.step
        matrix = np.diag(storage) - np.diag(between, 1) - np.diag(between, -1)
        matrix += np.diag(np.append(between, 0.0)) + np.diag(np.append(0.0, between))
        along = np.einsum("k,ij->kij", wave**2, np.diag(body["conductivity"] * thickness))
        return np.linalg.inv(matrix + along), storage

    def transfer(self, side, velocity, temperature):
        constant, wind, emissivity = self.cooling[side][:3]
        radiation = emissivity * 5.670374419e-8 * (temperature**2 + AMBIENT**2) * (temperature + AMBIENT)
        return constant + wind * abs(velocity) ** 0.8 + radiation

    def advance(self, velocity, pressure):
        self.position += velocity * self.step
        turned = np.exp(1j * self.wave * self.position)
        n, heat = self.cells, FRICTION * pressure * abs(velocity)
        for _ in range(3):
            flux = [self.transfer(side, velocity, self.far[side]) * (AMBIENT - self.far[side]) for side in (0, 1)]
            flux[0] += self.cooling[0][3] * (AMBIENT - self.far[0])
            loads = [state * storage for state, storage in zip(self.states, self.storage)]
            for side, scale in ((0, 1.0), (1, len(self.top))):
                loads[side][0, -1] += flux[side] * scale
            free = [np.einsum("kij,kj->ki", inverse, load) for inverse, load in zip(self.inverse, loads)]
            above, below = self.cosines @ free[0][:, 0], np.fft.irfft(free[1][:, 0] * turned, len(self.top))
            # Flux f into the strip: -h (T - T_a) beside the contact, T_1 - T_2 = (f - (Q - f))/(2 h_c) under it, or 0.
            h = self.transfer(1, velocity, self.top[n:])
            matrix, given = np.eye(len(self.top)), np.zeros(len(self.top))
            matrix[n:] += h[:, None] * self.by_strip[n:]
            given[n:] = h * (AMBIENT - below[n:])
            if pressure > 0.0:
                matrix[:n] = self.by_strip[:n]
                matrix[:n, :n] += self.by_punch + np.eye(n) / self.conductance
                given[:n] = above + heat * self.by_punch.sum(1) - below[:n] + 0.5 * heat / self.conductance
            into_strip = np.linalg.solve(matrix, given)
            into_punch = heat - into_strip[:n] if pressure > 0.0 else np.zeros(n)
            self.top = below + self.by_strip @ into_strip
            after = [
                free[0] + self.inverse[0][:, :, 0] * (self.analysis @ into_punch)[:, None],
                free[1] + self.inverse[1][:, :, 0] * (np.fft.rfft(into_strip) * turned.conj())[:, None],
            ]
            last = [after[0][0, -1], after[1][0, -1].real / len(self.top)]
            self.far = [t + q * half * d[-1] / d[0] for t, q, half, d in zip(last, flux, self.half, (self.punch, self.strip))]
        self.states = after
        self.contact = 0.5 * (self.top[:n] + above + self.by_punch @ into_punch)

    def temperatures(self):
        punch = self.states[0][0] @ self.punch / self.punch.sum()
        strip = self.states[1][0].real @ self.strip / self.strip.sum() / len(self.top)
        return [punch, strip, self.contact.mean()]


SLOW = [(0, 0), (2, 0.02), (4, 0), (6, 0), (7, -0.03), (9, -0.03), (10, 0), (16, 0), (17, 0.05), (20, 0.05)]
STROKES = [(t + dt, s * v) for t, s in zip(range(0, 20, 2), [1, -1] * 5) for dt, v in ((0.0, 0.0), (0.1, 0.01), (1.9, 0.01))] + [(20, 0.0)]
BRAKE = [(0, 2.0), (0.3, 0.0), (0.5, 0.0), (0.6, -1.5), (1.0, -1.0)]
STILL = (0.0, 0.0, 0.0, 0.0)
CASES = {
    "slow, cooled": dict(course=SLOW, start=(300, 450), cooling=[(50, 0, 0, 0), (300, 0, 0, 0)]),
    "slow, as if it were to last": dict(course=SLOW, start=(300, 450), cooling=[(50, 0, 0, 0), (300, 0, 0, 0)], nominal=(1.0, 2000)),
    "poor conductors": dict(course=SLOW, start=(300, 450), punch=LINING, strip=LINING),
    "strokes": dict(course=STROKES, start=(400, 300), pressure=5e6, width=0.02, stroke=0.018),
    "opened at rest": dict(course=BRAKE, start=(300, 300), step=5e-4, ratio=4, closed=lambda t: not 0.38 < t < 0.44),
    "radiation, wind and a heat path": dict(course=SLOW, start=(500, 900), cooling=[(30, 200, 0.5, 500), (20, 500, 0.9, 0)]),
}


@pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")
@pytest.mark.parametrize("name", CASES)
def test_temperatures_are_those_of_finite_volumes(name):
    own = dict(punch=LINING, strip=METAL, pressure=1e6, width=0.04, ratio=8, points=128, cooling=[STILL, STILL], step=0.04,
               nominal=(0.1, 20), stroke=0.0, closed=lambda t: True) | CASES[name]
    course = np.array(own["course"], float)
    times, pressure, width = course[:, 0], own["pressure"], own["width"]
    bodies = [own["punch"] | {"height": 0.012}, own["strip"] | {"height": 0.011}]
    marks = [round(part * times[-1] / own["step"]) * own["step"] for part in (0.1, 0.35, 0.6, 1.0)]
    solutions = []
    for step in (own["step"], 0.5 * own["step"]):
        reference = Bodies(step, width, own["ratio"], own["points"], *bodies, 2e4, own["cooling"], own["start"])
        found, instants = [], {round(mark / step) for mark in marks}
        for number in range(round(times[-1] / step)):
            middle = (number + 0.5) * step
            reference.advance(np.interp(middle, times, course[:, 1]), pressure if own["closed"](middle) else 0.0)
            if number + 1 in instants:
                found.append(reference.temperatures())
        solutions.append(np.array(found))
    expected = 2.0 * solutions[1] - solutions[0]
    scene = Scene.load("pin_on_disk").copy()
    for side, body, cooling, start in zip(("punch", "strip"), bodies, own["cooling"], own["start"]):
        cools = "convecting" if any(cooling[:3]) else "insulated"
        values = {"height": body["height"], "conductivity": body["conductivity"], "density": 1000.0, "specific_heat": body["capacity"] / 1000.0,
                  "thermal_expansion": 0.0, "wear_coefficient": 0.0, "convection": cooling[0], "convection_forced": cooling[1],
                  "emissivity": cooling[2], "initial_at_ambient": False, "initial_temperature": start, "youngs_modulus": 1e9,
                  "top_thermal" if side == "punch" else "base_thermal": cools}
        scene.set({f"{side}.{key}": value for key, value in values.items()})
    conductance = own["cooling"][0][3] * width * DEPTH
    scene.set({
        "depth": DEPTH, "ambient_temperature": AMBIENT, "punch.width": width, "punch.body": "winkler", "strip.body": "rigid",
        "punch.cooled_area": 1e-9, "punch.external_conductance": conductance, "punch.external_temperature": AMBIENT,
        "strip.path": "straight" if own["stroke"] else "closed", "strip.length": 0.0 if own["stroke"] else own["ratio"] * width,
        "nominal.load": pressure * width * DEPTH, "nominal.velocity": own["nominal"][0], "nominal.duration": own["nominal"][1],
        "nominal.stroke": own["stroke"], "contact.conductance": 2e4, "contact.friction_coefficient": FRICTION,
        "solver.fidelity": "line", "solver.cells": 17, "solver.tolerance": 1e-3,
    })
    rows = sorted({*times, *(t for t in (0.38, 0.44) if not own["closed"](0.4))})
    before = [own["closed"](t - 1e-9) for t in rows]
    after = [own["closed"](t + 1e-9) for t in rows]
    inputs = {"time [s]": np.repeat(rows, 2), "sliding_velocity [m/s]": np.repeat(np.interp(rows, times, course[:, 1]), 2),
              "normal_load [N]": pressure * width * DEPTH * np.array([before, after], float).T.ravel()}
    result = scene.simulate(inputs, at=marks)
    instants = [int(np.argmin(np.abs(result["time"] - mark))) for mark in marks]
    found = np.array([result[key][instants] for key in ("punch.mean_temperature", "strip.mean_temperature", "contact_temperature")]).T
    if own["stroke"]:
        # The mean of an open track is that of another length.
        found[:, 1] = expected[:, 1]
    scale = max(np.abs(expected - AMBIENT).max(), *(start - AMBIENT for start in own["start"]))
    apart = np.abs(found - expected) / scale
    assert apart.max() < 2e-3, (apart, found, expected)
