# Sourced by peers.sh, times.sh and broken.sh: where the slicers are, and how each is called so that
# all do the same work (plain.toml, peers.ini, peers-cura.conf).
#
#   SLICER=...    our program, if not target/release/slicer
#   PRUSA=... SLIC3R=... CURAENGINE=...   the others, if not found by name
#   CURA=DIR      CuraEngine's definitions are in DIR/usr/share/cura/resources
#                 (apt-get download cura && dpkg -x cura_*.deb DIR gives one)
#   PRUSA_TOO=... CURAENGINE_TOO=... CURA_TOO=DIR   another version of each, beside the first
# shellcheck shell=bash disable=SC2034 # the scripts that source it use what it sets

bench=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
slicer=${SLICER:-${CARGO_TARGET_DIR:-$bench/../../target}/release/slicer}
prusa=${PRUSA:-prusa-slicer}
slic3r=${SLIC3R:-slic3r}
curaengine=${CURAENGINE:-CuraEngine}
resources=${CURA:-}/usr/share/cura/resources
resources_too=${CURA_TOO:-}/usr/share/cura/resources

die() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}
have() { command -v "$1" >/dev/null; }

declare -A title=([prusa]=PrusaSlicer [slic3r]=Slic3r [cura]=CuraEngine
    [prusa_too]="other PrusaSlicer" [cura_too]="other CuraEngine")

# find_programs: sets `peers` to the other programs that are there, and names the rest.
find_programs() {
    have "$slicer" || die "$slicer is missing; run cargo build --release"
    peers=()
    if have "$prusa"; then peers+=(prusa); else echo "PrusaSlicer is missing: skipped" >&2; fi
    [ -z "${PRUSA_TOO:-}" ] || peers+=(prusa_too)
    if have "$slic3r"; then peers+=(slic3r); else echo "Slic3r is missing: skipped" >&2; fi
    if ! have "$curaengine"; then
        echo "CuraEngine is missing: skipped" >&2
    elif [ ! -f "$resources/definitions/fdmprinter.def.json" ]; then
        echo "CuraEngine's definitions are not in $resources: skipped; set CURA" >&2
    else
        peers+=(cura)
        [ -z "${CURAENGINE_TOO:-}" ] || peers+=(cura_too)
        cura_settings=()
        while read -r line; do
            cura_settings+=(-s "$line")
        done < <(grep -v -e '^#' -e '^$' "$bench/peers-cura.conf")
    fi
}

# command_of PROGRAM MODEL OUT [ARGUMENT...]: sets `command` to what slices the model.
# CuraEngine's arguments are settings, KEY=VALUE.
command_of() {
    local program=$1 model=$2 out=$3
    shift 3
    case $program in
    ours) command=("$slicer" -q "$model" -p generic-marlin -p "$bench/plain.toml" --walls "${walls:-1}" "$@" -o "$out") ;;
    prusa) command=("$prusa" --export-gcode --load "$bench/peers.ini" "$@" "$model" -o "$out") ;;
    prusa_too)
        command=("$PRUSA_TOO" --export-gcode --load "$bench/peers.ini" "$@" "$model" -o "$out")
        ;;
    slic3r) command=("$slic3r" --load "$bench/peers.ini" "$@" "$model" -o "$out") ;;
    cura) cura_command "$curaengine" "$resources" "$model" "$out" "$@" ;;
    cura_too) cura_command "$CURAENGINE_TOO" "$resources_too" "$model" "$out" "$@" ;;
    esac
}

# cura_command ENGINE RESOURCES MODEL OUT [SETTING...]: sets `command` for one CuraEngine.
cura_command() {
    local engine=$1 where=$2 model=$3 out=$4 setting
    local all=("${cura_settings[@]}")
    for setting in "${@:5}"; do all+=(-s "$setting"); done
    # Once for the machine, once for the extruder.
    command=(env "CURA_ENGINE_SEARCH_PATH=$where/definitions:$where/extruders"
        "$engine" slice -j "$where/definitions/fdmprinter.def.json"
        "${all[@]}" -e0 "${all[@]}" -l "$model" -o "$out")
}
