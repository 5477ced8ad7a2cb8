"""The descent of examples/ventilated_disc beside two lumped masses that share no code with the package."""

import sys

import numpy as np
import pytest

from conftest import ROOT
from sliding_contact import Scene

FOLDER = ROOT / "examples" / "ventilated_disc"
pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


@pytest.fixture(scope="module")
def descents():
    sys.path.insert(0, str(FOLDER))
    try:
        import descent

        return {name: descent.descend(Scene.load(scene)) for name, scene in descent.SCENES.items()}
    finally:
        sys.path.remove(str(FOLDER))


def two_masses(height, convection, forced, emissivity, channel, conductance, share):
    """Highest temperatures of disc and hub, degC: m c dT/dt = P - A h (T - T_a) - A eps sigma (T^4 - T_a^4) - G (T - T_h), and the hub's."""
    integrate = pytest.importorskip("scipy.integrate")
    speed, ambient, ring, pad = 40.0 / 3.6, 293.15, 2.0 * np.pi * 0.1175 * 0.055, 0.095 * 0.055
    power = 0.35 * speed * (1500.0 * 9.80665 * (0.10 - 0.012) - 0.5 * 1.2 * 0.66 * speed**2)
    mass = 2.0 * ring * height * 7200.0
    # Of grey cast iron over the temperature, J/(kg K): 0.967 iron and 0.033 graphite of NIST.
    points, heats = np.linspace(300.0, 900.0, 7), [459.0, 507.0, 554.0, 601.0, 649.0, 709.0, 801.0]
    area = 2.0 * (ring - pad) + (2.0 * ring if channel else 0.0)
    film = convection + forced * (speed * 0.1175 / 0.31) ** 0.8

    def rates(_, state):
        disc, hub = state
        lost = area * (film * (disc - ambient) + emissivity * 5.670374e-8 * (disc**4 - ambient**4))
        path = conductance * (disc - hub)
        capacity = mass * np.interp(disc, points, heats)
        return [(power * share - lost - path) / capacity, (path - 2.0 * (hub - ambient)) / 2000.0]

    end = integrate.solve_ivp(rates, (0.0, 10e3 / speed), [ambient, ambient], rtol=1e-8, max_step=5.0)
    return end.y[:, -1] - 273.15


def test_both_discs_reach_the_temperatures_of_two_lumped_masses(descents):
    for name, given in (("solid", (0.011, 10.0, 8.0, 0.55, False, 0.0)), ("ventilated", (0.0097, 13.2, 10.6, 0.36, True, 3.5))):
        own = descents[name]
        share = float(own.result["heat_received_strip"].max() / own.result["dissipated_energy"][-1])
        disc, hub = two_masses(*given, share)
        assert own.result["strip.mean_temperature [degC]"].max() == pytest.approx(disc, rel=0.02), name
        foot = int(np.searchsorted(own.time, 900.0))
        assert own.hub[foot] - 273.15 == pytest.approx(hub, rel=0.03), name


def test_what_flows_to_the_hub_is_stored_in_it_or_lost(descents):
    own = descents["ventilated"]
    lost = np.interp(own.time, own.result.time, own.result["heat_lost_strip_external"])
    rise = own.hub - own.hub[0]
    away = 2.0 * np.concatenate([[0.0], np.cumsum(np.diff(own.time) * 0.5 * (rise[1:] + rise[:-1]))])
    assert np.allclose(2000.0 * rise + away, lost, atol=2e-3 * lost[-1])


def test_a_cooling_curve_gives_the_convection(descents):
    pytest.importorskip("scipy")
    result, time = descents["ventilated"].result, descents["ventilated"].time
    record = {f"{name} [{unit}]": np.interp(time, result.time, result[name]) for name, unit in (("sliding_velocity", "m/s"), ("normal_load", "N"))}
    record = {"time [s]": time, **record, "strip.external_temperature [K]": descents["ventilated"].hub}
    disc = np.interp(time, result.time, result["strip.mean_temperature [degC]"]) + np.random.default_rng(2).normal(0.0, 2.0, time.size)
    record["strip.mean_temperature [degC]"] = np.where(time > 900.0, disc, np.nan)
    scene = Scene.load(FOLDER / "ventilated.toml")
    found = scene.copy().set({"strip.convection_forced": 5.0}).fit(record, ["strip.convection_forced", "strip.convection"])
    assert found.names == ("strip.convection_forced",) and "changes the records as strip.convection_forced" in found.undetermined["strip.convection"]
    low, high = found.intervals[:, 0]
    assert low < scene["strip.convection_forced"] < high < 1.05 * low
