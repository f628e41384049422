#!/usr/bin/env bash
# One job through every stage: check it, compile it, verify the certificate, run it on the virtual board.
# Each command is shown before it runs; the first that fails ends the demo with its exit code.
set -euo pipefail
cd "$(dirname "$0")/.."
PATH="$PWD/.venv/bin:$PATH"
job=corpus/eding/drilled-plate
mkdir -p build

show() {
    printf '\n$ %s\n' "$*"
    "$@"
}

show gproof check "$job/job.cnc" --machine "$job/machine.toml" --setup zero --picture build/demo.svg
show gproof compile "$job/job.cnc" --machine "$job/machine.toml" --setup zero -o build/demo.gpx
show gproof verify build/demo.gpx
show gproof run build/demo.gpx --board virtual
printf '\nThe picture of the job is build/demo.svg, the certified stream build/demo.gpx.\n'
