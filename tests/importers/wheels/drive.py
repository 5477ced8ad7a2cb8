"""Drives the FMU with one importer. Runs in the environment of that importer, in which numpy may be missing.

    python drive.py IMPORTER FMU STEP INPUTS OUTPUTS NAME ...

INPUTS is a JSON list of [sliding_velocity, normal_load], one for every step; OUTPUTS gets a JSON list of the values of
the named variables after every step. Inputs are set before a step and held over it.
"""

import ctypes
import json
import sys
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

INPUTS = ("sliding_velocity", "normal_load")


def description(fmu):
    """GUID, and value references by name."""
    with zipfile.ZipFile(fmu) as archive:
        root = xml.fromstring(archive.read("modelDescription.xml"))
    references = {variable.get("name"): int(variable.get("valueReference")) for variable in root.iter("ScalarVariable")}
    return root.get("guid"), references


def fmuloader(fmu, step, inputs, names):
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

    guid, references = description(fmu)
    slave = Fmi2Slave(fmu, model_identifier="SlidingContact")
    slave.instantiate("contact", Fmi2Type.CO_SIMULATION, guid=guid)
    slave.setup_experiment(start_time=0.0)
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    for index, row in enumerate(inputs):
        slave.set_real([references[name] for name in INPUTS], row)
        slave.do_step(index * step, step)
        yield list(slave.get_real([references[name] for name in names]))
    slave.terminate()
    slave.free_instance()


def libcosimpy(fmu, step, inputs, names):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    _, references = description(fmu)
    execution = CosimExecution.from_step_size(step_size=round(step * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="contact"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    manipulator = CosimManipulator.create_override()
    execution.add_manipulator(manipulator=manipulator)
    for row in inputs:
        manipulator.slave_real_values(slave, [references[name] for name in INPUTS], row)
        if not execution.step():
            raise RuntimeError(f"libcosim stopped: {execution.status()}")
        yield list(observer.last_real_values(slave, [references[name] for name in names]))


def ecospy(fmu, step, inputs, names):
    # The wheel leaves this library to the system; the one of the package tbb serves once it is loaded.
    ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("contact", fmu)
        with EcosSimulation(structure=structure, step_size=step) as simulation:
            simulation.init()
            for row in inputs:
                for name, value in zip(INPUTS, row):
                    simulation.set_real(f"contact::{name}", value)
                simulation.step()
                yield [simulation.get_real(f"contact::{name}") for name in names]
            simulation.terminate()


def pathsim_fmi(fmu, step, inputs, names):
    from pathsim import Connection, Simulation
    from pathsim.blocks import Source
    from pathsim_fmi import CoSimulationFMU
    from pathsim_fmi.wrapper import FMUWrapper

    rows = []
    build = FMUWrapper._build_variable_maps

    def build_of_names(self):
        """It reads every output as a Real, which this FMU, as the standard demands, refuses for the other types."""
        build(self)
        references = {v.name: v.valueReference for v in self.model_description.modelVariables}
        self.output_refs = {name: references[name] for name in names}

    FMUWrapper._build_variable_maps = build_of_names

    class Recorded(CoSimulationFMU):
        """Notes the outputs after every step."""

        def _step_fmu(self, time):
            super()._step_fmu(time)
            values = dict(zip(self.fmu_wrapper.output_refs, self.fmu_wrapper.get_outputs_as_array()))
            rows.append([float(values[name]) for name in names])

    contact = Recorded(fmu, dt=step)

    def held(column):
        return lambda time: inputs[min(round(time / step), len(inputs) - 1)][column]

    sources = [Source(held(column)) for column in range(len(INPUTS))]
    connections = [Connection(source[0], contact[name]) for source, name in zip(sources, INPUTS)]
    simulation = Simulation([*sources, contact], connections, dt=step, log=False)
    # The last step begins at the end of the run.
    simulation.run(step * (len(inputs) - 1), adaptive=False)
    return rows


def gemseo_fmu(fmu, step, inputs, names):
    from gemseo_fmu.disciplines.fmu_discipline import FMUDiscipline
    from numpy import array

    contact = FMUDiscipline(
        fmu,
        input_names=INPUTS,
        output_names=names,
        initial_time=0.0,
        final_time=step * len(inputs),
        time_step=step,
        restart=False,
        do_step=True,
    )
    for row in inputs:
        data = contact.execute({name: array([value]) for name, value in zip(INPUTS, row)})
        yield [float(data[name][0]) for name in names]


IMPORTERS = {
    "ecospy": ecospy,
    "fmuloader": fmuloader,
    "gemseo-fmu": gemseo_fmu,
    "libcosimpy": libcosimpy,
    "pathsim-fmi": pathsim_fmi,
}


def main():
    importer, fmu, step, inputs, outputs, *names = sys.argv[1:]
    rows = list(IMPORTERS[importer](fmu, float(step), json.loads(Path(inputs).read_text()), names))
    Path(outputs).write_text(json.dumps(rows))


if __name__ == "__main__":
    main()
