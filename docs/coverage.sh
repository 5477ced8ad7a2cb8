#!/bin/sh
# Line coverage of the library's crates by their own tests; docs/coverage.md describes it. Needs the LLVM tools of the compiler
# (rustup component add llvm-tools). Everything is written to target/coverage, which may be deleted afterwards.
set -eu
cd "$(dirname "$0")/.."
folder="$PWD/target/coverage"
rm -rf "$folder"
mkdir -p "$folder/profiles"
tools="$(dirname "$(rustc --print target-libdir)")/bin"

# Only the workspace's own crates are instrumented.
cat > "$folder/rustc" <<'WRAPPER'
#!/bin/sh
compiler="$1"
shift
exec "$compiler" "$@" -C instrument-coverage
WRAPPER
chmod +x "$folder/rustc"
export RUSTC_WORKSPACE_WRAPPER="$folder/rustc" CARGO_INCREMENTAL=0 LLVM_PROFILE_FILE="$folder/profiles/%2m.profraw"

set --
for crate in numerics scene elasticity conduction contact model steady; do
    set -- "$@" -p "sliding-contact-$crate"
done
status=0
cargo test --locked --release --no-fail-fast --target-dir "$folder" "$@" -p sliding-contact --lib --tests || status=$?

"$tools/llvm-profdata" merge -sparse "$folder"/profiles/*.profraw -o "$folder/all.profdata"
set --
for program in $(find "$folder/release/deps" -maxdepth 1 -type f -perm -u+x ! -name '*.so'); do
    set -- "$@" --object "$program"
done
"$tools/llvm-cov" export -summary-only -instr-profile "$folder/all.profdata" "$@" \
    --ignore-filename-regex '/registry/|/rustc/|/tests/|/tests\.rs$|/crates/(exact|verification|test-support|scene-file)/' \
    > "$folder/summary.json"
python3 - "$folder/summary.json" "$PWD/" <<'REPORT'
import collections
import json
import sys

files = json.load(open(sys.argv[1]))["data"][0]["files"]
crates = collections.defaultdict(lambda: [0, 0])
for file in files:
    path = file["filename"].removeprefix(sys.argv[2]).split("/")
    name = path[1] if path[0] == "crates" else "sliding-contact"
    for key in (name, "all"):
        crates[key][0] += file["summary"]["lines"]["covered"]
        crates[key][1] += file["summary"]["lines"]["count"]
print(f"{'crate':<18}{'lines':>8}{'covered':>9}{'%':>8}")
for name, (covered, count) in sorted(crates.items(), key=lambda item: (item[0] == "all", item[0])):
    print(f"{name:<18}{count:>8}{covered:>9}{100 * covered / count:>8.1f}")
print("files with most lines that are not covered:")
lines = [(file["summary"]["lines"], file["filename"].removeprefix(sys.argv[2])) for file in files]
for line, name in sorted(lines, key=lambda item: item[0]["covered"] - item[0]["count"])[:20]:
    print(f"{line['count'] - line['covered']:>6} of {line['count']:<6} {name}")
REPORT
exit "$status"
