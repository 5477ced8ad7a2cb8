"""A disc brake between hub and caliper, two masses of a thermal network outside the FMU: temperature in, heat flow out."""

import numpy as np
import pytest
from component import Component

AIR = 293.15  # K
HUB = (2500.0, 4.0)  # capacity [J/K], conductance to the air [W/K]
CALIPER = (1800.0, 2.5)
PATHS = {"strip.external_conductance": 15.0, "punch.external_conductance": 2.0}  # W/K
PORTS = ("strip", "punch")


class Mass:
    """A lumped mass that exchanges heat with the FMU and the air."""

    def __init__(self, capacity, conductance):
        self.capacity, self.conductance, self.temperature = capacity, conductance, AIR
        self.lost = self.received = 0.0

    def rate(self, flow):
        """Rate of the temperature [K/s] at the heat flow `flow` [W] from the FMU."""
        return (flow - self.conductance * (self.temperature - AIR)) / self.capacity

    def take(self, received, step):
        """Advances by the heat [J] that came from the FMU over the step; heat goes to the air as at its middle (Crank-Nicolson)."""
        half = 0.5 * step * self.conductance / self.capacity
        rise = self.temperature - AIR
        after = (rise * (1.0 - half) + (received - self.received) / self.capacity) / (1.0 + half)
        self.lost += 0.5 * step * self.conductance * (rise + after)
        self.temperature, self.received = AIR + after, received

    @property
    def stored(self):
        return self.capacity * (self.temperature - AIR)


def run(fmu, step, seconds, **parameters):
    """Three stops and long cooling; temperatures of hub, caliper and disc over time, and the residual of the energy of all [1]."""
    masses = {"strip": Mass(*HUB), "punch": Mass(*CALIPER)}
    start = {f"{port}.external_temperature": AIR for port in PORTS}
    rows = []
    with Component(fmu) as component:
        component.initialise({"ambient_temperature": AIR, "punch.top_thermal": "insulated", **PATHS, **parameters, **start})
        for index in range(round(seconds / step)):
            time = index * step
            braking = time < 60.0 and time % 20.0 < 6.0
            # Held over the step at that of its middle, so that the friction heat of a stop is the same for every step.
            speed = 12.0 - 2.0 * (time % 20.0 + 0.5 * step)
            component.set(sliding_velocity=speed if braking else 0.0, normal_load=3000.0 if braking else 0.0)
            for port, mass in masses.items():
                component.set({f"{port}.external_temperature": mass.temperature})
            for port, mass in masses.items():
                reference = fmu.variables[f"{port}.external_temperature"].valueReference
                flow = component.get(f"heat_flow_{port}_external")
                component.slave.setRealInputDerivatives([reference], [1], [mass.rate(flow)])
            component.step(step)
            for port, mass in masses.items():
                mass.take(component.get(f"heat_lost_{port}_external"), step)
            rows.append([mass.temperature for mass in masses.values()] + [component.get("strip.mean_temperature")])
        faces = component.get("heat_lost_punch_top", "heat_lost_strip_base")
        ports = sum(mass.received for mass in masses.values())
        friction = component.get("dissipated_energy")
        out = component.get("stored_heat") + component.get("heat_lost_ambient") + faces.sum() - ports
        out += sum(mass.stored + mass.lost for mass in masses.values())
    return np.array(rows), abs(out / friction - 1.0), friction


@pytest.mark.parametrize("level", ["lumped", "line"])
def test_energy_is_closed_over_brake_hub_and_caliper(fmus, level):
    cells = {"solver.fidelity": level, "solver.cells": 5}
    rows, residual, friction = run(fmus(None), 0.5, 30.0, **cells)
    assert friction > 1e5 and residual < 1e-8
    assert rows[-1, 0] > AIR + 1.0 and rows[-1, 1] > AIR


def test_the_loop_converges_with_the_communication_step_and_the_neighbours_warm_up_after_the_stops(fmus):
    runs = {step: run(fmus(None), step, 600.0) for step in (0.25, 0.5, 1.0)}
    hub, caliper, disc = runs[0.25][0].T
    assert hub.argmax() * 0.25 > 60.0 and hub.max() > AIR + 10.0
    # Towards one temperature, that of the air, in the order of the paths.
    assert disc[-1] > hub[-1] > AIR and caliper.max() > AIR + 1.0
    for step in (0.5, 1.0):
        assert runs[step][1] < 1e-8
        ends = runs[step][0][-1] - AIR
        assert ends == pytest.approx(runs[0.25][0][-1] - AIR, rel=0.02)


def test_without_a_path_the_neighbours_stay_cold(fmus):
    rows, residual, _ = run(fmus(None), 1.0, 60.0, **dict.fromkeys(PATHS, 0.0))
    assert np.all(rows[:, :2] == AIR) and residual < 1e-8
