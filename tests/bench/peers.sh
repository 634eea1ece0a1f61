#!/bin/bash
# Whole runs, STL to G-code, of this slicer (plain and --dual) and of other slicers.
#
#   cargo build --release
#   tests/bench/peers.sh MODEL.stl...
#
# Every program does the same work (peers.ini, peers-cura.conf) with as many
# threads as it likes. A round runs each program once, so that a busy machine is
# busy for all; the medians of all rounds are printed as a Markdown table.
# "Faster" is by wall time, against the fastest of the other programs.
#
#   ROUNDS=3      rounds
#   LIMIT=300     seconds after which a program is given up
#   SLICER=...    our program, if not target/release/slicer
#   PRUSA=... SLIC3R=... CURAENGINE=...   the others, if not found by name
#   CURA=DIR      CuraEngine's definitions are in DIR/usr/share/cura/resources
#                 (apt-get download cura && dpkg -x cura_*.deb DIR gives one)
#
# Needs GNU time (apt-get install time). A program that is missing is named and skipped.
set -euo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
rounds=${ROUNDS:-3}
limit=${LIMIT:-300}
slicer=${SLICER:-${CARGO_TARGET_DIR:-$here/../../target}/release/slicer}
prusa=${PRUSA:-prusa-slicer}
slic3r=${SLIC3R:-slic3r}
curaengine=${CURAENGINE:-CuraEngine}
resources=${CURA:-}/usr/share/cura/resources

die() {
    echo "peers.sh: $1" >&2
    exit 2
}
have() { command -v "$1" >/dev/null; }
[ $# -gt 0 ] || die "no models; give at least one STL"
have "$slicer" || die "$slicer is missing; run cargo build --release"
/usr/bin/time -f %e true 2>/dev/null || die "GNU time is missing; apt-get install time"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=$work/out.gcode

declare -A title=(
    [plain]="this slicer" [dual]="this slicer, \`--dual\`"
    [prusa]=PrusaSlicer [slic3r]=Slic3r [cura]=CuraEngine
)
programs=(plain dual)
if have "$prusa"; then programs+=(prusa); else echo "PrusaSlicer is missing: skipped" >&2; fi
if have "$slic3r"; then programs+=(slic3r); else echo "Slic3r is missing: skipped" >&2; fi
if ! have "$curaengine"; then
    echo "CuraEngine is missing: skipped" >&2
elif [ ! -f "$resources/definitions/fdmprinter.def.json" ]; then
    echo "CuraEngine's definitions are not in $resources: skipped; set CURA" >&2
else
    programs+=(cura)
    export CURA_ENGINE_SEARCH_PATH=$resources/definitions:$resources/extruders
    cura_settings=()
    while read -r line; do
        cura_settings+=(-s "$line")
    done < <(grep -v -e '^#' -e '^$' "$here/peers-cura.conf")
fi

# command_of PROGRAM MODEL: sets `command` to what slices the model into $out.
command_of() {
    local ours=("$slicer" -q "$2" -p generic-marlin --walls 1 -o "$out")
    case $1 in
    plain) command=("${ours[@]}") ;;
    dual) command=("${ours[@]}" --dual) ;;
    prusa) command=("$prusa" --export-gcode --load "$here/peers.ini" "$2" -o "$out") ;;
    slic3r) command=("$slic3r" --load "$here/peers.ini" "$2" -o "$out") ;;
    cura)
        command=("$curaengine" slice -j "$resources/definitions/fdmprinter.def.json"
            "${cura_settings[@]}" -e0 "${cura_settings[@]}" -l "$2" -o "$out")
        ;;
    esac
}

# once PROGRAM MODEL: notes wall time (s), cpu time (s) and peak memory (KiB), or why there are none.
once() {
    local times=$work/$1 start end code=0
    grep -qs '[a-z]' "$times" && return
    command_of "$1" "$2"
    rm -f "$out"
    start=${EPOCHREALTIME/./}
    /usr/bin/time -q -o "$work/time" -f "%U %S %M" timeout "$limit" "${command[@]}" \
        >"$work/log" 2>&1 || code=$?
    end=${EPOCHREALTIME/./}
    if [ $code = 124 ]; then
        echo "over $limit s" >"$times"
    elif [ $code != 0 ] || [ ! -s "$out" ]; then
        echo "failed" >"$times"
        echo "${title[$1]} failed with $code on $2: $(tail -n 1 "$work/log")" >&2
    else
        awk -v us=$((end - start)) '{ print us / 1e6, $1 + $2, $3 }' "$work/time" >>"$times"
    fi
}

# median PROGRAM COLUMN
median() {
    cut -d ' ' -f "$2" "$work/$1" | sort -n |
        awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'
}

echo "| model | program | wall s | cpu s | peak MiB | faster | memory |"
echo "|---|---|--:|--:|--:|--:|--:|"
for model; do
    for program in "${programs[@]}"; do rm -f "$work/$program"; done
    for ((round = 0; round < rounds; round++)); do
        for program in "${programs[@]}"; do once "$program" "$model"; done
    done
    fastest= least=
    for program in "${programs[@]:2}"; do
        grep -q '[a-z]' "$work/$program" && continue
        fastest=$( (echo "$fastest"; median "$program" 1) | sort -n | grep -m 1 .)
        least=$( (echo "$least"; median "$program" 3) | sort -n | grep -m 1 .)
    done
    for program in "${programs[@]}"; do
        name=$(basename "$model" .stl)
        if grep -q '[a-z]' "$work/$program"; then
            echo "| $name | ${title[$program]} | $(cat "$work/$program") | | | | |"
            continue
        fi
        awk -v wall="$(median "$program" 1)" -v cpu="$(median "$program" 2)" \
            -v kib="$(median "$program" 3)" -v fastest="$fastest" -v least="$least" \
            -v head="| $name | ${title[$program]}" 'BEGIN {
                printf "%s | %.3f | %.2f | %.1f | %s | %s |\n", head, wall, cpu, kib / 1024,
                    fastest == "" ? "" : sprintf("%.1f x", fastest / wall),
                    least == "" ? "" : sprintf("%.2f x", kib / least)
            }'
    done
done
