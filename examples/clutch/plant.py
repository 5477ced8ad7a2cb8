"""Engine and vehicle on either side of the clutch, and the step limit of an explicit master.

    J_e dw_e/dt = T_e - T,     J_v dw_v/dt = T - T_r,     slip w = w_e - w_v

T: torque of the clutch; T_r: of the vehicle's resistance. Everything is referred to the transmission's input shaft. For
the slip alone 1/J = 1/J_e + 1/J_v. At the mean radius r_m of the contact that is a mass m = J/r_m^2 which slides at
r_m w, and where the friction force rises by `friction_slope` per speed, explicit Euler multiplies a disturbance by
1 - h friction_slope/m in each step: it dies out for h < 2 m/friction_slope and grows beyond.
"""

from dataclasses import dataclass

RADIANS_PER_SECOND = 3.141592653589793 / 30.0  # of 1 rev/min


@dataclass(frozen=True)
class Plant:
    engine_inertia: float = 0.15  # kg m2, with flywheel
    # 1,500 kg on wheels of 0.31 m behind a first gear and final drive of 13:1.
    vehicle_inertia: float = 1500.0 * 0.31**2 / 13.0**2  # kg m2
    engine_torque: float = 100.0  # N m
    # 1.2 % of the weight.
    resistance: float = 0.012 * 1500.0 * 9.80665 * 0.31 / 13.0  # N m

    @property
    def slip_inertia(self):
        return 1.0 / (1.0 / self.engine_inertia + 1.0 / self.vehicle_inertia)

    @property
    def drive(self):
        """Rate of the slip without clutch torque [rad/s2]."""
        return self.engine_torque / self.engine_inertia + self.resistance / self.vehicle_inertia

    @property
    def stuck_torque(self):
        """Torque that keeps both sides together [N m]."""
        return self.slip_inertia * self.drive

    def explicit_limit(self, friction_slope, mean_radius):
        """Longest stable step of explicit Euler [s]: 2 m/friction_slope."""
        return 2.0 * self.slip_inertia / (mean_radius**2 * friction_slope)
