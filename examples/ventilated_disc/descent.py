"""A car on an Alpine descent at constant speed, braked by a solid and by a ventilated front disc: temperatures, fade, wear.

    python descent.py --output results

Needs the Python package with matplotlib. The road gives the friction work and the driver presses as friction fades, so the load follows from the
friction coefficient of the run before; so does the temperature of the hub, behind the hat, from the heat that flows to it. A few runs agree.
"""

import argparse
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from sliding_contact import Scene, Simulation

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "disc_brake"))
from road_load import AIR_DENSITY, GRAVITY, Car  # noqa: E402

SPEED = 40.0 / 3.6  # m/s
GRADE = 0.10
LENGTH = 10e3  # m
LEVEL = 600.0  # s behind the foot, at the same speed without braking: the discs cool
POINTS = 200  # rows of the inputs over the descent
AMBIENT = 293.15  # K
SCENES = {"solid": "disc_brake", "ventilated": HERE / "ventilated.toml"}
MOST = 20  # runs


@dataclass(frozen=True)
class Hub:
    """What is behind the hat: hub, bearing and wheel."""

    capacity: float = 2000.0  # J/K, 4 kg of steel
    loss: float = 2.0  # W/K to the air: 0.1 m2 at 20 W/(m2.K)


@dataclass(frozen=True)
class Descent:
    """One brake down the mountain."""

    result: Simulation
    time: np.ndarray  # s, rows of the inputs
    hub: np.ndarray  # K, at them
    runs: int


def brake_force(car: Car) -> float:
    """Force of all brakes that holds the speed, N."""
    drag = 0.5 * AIR_DENSITY * car.drag_area * SPEED**2
    return car.mass * GRAVITY * (GRADE - car.rolling_resistance) - drag


def warmed(time, lost, hub):
    """Temperature of the hub over the time, K: C dT/dt = dQ/dt - G (T - T_ambient), exact for a uniform flow in each interval."""
    decay = np.exp(-np.diff(time) * hub.loss / hub.capacity)
    rise = [0.0]
    for part, flow in zip(decay, np.diff(lost) / np.diff(time)):
        rise.append(rise[-1] * part + flow / hub.loss * (1.0 - part))
    return AMBIENT + np.array(rise)


def descend(scene: Scene, car: Car = Car(), hub: Hub = Hub()) -> Descent:
    """The descent of a car, to 0.1 % of the load and 0.1 K of the hub."""
    duration = LENGTH / SPEED
    time = np.concatenate([np.linspace(0.0, duration, POINTS + 1), duration + np.linspace(0.01, LEVEL, POINTS // 2)])
    ratio = scene["contact.mean_radius"] / car.wheel_radius
    force = 0.5 * car.front_share * brake_force(car) / ratio / scene["contact.faces"]  # N, friction of each pad
    friction = np.full(time.size, scene["contact.friction_coefficient"])
    behind = np.full(time.size, AMBIENT)
    for runs in range(1, MOST + 1):
        load = np.where(time <= duration, force / friction, 0.0)
        inputs = {"time [s]": time, "sliding_velocity [m/s]": SPEED * ratio, "normal_load [N]": load}
        if scene["strip.external_conductance"] > 0.0:
            inputs["strip.external_temperature [K]"] = behind
        result = scene.simulate(inputs)
        at = {name: np.interp(time, result.time, result[name]) for name in ("friction_coefficient", "heat_lost_strip_external")}
        change = np.max(np.abs(at["friction_coefficient"] / friction - 1.0)[time <= duration])
        before, behind, friction = behind, warmed(time, at["heat_lost_strip_external"], hub), at["friction_coefficient"]
        if change < 1e-3 and np.max(np.abs(behind - before)) < 0.1:
            return Descent(result, time, before, runs)
    raise RuntimeError(f"load and hub of {scene.name} do not settle in {MOST} runs")


def table(descents):
    """Highest temperatures, least friction, highest load, wear."""
    lines = [f"{'':12}{'disc, mean':>12}{'hottest':>12}{'hub':>10}{'friction':>10}{'pressure':>10}{'pad wear':>11}{'after 600 s':>13}"]
    for name, own in descents.items():
        result = own.result
        disc, hottest = result["strip.mean_temperature [degC]"], result["contact_temperature_max [degC]"]
        lines.append(
            f"{name:12}{disc.max():9.0f} °C{hottest.max():9.0f} °C{own.hub.max() - 273.15:7.0f} °C{result['friction_coefficient'].min():10.3f}"
            f"{1e-6 * result['pressure_mean'].max():6.2f} MPa{1e6 * result['wear_depth_punch'][-1]:8.0f} µm{disc[-1]:10.0f} °C"
        )
    return "\n".join(lines)


def draw(descents, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with plt.rc_context({"font.size": 8, "svg.fonttype": "none", "svg.hashsalt": "sliding contact", "axes.spines.top": False, "axes.spines.right": False}):
        figure, (temperature, friction) = plt.subplots(1, 2, figsize=(7.1, 2.8), layout="constrained")
        for (name, own), colour in zip(descents.items(), ("#0072B2", "#D55E00")):
            minutes = own.result.time / 60.0
            temperature.plot(minutes, own.result["strip.mean_temperature [degC]"], color=colour, label=f"{name} disc")
            if np.ptp(own.hub) > 0.0:
                temperature.plot(own.time / 60.0, own.hub - 273.15, color=colour, linestyle="--", label=f"hub behind the {name} disc")
            braking = own.result.time <= LENGTH / SPEED
            friction.plot(minutes[braking], own.result["friction_coefficient"][braking], color=colour, label=f"{name} disc")
        temperature.set_ylabel("mean temperature (°C)")
        friction.set_ylabel("friction coefficient")
        for axis in (temperature, friction):
            axis.set_xlabel("time (min)")
            axis.set_xlim(left=0.0)
            axis.set_ylim(bottom=0.0)
            axis.grid(color="#dddddd", linewidth=0.5)
            axis.legend(frameon=False, fontsize=7, loc="lower left", bbox_to_anchor=(0.0, 1.0))
        figure.savefig(path, metadata={"Date": None, "Creator": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--output", type=Path, help="folder for descent.svg")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    descents = {name: descend(Scene.load(scene)) for name, scene in SCENES.items()}
    print(table(descents))
    if options.output:
        options.output.mkdir(parents=True, exist_ok=True)
        draw(descents, options.output / "descent.svg")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
