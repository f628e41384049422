#!/usr/bin/env bash
# A step of action.yml: gproof, from the folder of the action, into an environment of its own.
#
# PYTHON: the Python to take (python3 without it); RUNNER_TEMP: where the environment goes; GITHUB_ACTION_PATH: the
# action's folder. Libraries get the versions of requirements.lock, those that gproof is tested with.
# Every extra for users is there: a setup file may name a drawing.
set -euo pipefail

python=${PYTHON:-python3}
home="$RUNNER_TEMP/gproof"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "::error title=gproof::gproof needs Python 3.11 or newer; the input python-version installs one"
    exit 3
}
"$python" -m venv --clear "$home"
bin="$home/bin"
[ -d "$bin" ] || bin="$home/Scripts" # Windows
# Hashes hold for what an index serves, not for a folder; as constraints the lines have none.
sed -n 's/^\([A-Za-z0-9._-]*==[^\\]*[^\\ ]\) *\\*$/\1/p' "$GITHUB_ACTION_PATH/requirements.lock" >"$home/constraints.txt"
"$bin/python" -m pip install --quiet --disable-pip-version-check \
    --constraint "$home/constraints.txt" "${GITHUB_ACTION_PATH}[dxf]"
"$bin/gproof" --version
