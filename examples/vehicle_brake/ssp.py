"""Writes the coupled system as an SSP 1.0 package (System Structure and Parameterization).

Any tool that reads SSP can run it. Tools of the Open Simulation Platform find step size and algorithm in an annotation;
no worker threads: the steps are so short that handing them to threads would take longer than they do.
"""

import io
import zipfile
from xml.sax.saxutils import quoteattr

import vehicle_fmu
from system import BRAKES, VEHICLE

NAMESPACES = (
    'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"'
    ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"'
    ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
    ' xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations"'
)


def parameter_set(name, values):
    """SSP parameter set of Real values."""
    rows = "".join(
        f'\n    <ssv:Parameter name={quoteattr(key)}><ssv:Real value="{float(value)!r}"/></ssv:Parameter>'
        for key, value in values.items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
        f" version=\"1.0\" name={quoteattr(name)}>\n  <ssv:Parameters>{rows}\n  </ssv:Parameters>\n</ssv:ParameterSet>\n"
    )


def connector(name, kind):
    return f'\n          <ssd:Connector name={quoteattr(name)} kind="{kind}"><ssc:Real/></ssd:Connector>'


def structure(connections, parameters, manoeuvre, step):
    """Text of SystemStructure.ssd."""
    elements = []
    for component in (VEHICLE, *BRAKES):
        source = "Vehicle.fmu" if component == VEHICLE else "Brake.fmu"
        outputs = dict.fromkeys(c.output for c in connections if c.source == component)
        inputs = dict.fromkeys(c.input for c in connections if c.target == component)
        connectors = "".join(connector(name, "output") for name in outputs)
        connectors += "".join(connector(name, "input") for name in inputs)
        binding = ""
        if parameters.get(component):
            binding = (
                "\n        <ssd:ParameterBindings><ssd:ParameterBinding"
                f' source="resources/{component}.ssv"/></ssd:ParameterBindings>'
            )
        elements.append(
            f'\n      <ssd:Component name="{component}" type="application/x-fmu-sharedlibrary"'
            f' source="resources/{source}">'
            f"\n        <ssd:Connectors>{connectors}\n        </ssd:Connectors>{binding}\n      </ssd:Component>"
        )
    wires = "".join(
        f'\n      <ssd:Connection startElement="{c.source}" startConnector={quoteattr(c.output)}'
        f' endElement="{c.target}" endConnector={quoteattr(c.input)}/>'
        for c in connections
    )
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription {NAMESPACES} version="1.0" name="vehicle_brake">
  <ssd:System name={quoteattr(manoeuvre.name)} description="A car and its four brakes">
    <ssd:Elements>{"".join(elements)}
    </ssd:Elements>
    <ssd:Connections>{wires}
    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment startTime="0.0" stopTime="{manoeuvre.duration!r}">
    <ssd:Annotations>
      <ssc:Annotation type="com.opensimulationplatform">
        <osp:Algorithm><osp:FixedStepAlgorithm baseStepSize="{step!r}" numWorkerThreads="0"/></osp:Algorithm>
      </ssc:Annotation>
    </ssd:Annotations>
  </ssd:DefaultExperiment>
</ssd:SystemStructureDescription>
"""


def pack(path, brake, connections, parameters, manoeuvre, step):
    """Writes the package: structure, both FMUs, one parameter set for each component that has any."""
    vehicle = io.BytesIO()
    vehicle_fmu.pack(vehicle, manoeuvre)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("SystemStructure.ssd", structure(connections, parameters, manoeuvre, step))
        archive.writestr("resources/Vehicle.fmu", vehicle.getvalue())
        archive.write(brake, "resources/Brake.fmu")
        for component, values in parameters.items():
            if values:
                archive.writestr(f"resources/{component}.ssv", parameter_set(component, values))
    return path
