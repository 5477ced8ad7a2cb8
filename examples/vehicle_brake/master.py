"""A co-simulation master on fmpy's FMU2Slave: all components step in parallel, then outputs are exchanged (Jacobi).

Inputs are held over a step, which is an error of first order in the step. `extrapolate` also hands on how they changed
over the last step (fmi2SetRealInputDerivatives) to components that can use it, which makes it one of second order.
"""

import shutil
import sys
import time
from dataclasses import dataclass

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

NANOSECONDS = 1_000_000_000


@dataclass(frozen=True)
class Recording:
    """Rows at every communication point, the start included."""

    time: np.ndarray  # s
    columns: dict  # (component, output) to array
    units: dict  # (component, output) to unit
    seconds: float  # wall time of the stepping
    master: str

    def __getitem__(self, key):
        return self.columns[key]

    @property
    def steps(self):
        return len(self.time) - 1


class Unpacked:
    """Unpacked FMUs, each file once."""

    def __init__(self):
        self.kept = {}

    def __call__(self, path):
        path = str(path)
        if path not in self.kept:
            self.kept[path] = (extract(path), read_model_description(path, validate=True))
        return self.kept[path]

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        for folder, _ in self.kept.values():
            shutil.rmtree(folder, ignore_errors=True)


class Slave:
    """An instance by the names of its variables."""

    def __init__(self, name, unpacked):
        folder, description = unpacked
        self.name = name
        self.extrapolates = bool(description.coSimulation.canInterpolateInputs)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate()

    def references(self, names):
        missing = [name for name in names if name not in self.variables]
        if missing:
            raise KeyError(f"{self.name} has no {', '.join(missing)}")
        return [self.variables[name].valueReference for name in names]

    def set(self, values):
        if values:
            self.fmu.setReal(self.references(values), list(values.values()))


class Wiring:
    """Connections sorted so that each component is read and written by one call."""

    def __init__(self, slaves, connections):
        self.slaves = slaves
        sources, targets = {}, {}
        for connection in connections:
            sources.setdefault(connection.source, []).append(connection.output)
            targets.setdefault(connection.target, []).append((connection.input, connection.source, connection.output))
        self.read, place, count = [], {}, 0
        for name, outputs in sources.items():
            outputs = list(dict.fromkeys(outputs))
            self.read.append((slaves[name].fmu, slaves[name].references(outputs)))
            for output in outputs:
                place[name, output] = count
                count += 1
        self.write = [
            (
                slaves[name],
                slaves[name].references([entry[0] for entry in entries]),
                [place[entry[1], entry[2]] for entry in entries],
            )
            for name, entries in targets.items()
        ]
        self.values = None

    def hand_on(self, step=None):
        """Sets every input to what it is connected to. `step` [s], the last one: sets their derivatives too."""
        values = []
        for fmu, references in self.read:
            values += fmu.getReal(references)
        for slave, references, places in self.write:
            slave.fmu.setReal(references, [values[place] for place in places])
            if step is not None and slave.extrapolates:
                # What has come to zero stays there: wheels that have stopped do not turn backwards.
                rates = [(values[at] - self.values[at]) / step if values[at] != 0.0 else 0.0 for at in places]
                slave.fmu.setRealInputDerivatives(references, [1] * len(places), rates)
        self.values = values


class Progress:
    """A bar on the error stream, silent where that is no terminal."""

    def __init__(self, name, stop):
        self.name, self.stop, self.shown = name, stop, 0.0
        self.is_active = sys.stderr.isatty()

    def __call__(self, now):
        if self.is_active and time.monotonic() - self.shown > 0.1:
            self.shown = time.monotonic()
            print(f"\r  {self.name:12} [{'#' * int(30 * now / self.stop):30}]", end="", file=sys.stderr)

    def close(self):
        if self.is_active:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def run(files, connections, parameters, recorded, duration, step, name="", extrapolate=False):
    """Runs the components (`files`: name to path of an FMU) from 0 to `duration` [s] in steps of `step` [s]."""
    ticks = round(step * NANOSECONDS)
    count = round(duration * NANOSECONDS / ticks)
    with Unpacked() as unpacked:
        slaves = {}
        try:
            for component, path in files.items():
                slaves[component] = Slave(component, unpacked(path))
            for component, slave in slaves.items():
                slave.fmu.setupExperiment(startTime=0.0)
                slave.set(parameters.get(component, {}))
            wiring = Wiring(slaves, connections)
            for slave in slaves.values():
                slave.fmu.enterInitializationMode()
            # As often as there are components: what the first gives has then reached the last.
            for _ in slaves:
                wiring.hand_on()
            for slave in slaves.values():
                slave.fmu.exitInitializationMode()
            wiring.hand_on()

            groups = {}
            for component, output in recorded:
                groups.setdefault(component, []).append(output)
            readers = [(slaves[component].fmu, slaves[component].references(names)) for component, names in groups.items()]
            keys = [(component, output) for component, names in groups.items() for output in names]
            table = np.empty((count + 1, len(keys)))

            def record(row):
                table[row] = [value for fmu, references in readers for value in fmu.getReal(references)]

            progress = Progress(name, count)
            stepping = [slave.fmu for slave in slaves.values()]
            record(0)
            begin = time.perf_counter()
            for index in range(count):
                # Communication points from whole nanoseconds: no drift, and the same points as other masters have.
                now, then = index * ticks / NANOSECONDS, (index + 1) * ticks / NANOSECONDS
                for fmu in stepping:
                    fmu.doStep(currentCommunicationPoint=now, communicationStepSize=then - now)
                # Recorded is what the components gave for the inputs of the step that ends here.
                record(index + 1)
                wiring.hand_on(then - now if extrapolate else None)
                progress(index)
            seconds = time.perf_counter() - begin
            progress.close()
            units = {(c, o): slaves[c].variables[o].unit or "1" for c, o in keys}
            for slave in slaves.values():
                slave.fmu.terminate()
        finally:
            for slave in slaves.values():
                slave.fmu.freeInstance()
    time_points = np.arange(count + 1) * ticks / NANOSECONDS
    return Recording(time_points, {key: table[:, index] for index, key in enumerate(keys)}, units, seconds, "fmpy")
