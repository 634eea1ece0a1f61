#!/bin/bash
# How far are our times from those that Klipper's own planner comes to? Prints a Markdown table.
#
#   cargo build --release
#   KLIPPER=folder tests/bench/klipper.sh MODEL.stl...
#
# KLIPPER is a checkout of Klipper3d/klipper, compiled for its simulated board (`make menuconfig`: host
# simulator; `make`), so that there are klippy/klippy.py and out/klipper.dict. Its host software runs the
# file without a printer (klippy.py -i) and says when the last move has ended. What it takes for the
# start block alone is taken off, since homing takes the time of a printer.
# PYTHON is a Python with what Klipper needs (cffi, greenlet, jinja2, python-can), if not python3.
# SLICER is our program, if not target/release/slicer. FLAGS are added to every run of it.
set -euo pipefail
export LC_ALL=C SLICER_NO_USER_CONFIG=1

bench=$(cd "$(dirname "$0")" && pwd)
slicer=${SLICER:-${CARGO_TARGET_DIR:-$bench/../../target}/release/slicer}
read -ra flags <<<"${FLAGS:-}"

die() {
    echo "klipper.sh: $1" >&2
    exit 2
}
[ -x "$slicer" ] || die "$slicer is missing; run cargo build --release"
[ -f "${KLIPPER:-}/out/klipper.dict" ] || die "KLIPPER has no out/klipper.dict; see the head of this file"
[ $# -gt 0 ] || die "give models"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The simulated board has no analog inputs; heaters want the largest value of one.
sed 's/"config": *{/"config": {"ADC_MAX": 4095, "PWM_MAX": 255, /' "$KLIPPER/out/klipper.dict" >"$work/dict"

# seconds FILE: when Klipper has done it. Heaters of no printer never get hot.
seconds() {
    sed 's/^M1[049][049] .*//' "$1" >"$work/cold.gcode"
    rm -f "$work/log"
    "${PYTHON:-python3}" "$KLIPPER/klippy/klippy.py" "$bench/klipper.cfg" -i "$work/cold.gcode" \
        -o "$work/out" -d "$work/dict" -l "$work/log" -v >"$work/told" 2>&1 || true
    cat "$work/log" "$work/told" | sed -n 's/.*Exiting (print time \([0-9.]*\)s).*/\1/p' | tail -n 1
}

echo "| model | flags | Klipper, s | ours, s | difference, % |"
echo "|---|---|--:|--:|--:|"
for model in "$@"; do
    for way in "" --dual; do
        # shellcheck disable=SC2086 # the way is a flag or nothing
        "$slicer" -q "$model" -p generic-klipper $way "${flags[@]}" -o "$work/whole.gcode" 2>/dev/null
        sed '/^;LAYER_CHANGE/q' "$work/whole.gcode" >"$work/start.gcode"
        whole=$(seconds "$work/whole.gcode")
        start=$(seconds "$work/start.gcode")
        [ -n "$whole" ] && [ -n "$start" ] || die "Klipper gave no time; look: $(tail -n 1 "$work/told")"
        "$slicer" estimate "$work/whole.gcode" --json >"$work/ours"
        python3 - "$model" "$way ${FLAGS:-}" "$whole" "$start" "$work/ours" <<'PYTHON'
import json, os, sys
model, way, whole, start, ours = sys.argv[1:]
ours = json.load(open(ours))
ours = ours["seconds"] - ours["start_seconds"]
theirs = float(whole) - float(start)
name = os.path.splitext(os.path.basename(model))[0]
print(f"| {name} | {way.strip()} | {theirs:.1f} | {ours:.1f} | {100 * (ours / theirs - 1):+.2f} |")
PYTHON
    done
done
