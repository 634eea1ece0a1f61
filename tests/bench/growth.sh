#!/bin/bash
# How the cost of a run grows with triangles, with layers, with raster lines and with islands, and
# with what would take the square of itself if it were done without care. Prints Markdown tables:
# the exponent between two lines is 1 where the cost grows in proportion, 2 where it grows with the
# square.
#
#   cargo build --release
#   tests/bench/growth.sh             all
#   tests/bench/growth.sh hard        only the hard ones: islands, holes, broken meshes, profiles
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

# hard KIND N FILE: a model with N of something that is easily compared with all others.
hard() {
    python3 - "$@" <<'PYTHON'
import math, struct, sys
kind, n, name = sys.argv[1], int(sys.argv[2]), sys.argv[3]
def box(x, y, z, wide, deep, high, inward=False):
    corners = [(x + i * wide, y + j * deep, z + k * high)
               for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return [[corners[v] for v in (face[::-1] if inward else face)] for face in faces]
def field(pitch):
    side = math.ceil(math.sqrt(n))
    return side, [(k % side * pitch, k // side * pitch) for k in range(n)]
def pillars():
    return [t for x, y in field(4)[1] for t in box(x, y, 0, 2, 2, 3)]
def holes():
    side = field(4)[0]
    quad = lambda a, b, c, d: [[a, b, c], [a, c, d]]
    out = []
    for x, y in [(4 * i, 4 * j) for j in range(side) for i in range(side)]:
        rim = [(x + i, y + j) for i, j in ((0, 0), (4, 0), (4, 4), (0, 4))]
        hole = [(x + i, y + j) for i, j in ((1, 1), (3, 1), (3, 3), (1, 3))]
        for k in range(4):
            a, b, c, d = rim[k], rim[(k + 1) % 4], hole[(k + 1) % 4], hole[k]
            out += quad((*a, 2), (*b, 2), (*c, 2), (*d, 2)) + quad((*d, 0), (*c, 0), (*b, 0), (*a, 0))
            out += quad((*d, 2), (*c, 2), (*c, 0), (*d, 0))
            beyond = (y == 0, x == 4 * side - 4, y == 4 * side - 4, x == 0)[k]
            out += quad((*a, 0), (*b, 0), (*b, 2), (*a, 2)) if beyond else []
    return out
def edge():
    turn = lambda k: 2 * math.pi * k / n
    tip = lambda k: (10 * math.cos(turn(k)), 10 * math.sin(turn(k)), 5)
    return [[(0, 0, 0), (0, 0, 10), tip(k)] for k in range(n)]
def shells():
    out = []
    for k in range(n):
        half, in_by = 1 + k * 0.04, (n - k) * 0.004
        out += box(-half, -half, in_by, 2 * half, 2 * half, 10 - 2 * in_by, (n - k) % 2 == 0)
    return out
def tetrahedra():
    corners, out = [(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)], []
    for k in range(n):
        by = [2 * (k * part % 1) for part in (0.6180339887, 0.7548776662, 0.5698402910)]
        at = [[c + b for c, b in zip(corner, by)] for corner in corners]
        out += [[at[v] for v in face] for face in [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]]
    return out
def sheets():
    lines = [(k * 1.0, k) for k in range(n)]
    return [t for at, _ in lines for t in box(at, 0, 0, 0.5, n, 5) + box(0, at, 0, n, 0.5, 5)]
def spiral():
    # 20 turns of a wall without top and bottom.
    def at(k, out):
        turn = 40 * math.pi * k / n
        radius = 2 + 0.75 * turn / math.pi + out
        return radius * math.cos(turn), radius * math.sin(turn)
    out = []
    for k in range(n):
        for a, b in ((at(k, 0), at(k + 1, 0)), (at(k + 1, 0.6), at(k, 0.6))):
            a0, a3, b0, b3 = (*a, 0), (*a, 3), (*b, 0), (*b, 3)
            out += [[a0, a3, b3], [a0, b3, b0]]
    return out
triangles = globals()[kind]()
with open(name, "wb") as out:
    out.write(bytes(80) + struct.pack("<I", len(triangles)))
    for t in triangles:
        out.write(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0))
PYTHON
}

# hard_sweep NAME KIND "N..." ARGUMENT...: the table of a kind.
hard_sweep() {
    local name=$1 kind=$2 counts=$3
    shift 3
    for n in $counts; do
        hard "$kind" "$n" "$work/$kind.$n.stl"
        echo "$n $work/$kind.$n.stl --layer-height 0.2 $*"
    done | sweep "$name"
    rm -f "$work/$kind".*.stl
}

# cost ARGUMENT...: processor time in ms and peak memory in KiB. A model that is refused has a cost, too.
cost() {
    for ((round = 0; round < rounds; round++)); do
        # Unlike GNU time, the shell tells thousandths.
        TIMEFORMAT='%3U %3S'
        { time "$slicer" -q "$@" -p generic-marlin -p "$bench/plain.toml" --walls 1 --threads 1 -o "$work/out" 2>"$work/log" || true; } \
            2>&1 | awk '{ print 1000 * ($1 + $2) }'
    done | sort -n | head -n 1
    /usr/bin/time -q -f %M -o "$work/kib" "$slicer" -q "$@" -p generic-marlin -p "$bench/plain.toml" --walls 1 \
        --threads 1 -o "$work/out" 2>"$work/log" || [[ $? == [23] ]] || die "$(cat "$work/log")"
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

if [ "${1:-}" != hard ]; then
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
fi

large=(--set machine.bed_width=900 --set machine.bed_depth=900)
hard_sweep islands pillars "625 2500 10000" "${large[@]}"
hard_sweep "islands with support" pillars "625 2500 10000" --support "${large[@]}"
hard_sweep "islands, two walls, seams at the nearest point" pillars "625 2500 10000" \
    --walls 2 --set seam=nearest "${large[@]}"
hard_sweep holes holes "625 2500 10000" "${large[@]}"
hard_sweep "triangles on one edge" edge "2500 10000 40000"
hard_sweep "triangles of an open spiral" spiral "2000 8000 32000"
hard_sweep "nested shells" shells "125 250 500"
hard_sweep "overlapping tetrahedra" tetrahedra "200 400 800"
hard_sweep "crossing sheets" sheets "25 50 100" "${large[@]}"
hard_sweep "crossing sheets with support" sheets "25 50 100" --support "${large[@]}"
for n in 3125 12500 50000; do
    awk -v n="$n" 'BEGIN { for (k = 0; k < n; k++) print "unknown_" k " = 1" }' >"$work/$n.toml"
    # Exits with 2: the profile is refused.
    echo "$n $work/128.stl -p $work/$n.toml"
done | sweep "unknown keys of a profile"
