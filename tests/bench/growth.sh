#!/bin/bash
# How the cost of a run grows with triangles, with layers and with raster lines, each over a
# factor of 16 with all else as it is. Prints a Markdown table: the exponent between two lines
# is 1 where the cost grows in proportion, 2 where it grows with the square.
#
#   cargo build --release
#   tests/bench/growth.sh
#
# The part is a bumpy ball of 60 mm, written here; one thread. The cost is processor time, the
# least of ROUNDS=5 runs; what a run costs whatever the part is (the pictures in the file's
# head, settings) is in it.
# SLICER is our program, if not target/release/slicer.
# Needs GNU time (apt-get install time) and python3.
set -euo pipefail
export LC_ALL=C

bench=$(cd "$(dirname "$0")" && pwd)
slicer=${SLICER:-${CARGO_TARGET_DIR:-$bench/../../target}/release/slicer}
rounds=${ROUNDS:-5}

die() {
    echo "growth.sh: $1" >&2
    exit 2
}
[ -x "$slicer" ] || die "$slicer is missing; run cargo build --release"
/usr/bin/time -f %e true 2>/dev/null || die "GNU time is missing; apt-get install time"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# ball RINGS FILE: a closed ball of 4 · RINGS² triangles, with bumps that are the same for all.
ball() {
    python3 - "$@" <<'PYTHON'
import math, struct, sys
rings, name = int(sys.argv[1]), sys.argv[2]
around = 2 * rings
def place(i, j):
    up, turn = math.pi * i / rings, 2 * math.pi * (j % around) / around
    r = 30 * (1 + 0.05 * math.sin(6 * turn) * math.sin(up) ** 2 * math.cos(4 * up))
    if i in (0, rings):
        turn = 0
    flat = r * math.sin(up) if i not in (0, rings) else 0.0
    return (flat * math.cos(turn), flat * math.sin(turn), r * math.cos(up))
grid = [[place(i, j) for j in range(around)] for i in range(rings + 1)]
triangles = []
for i in range(rings):
    for j in range(around):
        a, b = grid[i][j], grid[i + 1][j]
        c, d = grid[i + 1][(j + 1) % around], grid[i][(j + 1) % around]
        if i + 1 < rings:
            triangles.append((a, b, c))
        if i > 0:
            triangles.append((a, c, d))
with open(name, "wb") as out:
    out.write(bytes(80) + struct.pack("<I", len(triangles)))
    for t in triangles:
        out.write(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0))
PYTHON
}

# cost ARGUMENT...: processor time in ms and peak memory in KiB.
cost() {
    for ((round = 0; round < rounds; round++)); do
        # Unlike GNU time, the shell tells thousandths.
        TIMEFORMAT='%3U %3S'
        { time "$slicer" -q "$@" -p generic-marlin -p "$bench/plain.toml" --walls 1 --threads 1 -o "$work/out" 2>"$work/log"; } \
            2>&1 | awk '{ print 1000 * ($1 + $2) }'
    done | sort -n | head -n 1
    /usr/bin/time -q -f %M -o "$work/kib" "$slicer" -q "$@" -p generic-marlin -p "$bench/plain.toml" --walls 1 \
        --threads 1 -o "$work/out" 2>"$work/log" || die "$(cat "$work/log")"
    cat "$work/kib"
}

# sweep NAME: reads lines "N ARGUMENT..." and prints their table.
sweep() {
    printf '\n| %s | cpu ms | peak MiB | exponent |\n|--:|--:|--:|--:|\n' "$1"
    local before=
    while read -r n arguments; do
        # shellcheck disable=SC2086 # arguments are words
        mapfile -t found < <(cost $arguments)
        # shellcheck disable=SC2086 # three numbers or none
        awk -v n="$n" -v ms="${found[0]}" -v kib="${found[1]}" -v before="$before" 'BEGIN {
            split(before, was, " ")
            exponent = before == "" ? "" : sprintf("%.2f", log(ms / was[2]) / log(n / was[1]))
            printf "| %d | %.0f | %.1f | %s |\n", n, ms, kib / 1024, exponent
        }'
        before="$n ${found[0]}"
    done
}

for rings in 128 181 256 362 512; do ball $rings "$work/$rings.stl"; done
for rings in 128 181 256 362 512; do
    echo "$((4 * rings * (rings - 1))) $work/$rings.stl"
done | sweep triangles
for height in 0.32 0.16 0.08 0.04 0.02; do
    awk -v h=$height 'BEGIN { printf "%d", 60 / h }'
    echo " $work/256.stl --layer-height $height --first-layer-height $height"
done | sweep layers
for width in 1.6 0.8 0.4 0.2 0.1; do
    awk -v w=$width 'BEGIN { printf "%d", 60 / w }'
    echo " $work/256.stl --line-width $width --infill 100 --layer-height 0.08 --first-layer-height 0.08"
done | sweep "lines across"
