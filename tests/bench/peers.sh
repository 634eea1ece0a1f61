#!/bin/bash
# Whole runs, STL to G-code, of this slicer (plain and --dual) and of other slicers.
#
#   cargo build --release
#   tests/bench/peers.sh MODEL.stl...
#
# Every program does the same work (peers.ini, peers-cura.conf) with as many
# threads as it likes. A round runs each program once, so that a busy machine is
# busy for all; the medians of all rounds are printed as a Markdown table, and after it
# what they come to over all models. Memory is measured in a round before them, which also
# brings the files into memory: a program that measures another takes a millisecond or two.
# "Faster" is by wall time, against the fastest of the other programs; "less" by processor
# time, against the least of theirs; "memory" is a share of the least of theirs.
#
#   JOB=support   three walls and support, instead of one wall and none
#   ROUNDS=3      rounds
#   LIMIT=600     seconds of processor time after which a program is given up
#   SLICER, PRUSA, SLIC3R, CURAENGINE, CURA   see programs.sh
#
# Needs GNU time (apt-get install time). A program that is missing is named and skipped.
set -euo pipefail
export LC_ALL=C

. "$(dirname "$0")/programs.sh"
rounds=${ROUNDS:-3}
limit=${LIMIT:-600}
[ $# -gt 0 ] || die "no models; give at least one STL"
/usr/bin/time -f %e true 2>/dev/null || die "GNU time is missing; apt-get install time"
find_programs

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=$work/out.gcode

title+=([plain]="this slicer" [dual]="this slicer, \`--dual\`")
programs=(plain dual "${peers[@]}")
job=() slic3r_job=() cura_job=()
case ${JOB:-} in
'') ;;
support)
    walls=3 job=(--support)
    slic3r_job=(--perimeters 3 --support-material)
    cura_job=(wall_line_count=3 wall_thickness=1.2 support_enable=true)
    ;;
*) die "no such JOB: $JOB" ;;
esac

# run PROGRAM MODEL [MEASURE...]: runs it, under MEASURE; what it says is in $work/log.
run() {
    local program=$1 model=$2
    shift 2
    case $program in
    plain) command_of ours "$model" "$out" "${job[@]}" ;;
    dual) command_of ours "$model" "$out" --dual "${job[@]}" ;;
    cura*) command_of "$program" "$model" "$out" "${cura_job[@]}" ;;
    *) command_of "$program" "$model" "$out" "${slic3r_job[@]}" ;;
    esac
    rm -f "$out"
    code=0
    { time "$@" "${command[@]}" >"$work/log" 2>&1 || code=$?; } 2>"$work/time"
    [ $code != 0 ] || [ -s "$out" ] || code="no G-code"
}

# first PROGRAM MODEL: notes peak memory (KiB), or why there is none.
first() {
    run "$1" "$2" /usr/bin/time -q -o "$work/memory" -f %M
    if [ "$code" = 0 ]; then
        cp "$work/memory" "$work/$1.memory"
    else
        [ "$code" = 137 ] && echo "over $limit s" >"$work/$1" || echo failed >"$work/$1"
        echo "${title[$1]} failed with $code on $2: $(tail -n 1 "$work/log" | cut -c 1-200)" >&2
    fi
}

# once PROGRAM MODEL: notes wall time and processor time (s).
once() {
    grep -qs '[a-z]' "$work/$1" && return
    run "$1" "$2"
    [ "$code" = 0 ] || die "${title[$1]} did not do again what it did: $code on $2"
    awk '{ print $1, $2 + $3 }' "$work/time" >>"$work/$1"
}

# median PROGRAM COLUMN
median() {
    cut -d ' ' -f "$2" "$work/$1" | sort -n |
        awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'
}

echo "| model | program | wall s | cpu s | peak MiB | faster | less | memory |"
echo "|---|---|--:|--:|--:|--:|--:|--:|"
TIMEFORMAT='%3R %3U %3S'
ulimit -t "$limit"
for model; do
    for program in "${programs[@]}"; do
        rm -f "$work/$program"
        first "$program" "$model"
    done
    for ((round = 0; round < rounds; round++)); do
        for program in "${programs[@]}"; do once "$program" "$model"; done
    done
    fastest= laziest= least=
    for program in "${peers[@]}"; do
        grep -q '[a-z]' "$work/$program" && continue
        fastest=$( (echo "$fastest"; median "$program" 1) | sort -n | grep -m 1 .)
        laziest=$( (echo "$laziest"; median "$program" 2) | sort -n | grep -m 1 .)
        least=$( (echo "$least"; cat "$work/$program.memory") | sort -n | grep -m 1 .)
    done
    for program in "${programs[@]}"; do
        name=$(basename "$model" .stl)
        if grep -q '[a-z]' "$work/$program"; then
            echo "| $name | ${title[$program]} | $(cat "$work/$program") | | | | | |"
            continue
        fi
        awk -v wall="$(median "$program" 1)" -v cpu="$(median "$program" 2)" \
            -v kib="$(cat "$work/$program.memory")" -v fastest="$fastest" -v laziest="$laziest" \
            -v least="$least" -v head="| $name | ${title[$program]}" \
            -v ratios="$work/$program.ratios" 'BEGIN {
                if (fastest != "") {
                    faster = fastest / wall; less = laziest / cpu
                    print faster, less, kib / least >>ratios
                    tail = sprintf("%.1f x | %.1f x | %.2f x", faster, less, kib / least)
                } else tail = " | | "
                printf "%s | %.3f | %.3f | %.1f | %s |\n", head, wall, cpu, kib / 1024, tail
            }'
    done
done
for program in plain dual; do
    [ -s "$work/$program.ratios" ] || continue
    awk -v title="${title[$program]}" '
        function worse(a, b) { return NR == 1 || a < b }
        { f += log($1); l += log($2); m += log($3)
          if (worse($1, wf)) wf = $1; if (worse($2, wl)) wl = $2; if (worse(-$3, -wm)) wm = $3 }
        END { row = "| %s | %s | | | | %.1f x | %.1f x | %.2f x |\n"
              printf row, "geometric mean", title, exp(f / NR), exp(l / NR), exp(m / NR)
              printf row, "worst", title, wf, wl, wm }' "$work/$program.ratios"
done
