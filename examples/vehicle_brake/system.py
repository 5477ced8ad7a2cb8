"""The coupled system - a vehicle and four contacts - as data: both masters and the SSP package are made from it."""

from dataclasses import dataclass

VEHICLE = "vehicle"
# Solid discs of the rear axle: smaller pads on a thinner ring than the scene's front brake.
REAR = {"contact.mean_radius": 0.112, "punch.width": 0.075, "depth": 0.040, "strip.height": 0.0055}
# A batch of linings five per cent below the others: one brake is never like the next.
SCATTER = {"contact.friction_coefficient": 0.38}
BRAKES = {
    "front_left": {},
    "front_right": SCATTER,
    "rear_left": REAR,
    "rear_right": REAR,
}


FULL_STOP_TORQUE = 1400.0  # N m, of a front brake: 37 % of 1,500 kg at 8 m/s2 on wheels of 0.31 m
HIGHEST_PRESSURE = 10e6  # Pa: a full stop takes about 4 MPa


@dataclass(frozen=True)
class Connection:
    source: str  # component
    output: str
    target: str
    input: str


def connections():
    """Force decides the speed, speed and load are the contacts' inputs."""
    made = []
    for brake in BRAKES:
        axle = brake.split("_")[0]
        made += [
            Connection(VEHICLE, f"{axle}_sliding_velocity", brake, "sliding_velocity"),
            Connection(VEHICLE, f"{axle}_normal_load", brake, "normal_load"),
            Connection(brake, "friction_force_kinetic", VEHICLE, f"{brake}_kinetic_force"),
            Connection(brake, "friction_force_limit", VEHICLE, f"{brake}_limit_force"),
        ]
    return made


VEHICLE_OUTPUTS = (
    "position",
    "speed",
    "reference_speed",
    "acceleration",
    "grade",
    "drive_force",
    "brake_demand",
    "front_brake_force",
    "rear_brake_force",
    "brake_work",
    "side_difference",
    "front_axle_load",
    "rear_axle_load",
    "front_normal_load",
    "rear_normal_load",
    "is_locked",
)
BRAKE_OUTPUTS = (
    "contact_temperature",
    "contact_temperature_max",
    "strip.mean_temperature",
    "friction_coefficient",
    "friction_force",
    "wear_depth_punch",
    "dissipated_energy",
    "stored_heat",
    "heat_lost_ambient",
    "heat_lost_punch_top",
    "heat_lost_strip_base",
)


def recorded():
    """Pairs (component, output) that a run records."""
    return [(VEHICLE, name) for name in VEHICLE_OUTPUTS] + [
        (brake, name) for brake in BRAKES for name in BRAKE_OUTPUTS
    ]


def parameters(manoeuvre, brake):
    """Parameters by component; `brake`: start values of the contacts' FMU, which the vehicle is matched to."""
    area = float(brake["punch.width"]) * float(brake["depth"])
    lever = float(brake["contact.faces"]) * float(brake["contact.friction_coefficient"]) * float(brake["contact.mean_radius"])
    if not lever > 0.0 or not FULL_STOP_TORQUE / lever / area <= HIGHEST_PRESSURE:
        raise ValueError(
            f"this scene is no front brake of a mid-size car: {FULL_STOP_TORQUE:g} N.m take more than the "
            f"{HIGHEST_PRESSURE / 1e6:g} MPa that pads are pressed with, on {area * 1e4:.3g} cm2 at a mean radius of "
            f"{float(brake['contact.mean_radius']):.3g} m"
        )
    vehicle = {
        "front_mean_radius": float(brake["contact.mean_radius"]),
        "rear_mean_radius": REAR["contact.mean_radius"],
        "brake_faces": float(brake["contact.faces"]),
        "brake_friction": float(brake["contact.friction_coefficient"]),
        **manoeuvre.parameters,
    }
    return {VEHICLE: vehicle, **{name: dict(values) for name, values in BRAKES.items()}}
