#!/bin/bash
# Broken STL files: what this slicer and others make of each.
#
#   cargo build --release
#   tests/bench/broken.sh FOLDER [LIST]
#
# LIST (FOLDER/LIST.tsv unless given) names the files, a line each, three columns with
# a tab between:  FILE  KIND OF DAMAGE  RIGHT
# RIGHT is a sound STL file of FOLDER that is the same solid at the same place (where the
# lines of infill fall matters in small parts), or `refuse` where there is none. Files that
# a slicer may as well refuse have `SOUND or refuse`.
#
# A file is done right if its filament is within WITHIN % of what the same program uses
# for the sound one, and its top within 0.3 mm (a part must not float). A program says so
# if it prints a line that it does not print for a sound one (numbers aside). Files that
# ought to be refused are right if they are. A program that is missing is named and skipped.
#
#   WITHIN=2      %
#   LIMIT=30      seconds after which a program is given up
#   EACH=         a file to write the outcome of each run to
#   SLICER, PRUSA, SLIC3R, CURAENGINE, CURA   see programs.sh
set -euo pipefail
export LC_ALL=C

. "$(dirname "$0")/programs.sh"
[ $# -ge 1 ] || die "no folder; give one with broken STL files and a LIST.tsv"
folder=$1
list=${2:-$folder/LIST.tsv}
[ -f "$list" ] || die "$list is missing; its form is in the head of this script"
find_programs
title[ours]="this slicer"
programs=(ours "${peers[@]}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# run PROGRAM STL: sets `code`, `made` (see made_of) and the file $work/said, its messages.
run() {
    command_of "$1" "$2" "$work/out.gcode"
    rm -f "$work/out.gcode"
    code=0
    timeout "${LIMIT:-30}" "${command[@]}" >"$work/log" 2>&1 </dev/null || code=$?
    made=$(made_of "$work/out.gcode")
    # Progress, and CuraEngine's list of all settings, are no messages.
    grep -v -e '^[0-9 ]*=>' -e '^Progress' -e ' -s ' "$work/log" |
        sed -e "s|$2||g" -e "s|$(basename "$2")||g" -e 's/0x[0-9a-f]*//g' -e 's/[0-9.]*//g' \
            -e 's/layers/layer/g' |
        sort -u >"$work/said" || true
}

# made_of GCODE: mm of filament that go in while the head moves, and the height (mm) of the
# highest line; zeros if there is no file.
made_of() {
    [ -f "$1" ] || { echo 0 0; return; }
    awk '
        /^M82/ { relative = 0 }
        /^M83/ { relative = 1 }
        /^G9?[012]/ {
            sub(/;.*/, "")
            for (i = 2; i <= NF; i++) {
                value = substr($i, 2) + 0
                if ($i ~ /^Z/) z = value
                if ($i !~ /^E/) continue
                if (/^G[01] / && / [XY]/) {
                    used += relative ? value : value - e
                    if (z > top) top = z
                }
                e = value
            }
        }
        END { print used + 0, top + 0 }' "$1"
}

# outcome PROGRAM FILE RIGHT: right, silent (wrong without a word), said (wrong, but
# said), refused (with a message) or crash (or over the time).
outcome() {
    local want="0 0" words
    [ "$3" = refuse ] || want=$(cat "$work/$1.${3% or refuse}")
    run "$1" "$folder/$2"
    words=$(comm -13 "$work/$1.said" "$work/said" | grep -c '[a-z]' || true)
    if [ $code = 124 ] || [ $code = 101 ] || [ $code -ge 128 ]; then
        echo crash
    elif [ $code != 0 ] && [ "$words" != 0 ]; then
        [[ $3 = *refuse ]] && echo right || echo refused
    elif awk -v made="$made" -v want="$want" -v within="${WITHIN:-2}" \
        'BEGIN {
            split(made, a, " "); split(want, b, " ")
            exit !(b[1] > 0 && far(a[1], b[1]) <= b[1] * within / 100 && far(a[2], b[2]) <= 0.3)
        }
        function far(p, q) { return p > q ? p - q : q - p }'; then
        echo right
    elif [ "$words" != 0 ]; then
        echo said
    else
        echo silent
    fi
}

# The sound ones first: $work/PROGRAM.FILE holds what is made, $work/PROGRAM.said the messages.
cut -f 3 "$list" | sed 's/ or refuse$//' | grep -v '^refuse$' | sort -u >"$work/sound"
for program in "${programs[@]}"; do
    while read -r file; do
        run "$program" "$folder/$file"
        echo "$made" >"$work/$program.$file"
        cat "$work/said" >>"$work/heard"
    done <"$work/sound"
    sort -u "$work/heard" >"$work/$program.said"
    rm "$work/heard"
done

while IFS=$'\t' read -r file kind right; do
    [ -n "$right" ] || continue
    for program in "${programs[@]}"; do
        printf '%s\t%s\t%s\t%s\n' "$program" "$kind" "$(outcome "$program" "$file" "$right")" "$file"
    done
done <"$list" >"$work/outcomes"
[ -z "${EACH:-}" ] || cp "$work/outcomes" "$EACH"

echo "Right / wrong without a word / wrong but said / refused with a message / crash or hang;"
echo "right is within ${WITHIN:-2} % of the sound solid's filament and as high, or refused where there is none."
echo
names=$(for program in "${programs[@]}"; do echo -n " ${title[$program]} |"; done)
echo "| damage | files |$names"
echo "|---|--:|$(printf -- '---|%.0s' "${programs[@]}")"
awk -F '\t' -v programs="${programs[*]}" '
    function row(kind,    i, p, cell) {
        cell = ""
        for (i = 1; i in program; i++) {
            p = program[i]
            cell = cell sprintf(" %d / %d / %d / %d / %d |", n[kind, p, "right"], n[kind, p, "silent"],
                n[kind, p, "said"], n[kind, p, "refused"], n[kind, p, "crash"])
        }
        printf "| %s | %d |%s\n", kind, files[kind], cell
    }
    BEGIN { split(programs, program, " ") }
    {
        if (!($2 in files)) kinds[++count] = $2
        if ($1 == program[1]) { files[$2]++; files["all"]++ }
        n[$2, $1, $3]++
        n["all", $1, $3]++
    }
    END {
        for (k = 1; k <= count; k++) row(kinds[k])
        row("all")
    }' "$work/outcomes"
