#!/bin/bash
# How fast G-code is read, judged and compared, beside how fast it is sliced.
#
#   cargo build --release
#   tests/bench/reading.sh MODEL.stl...
#
# Each model is sliced for generic-marlin; then its file is checked alone and against the model,
# compared with itself, and its time estimated. Prints a Markdown table: size of the file,
# processor seconds of slicing, and of the rest processor seconds and peak memory; for check alone also
# MB of G-code in a second, by the clock, with as many threads as there are cores. Of RUNS runs
# (3) the quickest counts. SLICER is our program, if not target/release/slicer.
#
# Needs GNU time (apt-get install time).
set -euo pipefail
export LC_ALL=C

. "$(dirname "$0")/programs.sh"
have "$slicer" || die "$slicer is missing; run cargo build --release"
[ -x /usr/bin/time ] || die "GNU time is missing; apt-get install time"
[ $# -gt 0 ] || die "no models; give at least one STL"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# best ARGUMENT...: prints processor seconds, MiB and seconds of the quickest run.
best() {
    local run
    for ((run = 0; run < ${RUNS:-3}; run++)); do
        # A file with findings is one, too.
        /usr/bin/time -o "$work/time" -f '%U %S %M %e' "$slicer" "$@" >/dev/null 2>&1 || true
        tail -n 1 "$work/time"
    done | awk '{ print $1 + $2, $3 / 1024, $4 }' | sort -n | head -n 1
}

echo "| file | slicing | check | MB/s | check --against | diff | estimate |"
echo "|---|--:|--:|--:|--:|--:|--:|"
for model; do
    file=$work/$(basename "$model" .stl).gcode
    slicing=$(best "$model" -p generic-marlin -o "$file")
    [ -s "$file" ] || die "cannot slice $model"
    alone=$(best check "$file")
    against=$(best check "$file" --against "$model")
    same=$(best diff "$file" "$file")
    times=$(best estimate "$file")
    awk -v name="$(basename "$model" .stl)" -v bytes="$(stat -c %s "$file")" -v slicing="$slicing" \
        -v alone="$alone" -v against="$against" -v same="$same" -v times="$times" '
        function both(text,   of) { split(text, of, " "); return sprintf("%.2f s, %.0f MiB", of[1], of[2]) }
        BEGIN {
            split(slicing, cut, " "); split(alone, one, " ")
            speed = one[3] > 0 ? sprintf("%.0f", bytes / 1e6 / one[3]) : "–"
            printf "| %s, %.1f MB | %.2f s | %s | %s | %s | %s | %s |\n", name, bytes / 1e6, cut[1],
                both(alone), speed, both(against), both(same), both(times)
        }'
    rm -f "$file"
done
