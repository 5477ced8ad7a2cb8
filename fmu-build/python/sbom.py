"""Software bill of materials of a library in CycloneDX JSON, validated against the standard's schema.

Reads JSON from the standard input: `root`, `components` (name, version, licence, SHA-256 of the package or null), `depends`
(pairs of name@version) and `time` (seconds since 1970). Writes the bill to the standard output.
"""

import datetime
import json
import sys
import uuid

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model import HashAlgorithm, HashType
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output.json import JsonV1Dot5
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from packageurl import PackageURL


def component(given, kind):
    """Component of a package of cargo; one without a hash belongs to this project."""
    name, version = given["name"], given["version"]
    hashes = [HashType(alg=HashAlgorithm.SHA_256, content=given["sha256"])] if given["sha256"] else []
    return Component(
        name=name,
        version=version,
        type=kind,
        bom_ref=f"{name}@{version}",
        purl=PackageURL("cargo", None, name, version),
        licenses=[LicenseFactory().make_from_string(given["licence"].replace("/", " OR "))],
        hashes=hashes,
    )


def main():
    text = sys.stdin.read()
    given = json.loads(text)
    bom = Bom(serial_number=uuid.uuid5(uuid.NAMESPACE_OID, text))
    bom.metadata.timestamp = datetime.datetime.fromtimestamp(given["time"], datetime.timezone.utc)
    root = component(given["root"], ComponentType.LIBRARY)
    bom.metadata.component = root
    known = {str(root.bom_ref): root}
    for each in given["components"]:
        entry = component(each, ComponentType.LIBRARY)
        known[str(entry.bom_ref)] = entry
        bom.components.add(entry)
    needs = {}
    for user, used in given["depends"]:
        needs.setdefault(user, []).append(known[used])
    for reference, entry in known.items():
        bom.register_dependency(entry, needs.get(reference, []))
    written = JsonV1Dot5(bom).output_as_string(indent=2)
    wrong = JsonStrictValidator(SchemaVersion.V1_5).validate_str(written)
    if wrong is not None:
        sys.exit(f"the bill of materials does not fit the schema: {wrong}")
    print(written)


if __name__ == "__main__":
    main()
