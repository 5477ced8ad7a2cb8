"""Lines and covered lines of every crate from a file of llvm-cov (lcov), without the test modules that end a source file.

Called by docs/coverage.sh. With a second argument also prints the uncovered lines of every file whose path contains it.
"""

import collections
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def end_of_library(path: pathlib.Path) -> int:
    """Number of lines before the test module of a source file."""
    lines = path.read_text().splitlines()
    for number, line in enumerate(lines[:-1]):
        if line == "#[cfg(test)]" and lines[number + 1].startswith("mod ") and lines[number + 1].endswith("{"):
            return number
    return len(lines)


def files(lcov: str):
    """Path and covered (True) or uncovered lines of every file."""
    path, lines = None, {}
    for record in open(lcov):
        key, _, value = record.strip().partition(":")
        if key == "SF":
            path, lines = pathlib.Path(value).relative_to(ROOT), {}
        elif key == "DA":
            number, count = value.split(",")[:2]
            lines[int(number)] = int(count) > 0
        elif key == "end_of_record":
            end = end_of_library(ROOT / path)
            yield path, {number: covered for number, covered in lines.items() if number <= end}


def main() -> None:
    crates = collections.defaultdict(lambda: [0, 0])
    misses = []
    for path, lines in files(sys.argv[1]):
        name = path.parts[1] if path.parts[0] == "crates" else "sliding-contact"
        missing = [number for number, covered in sorted(lines.items()) if not covered]
        misses.append((len(missing), len(lines), path))
        for key in (name, "all"):
            crates[key][0] += len(lines)
            crates[key][1] += len(lines) - len(missing)
        if len(sys.argv) > 2 and sys.argv[2] in str(path) and missing:
            print(f"{path}: {' '.join(map(str, missing))}")
    print(f"{'crate':<18}{'lines':>8}{'covered':>9}{'%':>8}")
    for name, (count, covered) in sorted(crates.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"{name:<18}{count:>8}{covered:>9}{100 * covered / count:>8.1f}")
    print("files with most lines that are not covered:")
    for missing, count, path in sorted(misses, reverse=True)[:20]:
        print(f"{missing:>6} of {count:<6} {path}")


main()
