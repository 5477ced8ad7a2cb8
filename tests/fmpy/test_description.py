"""The XML against the standard: schema, rules that no schema can state, fmpy's own validation."""

import re
import zipfile
from pathlib import Path

import fmpy
import pytest
from conftest import SCENES, file_of
from fmpy.validation import validate_fmu
from lxml import etree

ALL = (None, *SCENES)

# Table of section 2.2.7 of FMI 2.0.4: which initial a causality and variability may have, the default first.
INITIAL = {
    ("parameter", "fixed"): ("exact",),
    ("parameter", "tunable"): ("exact",),
    ("calculatedParameter", "fixed"): ("calculated", "approx"),
    ("calculatedParameter", "tunable"): ("calculated", "approx"),
    ("input", "discrete"): (None,),
    ("input", "continuous"): (None,),
    ("output", "constant"): ("exact",),
    ("output", "discrete"): ("calculated", "exact", "approx"),
    ("output", "continuous"): ("calculated", "exact", "approx"),
    ("local", "constant"): ("exact",),
    ("local", "fixed"): ("calculated", "approx"),
    ("local", "tunable"): ("calculated", "approx"),
    ("local", "discrete"): ("calculated", "exact", "approx"),
    ("local", "continuous"): ("calculated", "exact", "approx"),
    ("independent", "continuous"): (None,),
}


def document(scene):
    with zipfile.ZipFile(file_of(scene)) as archive:
        return etree.fromstring(archive.read("modelDescription.xml"))


def variables(root):
    return list(root.find("ModelVariables"))


def typed(variable):
    """The element Real, Integer, Boolean or Enumeration."""
    return next(child for child in variable if child.tag != "Annotations")


@pytest.mark.parametrize("scene", ALL)
def test_fmpy_finds_no_problem(scene):
    assert validate_fmu(str(file_of(scene))) == []


@pytest.mark.parametrize("scene", ALL)
def test_the_schema_of_the_standard_accepts_it(scene):
    path = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
    schema = etree.XMLSchema(etree.parse(str(path)))
    root = document(scene)
    assert schema.validate(root), schema.error_log


@pytest.mark.parametrize("scene", ALL)
def test_attributes_of_every_variable_are_legal(scene):
    root = document(scene)
    units = {unit.get("name"): [display.get("name") for display in unit.findall("DisplayUnit")]
             for unit in root.iterfind("UnitDefinitions/Unit")}
    types = {kind.get("name"): kind for kind in root.iterfind("TypeDefinitions/SimpleType")}
    names, references = set(), set()
    for variable in variables(root):
        name, attributes = variable.get("name"), typed(variable).attrib
        assert name not in names
        names.add(name)
        reference = variable.get("valueReference")
        assert reference not in references, f"{name}: a reference stands for one variable"
        references.add(reference)
        assert variable.get("description"), name

        causality = variable.get("causality", "local")
        variability = variable.get("variability", "continuous")
        assert (causality, variability) in INITIAL, name
        allowed = INITIAL[causality, variability]
        initial = variable.get("initial", allowed[0])
        assert initial in allowed, name
        # A start is required where the value is exact or approximate and on inputs, and forbidden where calculated.
        assert ("start" in attributes) == (initial != "calculated"), name

        if typed(variable).tag == "Real":
            assert attributes["unit"] in units, name
            assert attributes.get("displayUnit") in (None, *units[attributes["unit"]]), name
            assert float(attributes["nominal"]) > 0.0, name
        if typed(variable).tag == "Enumeration":
            assert types[attributes["declaredType"]].find("Enumeration") is not None, name
        if "start" in attributes and typed(variable).tag in ("Real", "Integer"):
            start = float(attributes["start"])
            assert float(attributes.get("min", "-inf")) <= start <= float(attributes.get("max", "inf")), name
        if causality == "output":
            assert "min" not in attributes and "max" not in attributes, name


@pytest.mark.parametrize("scene", ALL)
def test_model_structure_lists_what_it_must(scene):
    root = document(scene)
    listed = variables(root)
    causality = [variable.get("causality", "local") for variable in listed]
    inputs = {index for index, kind in enumerate(causality, 1) if kind == "input"}

    def unknowns(path):
        return root.findall(f"ModelStructure/{path}/Unknown")

    outputs = [int(unknown.get("index")) for unknown in unknowns("Outputs")]
    assert outputs == [index for index, kind in enumerate(causality, 1) if kind == "output"]
    # Outputs whose initial is calculated or approx; locals of a co-simulation slave are no states and not listed.
    initial = [int(unknown.get("index")) for unknown in unknowns("InitialUnknowns")]
    assert initial == sorted(initial) and set(initial) == set(outputs)
    for unknown in unknowns("Outputs"):
        text = unknown.get("dependencies")
        assert text is not None, "without the attribute every output would depend on everything"
        dependencies = [int(word) for word in text.split()]
        assert dependencies == sorted(dependencies) and set(dependencies) <= inputs
        kinds = (unknown.get("dependenciesKind") or "").split()
        assert len(kinds) in (0, len(dependencies))

    def inputs_of(name):
        index = next(i for i, variable in enumerate(listed, 1) if variable.get("name") == name)
        text = next(unknown for unknown in unknowns("Outputs") if int(unknown.get("index")) == index)
        return {listed[int(word) - 1].get("name") for word in text.get("dependencies").split()}

    assert {"sliding_velocity", "normal_load"} <= inputs_of("friction_force")
    for name in ("wear_depth", "strip.mean_temperature", "remaining_life"):
        assert inputs_of(name) == set(), name


@pytest.mark.parametrize("scene", ALL)
def test_the_archive_holds_what_an_importer_and_a_person_need(scene):
    with zipfile.ZipFile(file_of(scene)) as archive:
        names = archive.namelist()
        assert archive.testzip() is None
        assert all(not name.startswith("/") and ".." not in name for name in names)
        for needed in (
            "modelDescription.xml",
            "model.png",
            "binaries/linux64/SlidingContact.so",
            "documentation/index.html",
            "terminalsAndIcons/terminalsAndIcons.xml",
        ):
            assert needed in names
        assert any(name.startswith("extra/") for name in names)
        assert any(re.search(r"licen[cs]e", name, re.IGNORECASE) for name in names)
        page = archive.read("documentation/index.html").decode()
        for variable in variables(document(scene)):
            assert re.sub(r"\[\d+\]$", "", variable.get("name")) in page
        pictures = re.findall(r'<img src="([^"]+)"', page)
        assert len(pictures) >= 3
        for picture in pictures:
            assert len(archive.read(f"documentation/{picture}")) > 5_000


def test_scenes_differ_in_guid_and_share_the_identifier():
    roots = [document(scene) for scene in ALL]
    assert len({root.get("guid") for root in roots}) == len(ALL)
    assert {root.find("CoSimulation").get("modelIdentifier") for root in roots} == {"SlidingContact"}
    for scene, root in zip(SCENES, roots[1:]):
        assert root.get("modelName") == f"SlidingContact.{scene}"
