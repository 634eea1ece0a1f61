#!/bin/bash
# How well prints hold together: this slicer in four modes, and other slicers, by one measure for all.
#
#   cargo build --release
#   YARDSTICK=PROGRAM tests/bench/hold.sh MODEL.stl...
#
# PROGRAM reads a G-code file with ;TYPE comments, and prints one JSON object with the fields
#   contact      share of the innermost walls' length that sparse infill touches
#   void_m       metres of skin in runs over 3 mm with nothing below
#   hang, ends   free ends of skin lines over nothing, and all ends
#   narrow_m     metres of beads narrower than 0.7 nozzles
#   jumps        changes of flow by two or more within a path
#   idle_mm      longest travel without retraction
# A row of the table is a model and a program. All print two walls, 0.2 mm layers, 0.4 mm lines,
# 20 % infill and 3 skin layers; the modes are plain, --dual, interlaced, and all parts thick.
#
#   SLICER, PRUSA, SLIC3R, CURAENGINE, CURA   see programs.sh
set -euo pipefail
export LC_ALL=C

. "$(dirname "$0")/programs.sh"
yardstick=${YARDSTICK:-}
[ -n "$yardstick" ] && have "$yardstick" || die "set YARDSTICK to a program that measures a G-code file"
[ $# -gt 0 ] || die "no models; give at least one STL"
find_programs
walls=2

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=$work/out.gcode

# row NAME PROGRAM MODEL [ARGUMENT...]: slices and measures.
row() {
    local name=$1 program=$2 model=$3
    shift 3
    command_of "$program" "$model" "$out" "$@"
    rm -f "$out"
    if ! "${command[@]}" >"$work/log" 2>&1 || [ ! -s "$out" ]; then
        echo "| $(basename "$model" .stl) | $name | failed: $(tail -n 1 "$work/log" | cut -c 1-80) | | | | | |"
        return
    fi
    "$yardstick" "$out" | tr -d '{}"' | tr ',' '\n' | awk -F: -v head="| $(basename "$model" .stl) | $name" '
        NF == 2 { v[$1] = $2 }
        END { printf "%s | %.2f | %.2f | %d of %d | %.2f | %d | %d |\n", head, v["contact"], v["void_m"],
              v["hang"], v["ends"], v["narrow_m"], v["jumps"], v["idle_mm"] }'
}

echo "| model | program | contact | void m | hanging ends | narrow m | jumps | longest idle mm |"
echo "|---|---|--:|--:|--:|--:|--:|--:|"
for model; do
    row "plain" ours "$model"
    row "\`--dual\`" ours "$model" --dual
    row "interlaced" ours "$model" --dual-mode interlaced
    row "all parts" ours "$model" --dual --dual-parts all
    for program in "${peers[@]}"; do
        case $program in
        slic3r) ;; # its files do not say what a line is
        cura*) row "${title[$program]}" "$program" "$model" wall_line_count=2 wall_thickness=0.8 ;;
        *) row "${title[$program]}" "$program" "$model" --perimeters 2 ;;
        esac
    done
done
