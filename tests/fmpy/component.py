"""An FMU by the names of its variables: a thin layer over fmpy's FMU2Slave that keeps status and log of every call."""

import shutil
from ctypes import byref
from dataclasses import dataclass, field

import numpy as np
from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.logging import addLoggerProxy

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


AUTO = 1


def status_of(call, *arguments):
    """Status of a call of fmpy, which raises where it is worse than a warning."""
    try:
        return call(*arguments) or OK
    except FMICallException as error:
        return error.status


@dataclass(frozen=True)
class Message:
    status: int
    category: str
    text: str


@dataclass(frozen=True)
class Fmu:
    """An unpacked FMU."""

    path: str
    folder: str
    description: object
    variables: dict = field(repr=False)

    @classmethod
    def unpack(cls, path):
        description = read_model_description(str(path), validate=True)
        variables = {variable.name: variable for variable in description.modelVariables}
        return cls(str(path), extract(str(path)), description, variables)

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, name):
        """Start value of a Real or Integer."""
        return float(self.variables[name].start)

    def item(self, name, item):
        """Value of an enumeration's item."""
        items = self.variables[name].declaredType.items
        return next(int(entry.value) for entry in items if entry.name == item)

LOGGERS = []


class Component:
    """One instance. Use as a context manager."""

    def __init__(self, fmu, logging=True, guid=None, name="test"):
        self.fmu = fmu
        self.time = 0.0
        self.messages = []
        # fmpy's own wrapper keeps no reference to what it hands to the library, so the instance does.
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        # The library passes a format and its arguments; this proxy of fmpy's formats them into one text.
        addLoggerProxy(byref(self.callbacks))
        # fmpy keeps one logger for all proxies, the last one, and calls it for instances of other callbacks too: it has to outlive them.
        LOGGERS.append(self.callbacks)
        self.slave = FMU2Slave(
            guid=guid or fmu.description.guid,
            unzipDirectory=fmu.folder,
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate(callbacks=self.callbacks, loggingOn=logging)

    def _log(self, _environment, _name, status, category, text):
        self.messages.append(Message(status, category.decode(), text.decode()))

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        self.slave.freeInstance()

    def log(self):
        return "\n".join(message.text for message in self.messages)

    def _setter(self, name):
        kind = self.fmu.variables[name].type
        return getattr(self.slave, "set" + ("Integer" if kind == "Enumeration" else kind))

    def try_set(self, name, value):
        """Sets one variable and returns the status."""
        return status_of(self._setter(name), [self.fmu.variables[name].valueReference], [value])

    def set(self, values=(), **named):
        """Sets variables; a failure raises. Enumeration items may be given by name."""
        for name, value in {**dict(values), **named}.items():
            if isinstance(value, str):
                value = self.fmu.item(name, value)
            self._setter(name)([self.fmu.variables[name].valueReference], [value])

    def get(self, *names):
        """Values of Real variables (one: the value itself)."""
        values = self.slave.getReal([self.fmu.variables[name].valueReference for name in names])
        return values[0] if len(names) == 1 else np.array(values)

    def outputs(self):
        """All Real outputs and scalar locals, in the order of the description."""
        names = [v.name for v in self.fmu.description.modelVariables if v.causality in ("output", "local") and v.type == "Real" and "[" not in v.name]
        return dict(zip(names, self.get(*names)))

    def initialise(self, values=(), start=0.0, stop=None, tolerance=None, **named):
        """Set-up and initialisation with these parameters and inputs; lumped, unless they or the scene name a level."""
        self.slave.setupExperiment(tolerance=tolerance, startTime=start, stopTime=stop)
        if "solver.fidelity" not in dict(values) | named and self.slave.getInteger([self.fmu.variables["solver.fidelity"].valueReference])[0] == AUTO:
            self.set({"solver.fidelity": "lumped"})
        self.set(values, **named)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.time = start
        return self

    def step(self, size):
        """One step; a failure raises."""
        self.slave.doStep(currentCommunicationPoint=self.time, communicationStepSize=size)
        self.time += size

    def try_step(self, size, at=None):
        """One step that may fail; returns the status. Time advances only on success."""
        at = self.time if at is None else at
        status = status_of(self.slave.doStep, at, size)
        if status == OK:
            self.time = at + size
        return status

    def run(self, inputs, step, names):
        """Steps over rows of inputs `(sliding_velocity, normal_load)` held over each step; rows of `names` after it."""
        rows = np.empty((len(inputs), len(names)))
        own = [self.fmu.variables[name].valueReference for name in ("sliding_velocity", "normal_load")]
        read = [self.fmu.variables[name].valueReference for name in names]
        for row, pair in zip(rows, inputs):
            self.slave.setReal(own, pair)
            self.step(step)
            row[:] = self.slave.getReal(read)
        return rows

    def set_input_derivative(self, name, value):
        reference = self.fmu.variables[name].valueReference
        self.slave.setRealInputDerivatives([reference], [1], [value])
