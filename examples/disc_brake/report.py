"""Figures of a run: what happened, whether energy is conserved, how fast it went."""

import csv
import math
from dataclasses import asdict, dataclass

import numpy as np

ZERO_CELSIUS = 273.15


@dataclass(frozen=True)
class Summary:
    """Results of a run; every name carries its unit."""

    duration_s: float
    distance_km: float
    ambient_temperature_degC: float
    contact_temperature_peak_degC: float
    contact_temperature_final_degC: float
    disc_temperature_peak_degC: float
    disc_temperature_final_degC: float
    friction_torque_peak_N_m: float
    pad_wear_um: float
    disc_wear_um: float
    stops: int
    brake_applications: int
    worn_mass_mg: float
    airborne_mass_mg: float
    energy_in_kJ: float
    heat_stored_kJ: float
    heat_lost_kJ: float
    heat_share_disc: float
    energy_balance_error: float
    flow_integral_error: float
    steps: int
    steps_per_second: float
    real_time_factor: float

    def as_dictionary(self):
        return asdict(self)

    def over_drive(self, mass):
        """A mass [mg] over the distance that the car drives, over its stops and over the times that the driver brakes."""
        distance = f", {mass / self.distance_km:.3g} mg/km" if self.distance_km > 0.0 else ""
        counts = ((self.stops, "stop"), (self.brake_applications, "brake application"))
        return distance + "".join(f", {mass / count:.3g} mg a {name}" for count, name in counts if count)

    def rows(self):
        """Quantities compared between levels, and the statistics of the run, as pairs of texts."""
        return (
            ("Driven", f"{self.duration_s:.0f} s, {self.distance_km:.2f} km"),
            ("Contact temperature", f"peak {self.contact_temperature_peak_degC:.1f} degC, "
             f"final {self.contact_temperature_final_degC:.1f} degC"),
            ("Disc temperature (mean)", f"peak {self.disc_temperature_peak_degC:.1f} degC, "
             f"final {self.disc_temperature_final_degC:.1f} degC"),
            ("Friction torque", f"peak {self.friction_torque_peak_N_m:.1f} N m"),
            ("Wear of the pad", f"{self.pad_wear_um:.4g} µm"),
            ("Wear of the disc", f"{self.disc_wear_um:.4g} µm per face"),
            ("Worn mass", f"{self.worn_mass_mg:.4g} mg{self.over_drive(self.worn_mass_mg)}"),
            ("Of it airborne", f"{self.airborne_mass_mg:.4g} mg{self.over_drive(self.airborne_mass_mg)}"),
            ("Energy in", f"{self.energy_in_kJ:.2f} kJ, {100 * self.heat_share_disc:.1f} % of it into the disc"),
            ("Energy out", f"{self.heat_stored_kJ:.2f} kJ stored, {self.heat_lost_kJ:.2f} kJ lost"),
            ("Energy balance error", f"{self.energy_balance_error:.1e} of the energy in"),
            ("Pace", f"{self.steps} steps, {self.steps_per_second:.0f} steps/s, "
             f"{self.real_time_factor:.0f} times real time"),
        )


def table(columns):
    """One screen of text: a column for every level [heading to summary]."""
    names = [name for name, _ in next(iter(columns.values())).rows()]
    cells = [["", *names]]
    cells += [[heading, *(value for _, value in summary.rows())] for heading, summary in columns.items()]
    widths = [max(map(len, column)) for column in cells]
    lines = ("  ".join(f"{cell:{width}}" for cell, width in zip(line, widths)) for line in zip(*cells))
    return "\n".join(f"  {line}".rstrip() for line in lines)


def differences(summary, finer):
    """Quantities that differ by more than a per cent between two levels: name to relative difference of `summary`, of
    temperatures to their rise above the start."""
    one, other = summary.as_dictionary(), finer.as_dictionary()
    found = {}
    for name in ("contact_temperature_peak_degC", "disc_temperature_peak_degC", "friction_torque_peak_N_m",
                 "pad_wear_um", "disc_wear_um", "energy_in_kJ"):
        start = finer.ambient_temperature_degC if name.endswith("degC") else 0.0
        difference = one[name] / other[name] - 1.0 if start == 0.0 else (one[name] - other[name]) / (other[name] - start)
        if abs(difference) > 0.01:
            found[name] = difference
    return found


def of_trips(recording, drive, trips):
    """Temperatures, masses and distance of the trips (number, start, end) of a drive, one dictionary each."""
    time, found = recording["time"], []
    travelled = np.concatenate(([0.0], np.cumsum(0.5 * (drive.speed[1:] + drive.speed[:-1]) * np.diff(drive.time)))) / 1e3
    worn = recording["wear_mass_punch"] + recording["wear_mass_strip"]
    for number, start, end in trips:
        within = (time >= start) & (time <= end)
        over = {name: float(np.interp(end, time, mass) - np.interp(start, time, mass)) * 1e6
                for name, mass in (("worn", worn), ("airborne", recording["wear_mass_airborne"]))}
        found.append({
            "trip": number,
            "distance_km": float(np.interp(end, drive.time, travelled) - np.interp(start, drive.time, travelled)),
            "contact_temperature_peak_degC": float(recording["contact_temperature_max"][within].max()) - ZERO_CELSIUS,
            "disc_temperature_start_degC": float(np.interp(start, time, recording["strip.mean_temperature"])) - ZERO_CELSIUS,
            "disc_temperature_peak_degC": float(recording["strip.mean_temperature"][within].max()) - ZERO_CELSIUS,
            "stops": stops(drive.speed[(drive.time >= start) & (drive.time <= end)]),
            "brake_applications": brake_applications(drive, start, end),
            "worn_mass_mg": over["worn"],
            "airborne_mass_mg": over["airborne"],
        })
    return found


def trips_table(trips):
    """One line of text for every trip."""
    lines = ["  trip      km  stops  brakings  contact, peak  disc, start and peak, degC  worn, mg/km  of it airborne"]
    for trip in trips:
        distance = trip["distance_km"] if trip["distance_km"] > 0.0 else math.nan
        lines.append(f"  {trip['trip']:4} {trip['distance_km']:7.2f} {trip['stops']:6} {trip['brake_applications']:9} "
                     f"{trip['contact_temperature_peak_degC']:14.1f} "
                     f"{trip['disc_temperature_start_degC']:16.1f} {trip['disc_temperature_peak_degC']:10.1f} "
                     f"{trip['worn_mass_mg'] / distance:12.3g} {trip['airborne_mass_mg'] / distance:15.3g}")
    return "\n".join(lines)


# Part of a temperature's rise by which half the cells may differ where the line counts as converged.
CONVERGED = 0.01


def comparison(columns):
    """Sentences about the columns: the level of the scene, the line, the line on half the cells."""
    (level, summary), *lines = columns.items()
    if not lines:
        return []
    (heading, fine), (half, coarse) = lines
    name = "contact_temperature_peak_degC"
    peak, other = fine.as_dictionary()[name], coarse.as_dictionary()[name]
    away = abs(peak - other)
    decimals = min(max(0, -math.floor(math.log10(away))), 4) if away > 0.0 else 4
    converged = away <= CONVERGED * (peak - fine.ambient_temperature_degC)
    sentences = [f"{heading}: peak {peak:.{decimals}f} degC, {half}: {other:.{decimals}f} degC{'' if converged else ', not converged'}"]
    doubts = differences(coarse, fine)
    for name, difference in differences(summary, fine).items():
        doubt = doubts.get(name, 0.0)
        aside = f", not converged: {half} by {100 * doubt:+.0f} %" if abs(doubt) > 0.5 * abs(difference) else ""
        sentences.append(f"{level} differs from {heading} in {name} by {100 * difference:+.0f} %{aside}")
    return sentences


def stored_minus_lost(recording):
    """Energy not accounted for [J]: heat made, less heat stored, less what left through each boundary."""
    return (
        recording["dissipated_energy"]
        - recording["stored_heat"]
        - recording["heat_lost_ambient"]
        - recording["heat_lost_punch_top"]
        - recording["heat_lost_strip_base"]
    )


def flow_integral_error(recording):
    """Largest distance between the FMU's integrals of the heat flows and the trapezoid sums of the recorded flows,
    relative to the energy in. The sums are of second order in the step, so this is no zero: it shows that the integrals
    are those of the flows that one can plot."""
    time = recording["time"]
    worst = 0.0
    for name in ("ambient", "punch_top", "strip_base"):
        flow = recording[f"heat_flow_{name}"]
        total = np.sum(0.5 * (flow[1:] + flow[:-1]) * np.diff(time))
        worst = max(worst, abs(total - recording[f"heat_lost_{name}"][-1]))
    return float(worst / recording["dissipated_energy"][-1])


def stops(speed):
    """How often a car of this speed comes to rest."""
    rests = np.asarray(speed) == 0.0
    return int(np.sum(~rests[:-1] & rests[1:]))


def brake_applications(drive, start, end):
    """How often the driver of a moving car begins to brake between two times, as the 303 events of the WLTP brake cycle are counted:
    from released pads to released pads, a stop and the holding after it included."""
    pressed = drive.normal_load > 0.0
    begins = np.flatnonzero(pressed & ~np.insert(pressed[:-1], 0, False))
    moving = [bool(np.any(pressed[first:last] & (drive.speed[first:last] > 0.0)))
              for first, last in zip(begins, [*begins[1:], pressed.size])]
    return sum(int(moved and start <= drive.time[first] < end) for first, moved in zip(begins, moving))


def summarise(recording, drive):
    """The summary of a recording of `drive`."""
    time = recording["time"]
    energy = float(recording["dissipated_energy"][-1])
    if not energy > 0.0:
        raise ValueError(f"no heat was made: the energy in is {energy} J")
    lost = sum(float(recording[f"heat_lost_{name}"][-1]) for name in ("ambient", "punch_top", "strip_base"))
    strip = np.sum(0.5 * (recording["heat_flow_strip"][1:] + recording["heat_flow_strip"][:-1]) * np.diff(time))
    duration = float(time[-1] - time[0])
    celsius = {
        name: recording[name] - ZERO_CELSIUS for name in ("contact_temperature_max", "strip.mean_temperature")
    }
    return Summary(
        duration_s=duration,
        distance_km=float(np.trapezoid(drive.speed, drive.time)) / 1e3,
        ambient_temperature_degC=float(celsius["strip.mean_temperature"][0]),
        contact_temperature_peak_degC=float(celsius["contact_temperature_max"].max()),
        contact_temperature_final_degC=float(celsius["contact_temperature_max"][-1]),
        disc_temperature_peak_degC=float(celsius["strip.mean_temperature"].max()),
        disc_temperature_final_degC=float(celsius["strip.mean_temperature"][-1]),
        friction_torque_peak_N_m=float(np.abs(recording["friction_torque"]).max()),
        pad_wear_um=float(recording["wear_depth_punch"][-1]) * 1e6,
        disc_wear_um=float(recording["wear_depth_strip"][-1]) * 1e6,
        stops=stops(drive.speed),
        brake_applications=brake_applications(drive, 0.0, duration),
        worn_mass_mg=1e6 * float(recording["wear_mass_punch"][-1] + recording["wear_mass_strip"][-1]),
        airborne_mass_mg=1e6 * float(recording["wear_mass_airborne"][-1]),
        energy_in_kJ=energy / 1e3,
        heat_stored_kJ=float(recording["stored_heat"][-1]) / 1e3,
        heat_lost_kJ=lost / 1e3,
        heat_share_disc=float(strip) / energy,
        energy_balance_error=float(np.abs(stored_minus_lost(recording)).max()) / energy,
        flow_integral_error=flow_integral_error(recording),
        steps=recording.steps,
        steps_per_second=recording.steps / recording.seconds,
        real_time_factor=duration / recording.seconds,
    )


def write_csv(path, recording, drive):
    """Every recorded value with its unit in the heading; the car's speed beside them. Seventeen digits: what is read
    back is what the FMU gave. A row holds the inputs of the step that ends at its time."""
    names = recording.table.dtype.names
    speed = np.interp(recording["time"], drive.time, drive.speed)
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["time [s]", "car.speed [m/s]", *(f"{name} [{recording.units[name]}]" for name in names[1:])]
        )
        for row, at in zip(recording.table.tolist(), speed):
            writer.writerow([repr(row[0]), repr(float(at)), *map(repr, row[1:])])
