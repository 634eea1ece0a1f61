#!/bin/bash
# Print times of this slicer's files and of other slicers', on one clock (clock.toml).
#
#   cargo build --release
#   tests/bench/times.sh thesis DIR         the thesis's parts, honeycomb beside ours
#   tests/bench/times.sh peers MODEL.stl... infill combined by all: who prints fastest?
#   tests/bench/times.sh cooling MODEL.stl... what does a least time of 10 s a layer cost?
#
# All print a Markdown table, with all programs set to the same work (peers.ini,
# peers-cura.conf). The start block is left out of the times, heating and homing are
# not in them. Nothing is kept: every file is sliced anew.
#
# DIR holds stand-ins for the thesis's parts, NAME.stl; the names are below.
#
#   HEIGHT=0.2    peers: height of a layer, mm. The others print infill of as many layers
#                 at once as go into 0.4 mm. So do we, with --dual-ratio auto where these
#                 are more than two.
#   CROSSING=1    PrusaSlicer and Slic3r retract where we do: only across walls
#   REACH=0       peers: skin reaches so far into our infill, mm. The others have none.
#   LIMIT=300     seconds after which a program is given up
#   SLICER, PRUSA, SLIC3R, CURAENGINE, CURA   see programs.sh
#
# Needs jq. A program that is missing is named and skipped; one that fails is marked "–".
set -euo pipefail
export LC_ALL=C

. "$(dirname "$0")/programs.sh"
limit=${LIMIT:-300}
height=${HEIGHT:-0.2}
have jq || die "jq is missing; apt-get install jq"
find_programs
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The Slic3r family's arguments for all runs.
family=(--layer-height "$height" --first-layer-height "$height")
[ -n "${CROSSING:-}" ] && family+=(--only-retract-when-crossing-perimeters)

# timed NAME PROGRAM MODEL [ARGUMENT...]: writes $work/NAME: seconds, filament mm, sparse
# infill's filament mm, quick layers: those that with the slower one of their neighbours take less
# than 9 s on average (a pair of --dual shares its time). No file if the program fails, or if
# nothing is printed.
timed() {
    local name=$1 program=$2 out=$work/$1.gcode code=0
    shift 2
    rm -f "$work/$name"
    command_of "$program" "$1" "$out" "${@:2}"
    timeout "$limit" "${command[@]}" >"$work/$name.log" 2>&1 || code=$?
    if [ $code != 0 ] || [ ! -s "$out" ]; then
        echo "$program failed with $code on $1: $(tail -n 1 "$work/$name.log")" >&2
    else
        "$slicer" estimate -p "$bench/clock.toml" --fixed-limits --json "$out" |
            jq -r 'select(.filament_mm > 0) | [.seconds - .start_seconds, .filament_mm,
                ([.roles[] | select(.role == "infill") | .filament_mm] | add // 0),
                ([.layers[].seconds] | . as $t | [range(length) | select(
                    ([$t[. + 1], if . > 0 then $t[. - 1] else null end] | map(. // 0) | max)
                    + $t[.] < 18)] | length)] | join(" ")' \
                >"$work/$name" || true
    fi
    rm -f "$out"
}

# of NAME COLUMN: a figure that `timed` has noted; nothing, and false, if there is none.
of() { [ -s "$work/$1" ] && cut -d ' ' -f "$2" "$work/$1"; }

# The thesis's parts in its order: our stand-in, its name, minutes traditional and dual,
# saved %, filament m traditional and dual.
thesis_parts='
cube_65559mm3|cube, 65.559 cm³|92|45|51|7.741|8.459
like_building|MIT building|79|45|43|6.812|7.029
like_bracket|mechanical bracket|59|34|42|3.925|3.861
like_hand|hand|51|31|39|3.107|3.159
like_turbine|water turbine|42|28|33|3.029|2.832
like_bear|bear with support|83|64|23|5.806|4.536
bar_A|bar A|46|25|46|4.555|4.642
bar_B|bar B|48|23|52|4.297|4.198
bar_C|bar C|49|23|53|4.151|3.992
bar_D|bar D|54|26|52|4.408|4.067
bar_E|bar E|61|29|52|4.595|4.146
bar_F|bar F|96|52|46|8.475|6.640
bar_G|bar G|78|40|49|6.136|5.207
bar_H|bar H|96|55|43|7.239|6.668
bar_I|bar I|129|80|38|9.820|8.350'

thesis() {
    [ $# = 1 ] && [ -d "$1" ] || die "give the folder with the stand-ins"
    local peer stand_in name traditional dual saved metres dual_metres
    local bases=''
    for peer in "${peers[@]}"; do [[ $peer = cura* || $peer = *_too ]] || bases+="${bases:+ / }${title[$peer]}"; done
    echo "Minutes, and m of filament (traditional / \`--dual\`). Traditional here is 20 % honeycomb of ${bases:-nobody}; the better of \`--dual\` and all parts saves so many points more than the thesis."
    echo
    echo "| part | thesis: traditional | dual | saved | m, both | here: traditional | \`--dual\` | saved | all parts | saved | points more | m, both |"
    echo "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
    while IFS='|' read -r stand_in name traditional dual saved metres dual_metres; do
        [ -n "$stand_in" ] || continue
        local model=$1/$stand_in.stl other=() ours=()
        if [ ! -f "$model" ]; then
            echo "$model is missing: skipped" >&2
            continue
        fi
        if [ "$stand_in" = like_bear ]; then
            other=(--support-material)
            ours=(--support)
        fi
        rm -f "$work"/{prusa,slic3r}
        for peer in "${peers[@]}"; do
            [[ $peer = cura* || $peer = *_too ]] || # no honeycomb, or told once
                timed "$peer" "$peer" "$model" "${family[@]}" --fill-pattern honeycomb "${other[@]}" &
        done
        wait
        timed dual ours "$model" --dual "${ours[@]}"
        timed all ours "$model" --dual --dual-parts all "${ours[@]}"
        awk -v head="| $name | $traditional | $dual | $saved % | $metres / $dual_metres" -v saved="$saved" \
            -v prusa="$(of prusa 1)" -v slic3r="$(of slic3r 1)" -v dual="$(of dual 1)" -v all="$(of all 1)" \
            -v other_mm="$(of prusa 2 || of slic3r 2)" -v dual_mm="$(of dual 2)" '
            # Two figures, or the one there is.
            function both(a, b) { return a == "" ? (b == "" ? "–" : b) : (b == "" ? a : a " / " b) }
            function figure(format, value) { return value == "" ? "" : sprintf(format, value) }
            function less(time, than) {
                return time == "" || than == "" ? "" : sprintf("%.0f", 100 * (1 - time / than))
            }
            function percent(text) { return text == "–" ? text : text " %" }
            function more(than,   best) {
                best = dual == "" || (all != "" && all < dual) ? all : dual
                return best == "" || than == "" ? "" : sprintf("%+.0f", 100 * (1 - best / than) - saved)
            }
            # As numbers, or empty.
            function number(text) { return text == "" ? "" : text + 0 }
            BEGIN {
                dual = number(dual); all = number(all)
                minutes = "%.1f"
                print head " | " both(figure(minutes, prusa == "" ? "" : prusa / 60),
                        figure(minutes, slic3r == "" ? "" : slic3r / 60)) \
                    " | " both(figure(minutes, dual == "" ? "" : dual / 60), "") \
                    " | " percent(both(less(dual, prusa), less(dual, slic3r))) \
                    " | " both(figure(minutes, all == "" ? "" : all / 60), "") \
                    " | " percent(both(less(all, prusa), less(all, slic3r))) \
                    " | " both(more(prusa), more(slic3r)) \
                    " | " both(figure("%.3f", other_mm == "" ? "" : other_mm / 1000), "") \
                    " / " both(figure("%.3f", dual_mm == "" ? "" : dual_mm / 1000), "") " |"
            }'
    done <<<"$thesis_parts"
}

# peer_arguments PEER: sets `arguments` to what makes it combine infill.
peer_arguments() {
    case $1 in
    cura*) arguments=("layer_height=$height" "layer_height_0=$height" infill_sparse_thickness=0.4) ;;
    *) arguments=("${family[@]}" --infill-every-layers "$layers") ;;
    esac
}

peers() {
    [ $# -gt 0 ] || die "no models; give at least one STL"
    local layers model name peer ours arguments
    layers=$(awk -v height="$height" 'BEGIN { print int(0.4 / height + 1e-6) }')
    ours=(--layer-height "$height" --first-layer-height "$height" --dual --set "skin_reach=${REACH:-0}")
    [ "$layers" -gt 2 ] && ours+=(--dual-ratio auto)
    echo "Layers of $height mm, infill of $layers combined. Seconds; ratios to the fastest of the others."
    echo
    echo "| model | fastest of the others | | \`--dual\` | ratio | all parts | ratio | infill's filament |"
    echo "|---|---|--:|--:|--:|--:|--:|--:|"
    for model; do
        name=$(basename "$model" .stl)
        rm -f "$work"/{prusa,slic3r,cura}{,_too}
        for peer in "${peers[@]}"; do
            peer_arguments "$peer"
            timed "$peer" "$peer" "$model" "${arguments[@]}" &
        done
        wait
        timed dual ours "$model" "${ours[@]}"
        timed all ours "$model" "${ours[@]}" --dual-parts all
        local fastest='' best='' failed=''
        for peer in "${peers[@]}"; do
            local seconds
            seconds=$(of "$peer" 1) || true
            if [ -z "$seconds" ]; then
                failed+=", ${title[$peer]} –"
            elif [ -z "$best" ] || awk "BEGIN { exit !($seconds < $best) }"; then
                fastest=$peer best=$seconds
            fi
        done
        awk -v name="$name" -v who="${title[${fastest:-none}]:-}$failed" -v best="$best" \
            -v dual="$(of dual 1)" -v all="$(of all 1)" \
            -v ours="$(of dual 3)" -v theirs="$(of "${fastest:-none}" 3)" -v rows="$work/rows" '
            function seconds(value) { return value == "" ? "–" : sprintf("%.0f", value) }
            function ratio(a, b) { return a == "" || b == "" || b <= 0 || a <= 0 ? "–" : sprintf("%.3f", a / b) }
            BEGIN {
                sub(/^, /, "", who)
                printf "| %s | %s | %s | %s | %s | %s | %s | %s |\n", name, who, seconds(best),
                    seconds(dual), ratio(dual, best), seconds(all), ratio(all, best), ratio(ours, theirs)
                print ratio(dual, best), ratio(all, best), ratio(ours, theirs) >>rows
            }'
    done
    awk '
        { for (i = 1; i <= 3; i++) if ($i != "–") { sum[i] += log($i); n[i]++ } }
        function mean(i) { return n[i] ? sprintf("%.3f", exp(sum[i] / n[i])) : "–" }
        END { printf "| geometric mean of %d | | | | %s | | %s | %s |\n", n[1], mean(1), mean(2), mean(3) }
    ' "$work/rows"
}

# cooling_arguments PROGRAM: sets `arguments` to what makes it give each layer 10 s.
cooling_arguments() {
    case $1 in
    ours) arguments=(--min-layer-time 10) ;;
    cura*) arguments=(cool_min_layer_time=10 cool_min_speed=10) ;;
    *) arguments=(--cooling --slowdown-below-layer-time 10 --min-print-speed 10) ;;
    esac
}

cooling() {
    [ $# -gt 0 ] || die "no models; give at least one STL"
    local model name program arguments
    echo "Seconds without and with a least time of 10 s a layer, at no less than 10 mm/s; quick layers: those that with the slower one of their neighbours take less than 9 s on average."
    echo
    echo "| model | program | off | on | ratio | quick layers, off | on |"
    echo "|---|---|--:|--:|--:|--:|--:|"
    for model; do
        name=$(basename "$model" .stl)
        rm -f "$work"/*_{off,on}
        for program in "${peers[@]}"; do
            cooling_arguments "$program"
            timed "${program}_off" "$program" "$model" &
            timed "${program}_on" "$program" "$model" "${arguments[@]}" &
            wait
        done
        cooling_arguments ours
        timed plain_off ours "$model"
        timed plain_on ours "$model" "${arguments[@]}"
        timed dual_off ours "$model" --dual
        timed dual_on ours "$model" --dual "${arguments[@]}"
        for program in plain dual "${peers[@]}"; do
            awk -v name="$name" -v who="${title[$program]:-$program}" \
                -v off="$(of "${program}_off" 1)" -v on="$(of "${program}_on" 1)" \
                -v quick_off="$(of "${program}_off" 4)" -v quick_on="$(of "${program}_on" 4)" '
                function seconds(value) { return value == "" ? "–" : sprintf("%.0f", value) }
                BEGIN {
                    ratio = off > 0 && on > 0 ? sprintf("%.2f", on / off) : "–"
                    print "| " name " | " who " | " seconds(off) " | " seconds(on) " | " ratio \
                        " | " quick_off " | " quick_on " |"
                }'
        done
    done
}

case ${1:-} in
thesis | peers | cooling) "$@" ;;
*) die "say thesis DIR, peers MODEL.stl... or cooling MODEL.stl..." ;;
esac
