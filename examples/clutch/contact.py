"""The clutch's contact FMU by the names of its variables, with what an implicit master needs: roll-back and derivative."""

import shutil
from ctypes import byref

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave


class Unpacked:
    """An FMU on disk, unpacked; use as a context manager."""

    def __init__(self, path):
        self.description = read_model_description(str(path), validate=True)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.folder = extract(str(path))

    def start(self, name):
        return float(self.variables[name].start)

    def level(self):
        """Level of the scene: auto, lumped or line."""
        variable = self.variables["solver.fidelity"]
        return {item.value: item.name for item in variable.declaredType.items}[str(variable.start)]

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        shutil.rmtree(self.folder, ignore_errors=True)


class Contact:
    """One initialised instance; use as a context manager."""

    def __init__(self, unpacked, parameters, slip, load):
        self.unpacked = unpacked
        self.time = 0.0
        self.steps = 0  # calls of fmi2DoStep
        self.state = None
        self.fmu = FMU2Slave(
            guid=unpacked.description.guid,
            unzipDirectory=unpacked.folder,
            modelIdentifier=unpacked.description.coSimulation.modelIdentifier,
            instanceName="clutch",
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        self.inputs = self.references("angular_velocity", "normal_load")
        self.torque_reference = self.references("friction_torque")
        for kind, store in (("Real", self.fmu.setReal), ("Integer", self.fmu.setInteger)):
            own = {name: value for name, value in parameters.items() if unpacked.variables[name].type == kind}
            store(self.references(*own), list(own.values()))
        self.set(slip, load)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        if self.state is not None:
            self.fmu.freeFMUstate(self.state)
        self.fmu.terminate()
        self.fmu.freeInstance()

    def references(self, *names):
        return [self.unpacked.variables[name].valueReference for name in names]

    def set(self, slip, load):
        """Slip [rad/s] and clamping force [N]."""
        self.fmu.setReal(self.inputs, [slip, load])

    def get(self, *names):
        """Values of outputs (one: the value itself)."""
        values = self.fmu.getReal(self.references(*names))
        return values[0] if len(values) == 1 else values

    def torque(self):
        """Friction torque [N m]."""
        return self.fmu.getReal(self.torque_reference)[0]

    def torque_slope(self):
        """Derivative of the torque by the slip [N m s/rad], states held."""
        return self.fmu.getDirectionalDerivative(self.torque_reference, self.inputs[:1], [1.0])[0]

    def step(self, size):
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=size)
        self.time += size
        self.steps += 1

    def save(self):
        """Keeps the present state for `restore`."""
        if self.state is None:
            self.state = self.fmu.getFMUstate()
        else:
            self.fmu.fmi2GetFMUstate(self.fmu.component, byref(self.state))
        self.saved_time = self.time

    def restore(self):
        self.fmu.setFMUstate(self.state)
        self.time = self.saved_time
