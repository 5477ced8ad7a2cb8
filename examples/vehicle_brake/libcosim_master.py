"""Runs an SSP package with libcosim and writes what it gives. Needs libcosimpy and nothing else of this folder.

    python libcosim_master.py --ssp FILE --steps NUMBER --output FILE component:output ...

Algorithm and step size are those of the package.
"""

import argparse
import array
import json
import sys
import time
from pathlib import Path

from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--ssp", type=Path, required=True)
    parser.add_argument("--steps", type=int, required=True)
    parser.add_argument("--output", type=Path, required=True, help="file for the values after each step, little-endian doubles")
    parser.add_argument("recorded", nargs="+", metavar="component:output")
    return parser.parse_args()


def main():
    options = arguments()
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_ssp_file(ssp_path=str(options.ssp))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)

    groups = {}
    for entry in options.recorded:
        component, output = entry.split(":")
        groups.setdefault(component, []).append(output)
    readers = []
    for component, outputs in groups.items():
        index = execution.slave_index_from_instance_name(component)
        references = {
            variable.name.decode(): variable.reference
            for variable in execution.slave_variables(slave_index=index)
            if variable.type == CosimVariableType.REAL.value
        }
        readers.append((index, [references[output] for output in outputs]))

    rows = array.array("d")

    def record():
        for index, references in readers:
            rows.extend(observer.last_real_values(slave_index=index, variable_references=references))

    seconds = 0.0
    for _ in range(options.steps):
        begin = time.perf_counter()
        done = execution.step()
        seconds += time.perf_counter() - begin
        if not done:
            sys.exit("error: libcosim stopped: " + str(execution.status()))
        record()
    if sys.byteorder != "little":
        rows.byteswap()
    options.output.write_bytes(rows.tobytes())
    print(json.dumps({"seconds": seconds}))


if __name__ == "__main__":
    main()
