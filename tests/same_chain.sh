#!/bin/sh
# Runs scenes with two builds of foldline and compares the chains of hashes of their logs: what is meant to change no result
# changes no bit of one. Every scene has to run to its end with both. Usage: tests/same_chain.sh OLD NEW, from the top of the tree.
set -eu
old=$1
new=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# The chain hash of the last stage.
last_of() {
    "$1" inspect "$2" --json | tail -n 1 | sed -n 's/.*"chain_hash":"\([0-9a-f]*\)".*/\1/p'
}

# A scene, changed by a sed script, and what that does.
compare() {
    sed "${2:-}" "$1" >"$work/scene.toml"
    for build in old new; do
        eval program=\$$build
        if ! "$program" run -q "$work/scene.toml" -o "$work/$build.mcap" >"$work/$build.txt" 2>&1; then
            echo "FAILED    $1 ${3:-} with the $build build: $(tail -n 1 "$work/$build.txt")"
            status=1
            rm -f "$work"/*
            return
        fi
    done
    one=$(last_of "$old" "$work/old.mcap")
    other=$(last_of "$new" "$work/new.mcap")
    if [ "$one" = "$other" ] && [ -n "$one" ]; then
        echo "same      $(echo "$one" | cut -c1-16)  $1 ${3:-}"
    else
        echo "DIFFERENT $1 ${3:-}: $one, $other"
        status=1
    fi
    rm -f "$work"/*
}

short='s/^rotation_deg = .*/rotation_deg = 20.0/'
compare pipelines/baseline.toml "$short" "to 20°"
compare pipelines/baseline-quarter.toml "$short" "to 20°"
compare pipelines/baseline-quarter.toml "$short
/^increment_deg/a longest_increment_deg = 1.6" "to 20°, growing increments"
compare pipelines/baseline-path.toml "s/^elements = .*/elements = [16, 4]/" "on 16 × 4"
compare pipelines/equal-sense.toml "s/^elements = .*/elements = [32, 8]/
s/^rotation_deg = .*/rotation_deg = 5.0/" "to 5° on 32 × 8"
compare pipelines/verification/rolled-cantilever.toml
compare tests/verification/scenes/follower-ring.toml
compare tests/verification/scenes/follower-ring.toml "/^factor/a [continuation]\\
control = \"arc-length\"" "by arc length"
compare pipelines/verification/hinged-roof-12.7.toml
compare pipelines/verification/hinged-roof-6.35-snap.toml
compare pipelines/verification/slit-annular-plate.toml
compare pipelines/verification/laminated-plate.toml
compare pipelines/verification/cured-plate-snap.toml
compare pipelines/verification/cone-pressure.toml
compare pipelines/verification/sphere-zone-pressure.toml
compare pipelines/verification/pinched-hemisphere.toml
compare pipelines/extreme/bifurcation.toml
compare pipelines/extreme/one-element.toml
compare pipelines/extreme/poisson-minus-0.5.toml
compare pipelines/extreme/arc-359.toml
compare pipelines/extreme/laminate-1000-crossed.toml
exit $status
