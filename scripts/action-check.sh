#!/usr/bin/env bash
# A step of action.yml: `gproof check` with the inputs of the action; its exit code is that of the step.
#
# INPUT_…: the inputs, all of them as text; RUNNER_TEMP: where action-install.sh put gproof, and reports go;
# GITHUB_OUTPUT, GITHUB_STEP_SUMMARY: files that outputs and the summary page are appended to.
# Jobs are checked once; each report is written from that.
set -euo pipefail

fail() {
    echo "::error title=gproof::$1"
    printf 'verdict=not-judged\nexit-code=3\nsarif-file=\n' >>"$GITHUB_OUTPUT"
    exit 3
}

# One word of each line that has one: blanks around it and carriage returns do not count.
lines() {
    local line
    words=()
    while IFS= read -r line || [ -n "$line" ]; do
        line=${line%$'\r'}
        line="${line#"${line%%[![:blank:]]*}"}"
        line="${line%"${line##*[![:blank:]]}"}"
        if [ -n "$line" ]; then words+=("$line"); fi
    done <<<"$1"
}

yes() {
    case ${!1} in
    true) return 0 ;;
    false | '') return 1 ;;
    esac
    local name=${1#INPUT_}
    fail "input $(tr 'A-Z_' 'a-z-' <<<"$name") must be true or false"
}

bin="$RUNNER_TEMP/gproof/bin"
[ -d "$bin" ] || bin="$RUNNER_TEMP/gproof/Scripts" # Windows
reports="$RUNNER_TEMP/gproof-reports"
mkdir -p "$reports"
rm -f "$reports/check.json" "$reports/check.md"
sarif=${INPUT_SARIF_FILE:-$reports/gproof.sarif}
case $sarif in *$'\n'*) fail "input sarif-file must be one file" ;; esac
rm -f -- "$sarif"

options=(--report "json=$reports/check.json" --report "sarif=$sarif")
for name in machine setup dialect policy baseline fail-on; do
    variable="INPUT_$(tr 'a-z-' 'A-Z_' <<<"$name")"
    if [ -n "${!variable}" ]; then options+=("--$name=${!variable}"); fi
done
for name in exclude also; do
    variable="INPUT_$(tr 'a-z-' 'A-Z_' <<<"$name")"
    lines "${!variable}"
    for word in ${words[@]+"${words[@]}"}; do options+=("--$name=$word"); done
done
if yes INPUT_WARNINGS_AS_ERRORS; then options+=(--warnings-as-errors); fi
if yes INPUT_STRICT; then options+=(--strict); fi
if yes INPUT_ANNOTATIONS; then options+=(--format github); fi
if yes INPUT_SUMMARY; then options+=(--report "markdown=$reports/check.md"); fi
lines "$INPUT_JOBS"
[ ${#words[@]} -gt 0 ] || fail "input jobs is empty"

code=0
"$bin/gproof" check "${options[@]}" -- "${words[@]}" >"$reports/out.txt" 2>"$reports/err.txt" || code=$?

# Names of files come from the repository: they give no workflow commands, except in the report that is made of them.
token=$(od -An -N16 -tx1 /dev/urandom | tr -d ' \n')
if [ "$INPUT_ANNOTATIONS" = true ]; then
    cat "$reports/out.txt"
    echo "::stop-commands::$token"
else
    echo "::stop-commands::$token"
    cat "$reports/out.txt"
fi
cat "$reports/err.txt"
echo "::$token::"

if [ ! -f "$reports/check.json" ]; then
    told=$(tr '\n\r' '  ' <"$reports/err.txt")
    fail "${told//%/%25}"
fi
verdict=$("$bin/python" -c '
import json, sys
with open(sys.argv[1], encoding="utf-8") as file:
    report = json.load(file)
one = {report.get("verdict"): 1, "conditional": report.get("conditional")}
counts = report.get("counts", {}) if "jobs" in report else one
names = {"not_judged": "not-judged", "UNSAFE": "UNSAFE", "UNKNOWN": "UNKNOWN", "conditional": "SAFE-IF", "SAFE": "SAFE"}
print(next(shown for name, shown in names.items() if counts.get(name)))
' "$reports/check.json")
if [ -f "$reports/check.md" ]; then
    cat "$reports/check.md" >>"$GITHUB_STEP_SUMMARY"
fi
printf 'verdict=%s\nexit-code=%s\nsarif-file=%s\n' "$verdict" "$code" "$sarif" >>"$GITHUB_OUTPUT"
exit "$code"
