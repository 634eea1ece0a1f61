#!/bin/bash
# Instructions that whole runs take, against those kept in counts.tsv: a change that costs
# more than 2 % is seen whatever else the machine does.
#
#   cargo build --release
#   tests/bench/counts.sh             compares; exits 1 if a run takes over 2 % more
#   tests/bench/counts.sh --update    writes counts.tsv anew
#
# One thread, an environment of its own and no output file, since these count too. Figures
# depend on the compiler and the system's library: counts.tsv names the compiler, and another
# one is told. SLICER is our program, if not target/release/slicer.
# Needs valgrind (apt-get install valgrind).
set -euo pipefail
export LC_ALL=C

bench=$(cd "$(dirname "$0")" && pwd)
root=$bench/../..
kept=$bench/counts.tsv
slicer=$(realpath "${SLICER:-${CARGO_TARGET_DIR:-$root/target}/release/slicer}")

die() {
    echo "counts.sh: $1" >&2
    exit 2
}
command -v valgrind >/dev/null || die "valgrind is missing; apt-get install valgrind"
[ -x "$slicer" ] || die "$slicer is missing; run cargo build --release"
compiler=$(rustc --version)
cd "$root"

# The runs: model, then arguments.
runs=(
    "fixtures/bracket.stl --walls 1"
    "fixtures/sphere_20.stl --scale 3 --dual"
    "fixtures/overhang.stl --scale 2 --walls 3 --support"
)

# count MODEL ARGUMENT...: prints how many instructions it takes.
count() {
    env -i valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        "$slicer" -q "$@" -p generic-marlin -p "$bench/plain.toml" --threads 1 -o /dev/null 2>&1 |
        awk '/refs:/ { gsub(",", "", $NF); print $NF }' | grep . || die "cannot count: $*"
}

if [ "${1:-}" = --update ]; then
    {
        echo "# $compiler"
        for run in "${runs[@]}"; do
            # shellcheck disable=SC2086 # a run is words
            found=$(count $run)
            printf '%s\t%s\n' "$run" "$found"
        done
    } >"$kept.new"
    mv "$kept.new" "$kept"
    cat "$kept"
    exit
fi

was=$(head -n 1 "$kept")
[ "$was" = "# $compiler" ] || echo "counts.tsv is by ${was#\# }, this is $compiler" >&2
worse=0
while IFS=$'\t' read -r run before; do
    # shellcheck disable=SC2086 # a run is words
    now=$(count $run)
    awk -v run="$run" -v before="$before" -v now="$now" 'BEGIN {
        change = 100 * (now - before) / before
        verdict = change > 2 ? "too many" : change < -2 ? "fewer: run with --update" : "as before"
        printf "%-44s %12d %+6.2f %%  %s\n", run, now, change, verdict
        exit change > 2
    }' || worse=1
done < <(grep -v '^#' "$kept")
exit $worse
