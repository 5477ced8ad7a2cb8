"""A brake as it is commonly written by hand, as a co-simulation FMU made with pythonfmu.

One heat capacity for the pad and one for the disc, a fixed split of the friction heat by the effusivities, cooling by still
and moving air and by radiation, friction and wear from the temperature tables of the scene, explicit Euler at the
communication step. No conduction inside the bodies and no flash temperature. The scene's parameters lie as `scene.json`
among the FMU's resources.
"""

import json
import math
from pathlib import Path

from pythonfmu import Fmi2Causality, Fmi2Slave, Real

STEFAN_BOLTZMANN = 5.670374419e-8  # W/(m2 K4)


class LumpedBrake(Fmi2Slave):
    author = "benches/peers"
    description = "Brake with one heat capacity per body"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        value = json.loads((Path(self.resources) / "scene.json").read_text())
        self.sliding_velocity = 0.0
        self.normal_load = 0.0
        self.wear_depth = 0.0
        self.contact_temperature = value["ambient_temperature"]
        self.friction_force = 0.0
        for name in ("sliding_velocity", "normal_load"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("wear_depth", "contact_temperature", "friction_force"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

        self.ambient = value["ambient_temperature"]
        self.faces = value["contact.faces"]
        self.friction = value["contact.friction_coefficient"]
        width, depth = value["punch.width"], value["depth"]
        ring = 2.0 * math.pi * value["contact.mean_radius"]
        self.area = width * depth
        self.coverage = width / ring
        effusivity = [
            math.sqrt(value[f"{body}.conductivity"] * value[f"{body}.density"] * value[f"{body}.specific_heat"])
            for body in ("punch", "strip")
        ]
        # The disc's surface is met by the pad on a part of the ring only, but the heat goes into the whole of it.
        self.disc_share = effusivity[1] / (effusivity[0] + effusivity[1])
        areas = (self.area, ring * depth)
        self.capacity, self.cooling, self.forced, self.radiation, self.wear, self.wear_fade = [], [], [], [], [], []
        for body, area in zip(("punch", "strip"), areas):
            self.capacity.append(
                value[f"{body}.density"] * value[f"{body}.specific_heat"] * value[f"{body}.height"] * area
            )
            cooled = 2.0 * value["punch.height"] * depth + area if body == "punch" else area - self.area
            self.cooling.append(value[f"{body}.convection"] * cooled)
            self.forced.append(value[f"{body}.convection_forced"] * cooled)
            self.radiation.append(value[f"{body}.emissivity"] * STEFAN_BOLTZMANN * cooled)
            self.wear.append(value[f"{body}.wear_coefficient"])
            self.wear_fade.append(table(value, f"{body}.wear_fade"))
        self.friction_fade = table(value, "contact.friction_fade")
        self.temperature = [self.ambient, self.ambient]

    def do_step(self, current_time, step_size):
        speed = abs(self.sliding_velocity)
        load = max(self.normal_load, 0.0)
        mean = 0.5 * (self.temperature[0] + self.temperature[1])
        friction = self.friction * interpolate(self.friction_fade, mean)
        heat = friction * load * speed
        air = speed**0.8
        for body, share in ((0, 1.0 - self.disc_share), (1, self.disc_share)):
            own = self.temperature[body]
            loss = (self.cooling[body] + self.forced[body] * air) * (own - self.ambient)
            loss += self.radiation[body] * (own**4 - self.ambient**4)
            self.temperature[body] = own + step_size * (share * heat - loss) / self.capacity[body]
        path = step_size * load / self.area * speed
        fade = friction / self.friction
        self.wear_depth += path * fade * (
            self.wear[0] * interpolate(self.wear_fade[0], mean)
            + self.coverage * self.wear[1] * interpolate(self.wear_fade[1], mean)
        )
        self.contact_temperature = 0.5 * (self.temperature[0] + self.temperature[1])
        sign = (self.sliding_velocity > 0.0) - (self.sliding_velocity < 0.0)
        self.friction_force = self.faces * friction * load * sign
        return True


def table(value, name):
    return [(value[f"{name}.temperature[{i}]"], value[f"{name}.factor[{i}]"]) for i in range(1, 9)]


def interpolate(rows, temperature):
    """Linear between the rows, constant outside."""
    before = rows[0]
    if temperature <= before[0]:
        return before[1]
    for row in rows[1:]:
        if temperature <= row[0]:
            part = (temperature - before[0]) / (row[0] - before[0])
            return before[1] + part * (row[1] - before[1])
        before = row
    return before[1]
