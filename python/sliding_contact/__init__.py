"""Wear and heat of two bodies in sliding contact: scenes, simulation along inputs, steady states, cycles, choice of the level.

Three lines to a figure of a stop, with a pad of 80 mm:

>>> from sliding_contact import Scene
>>> stop = {"time [s]": [0, 0.3, 4], "sliding_velocity [km/h]": [36, 36, 0], "normal_load [kN]": [0, 8, 8]}
>>> figure = Scene.load("disc_brake").set({"punch.width": "80 mm"}).simulate(stop).plot()

Values are in SI units unless a name says another one: `result["contact_temperature [degC]"]`.
"""

from __future__ import annotations

from ._batch import Batch
from ._errors import Error, Interrupted, SceneNote, SceneWarning
from .results import Cycles, Deviation, LevelComparison, Plan, Profiles, Simulation, SteadyState, StepFailed, Stroke
from .scene import Scene, fmu, scenes

__version__ = "0.1.0"
__all__ = [
    "Batch",
    "Cycles",
    "Deviation",
    "Error",
    "Interrupted",
    "LevelComparison",
    "Plan",
    "Profiles",
    "Scene",
    "SceneNote",
    "SceneWarning",
    "Simulation",
    "SteadyState",
    "StepFailed",
    "Stroke",
    "fmu",
    "scenes",
]
