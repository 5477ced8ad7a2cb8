"""The cases by name, with the change of the model that its bands must not survive. Sources are in README.md."""

from growth import disc_critical_speed, hot_bands, hot_spot_growth
from heat import (
    car_disc,
    clutch_engagement,
    flash_temperature,
    moving_source,
    pin_flash_temperature,
    railway_disc,
    repeated_stops,
    ring_disc,
    single_stop,
)
from results import Case
from wear import (
    ball_wear,
    block_on_ring,
    brake_emissions,
    flat_punch_wear,
    fretting,
    reciprocating,
    sliding_punch,
    uniform_wear,
    wear_dissipation,
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
