#!/bin/bash
# Applies each patch here to a copy of the project, builds it, slices with it and checks the product.
#
#   tests/extend/run.sh FOLDER      copies go to FOLDER, which is made
#
# The patches show that a new role and a new sparse pattern have an obvious place: each adds
# fewer than 40 lines. A patch's head says what to slice, and what the G-code has to hold then.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
folder=$(mkdir -p "$1" && cd "$1" && pwd)
cd "$here/../.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}

head_line() { sed -n "s/^$1: //p" "$2" | head -n 1; }

for patch in "$here"/*.patch; do
    name=$(basename "$patch" .patch)
    added=$(grep -c '^+[^+]' "$patch")
    [ "$added" -lt 40 ] || { echo "$name: $added added lines are no longer fewer than 40"; exit 1; }
    copy=$folder/$name
    rm -rf "$copy"
    mkdir -p "$copy"
    git ls-files -z | xargs -0 cp --parents -t "$copy"
    cd "$copy"
    # A repository of its own: within another one git would look for the files at its top.
    git init --quiet
    git apply "$patch"
    # Cargo may take one copy's build for that of another.
    cargo clean --quiet --locked -p slicer
    # It slices one part: optimising would take longer than that.
    cargo build --quiet --locked --config 'profile.dev.package.slicer.opt-level=0'
    # shellcheck disable=SC2046 # flags are words
    "$CARGO_TARGET_DIR/debug/slicer" -q $(head_line Slice "$patch") --check -o made.gcode
    grep -q "$(head_line Find "$patch")" made.gcode || { echo "$name: it is not in the G-code"; exit 1; }
    echo "$name: $added added lines, sliced and checked"
    cd "$here/../.."
done
