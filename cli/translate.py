"""``gproof translate``: a program for another controller, with what is proven of it."""

from __future__ import annotations

import json
from pathlib import Path

import click

from gproof.driver.errors import UsageError
from gproof.driver.files import require_place
from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.finding import Severity
from gproof.ir.verdict import Verdict
from gproof.report.text import print_findings
from gproof.report.translation_text import summary_lines, translation_json


def run_translate(wanted: Wanted, *, output: Path, allow_unproven: bool, form: str) -> int:
    """Translate, report, and write what is proven; the exit code."""
    require_place(output, "output", (wanted.job, wanted.machine, wanted.machine_to, wanted.setup))
    done = translate(wanted)
    open_ = done.verdict is Verdict.UNKNOWN and (allow_unproven or done.partial)
    writes = bool(done.files) and (done.verdict is Verdict.SAFE or open_)
    if form == "json":
        click.echo(json.dumps(translation_json(done, output, written=writes), indent=2))
    else:
        print_findings(done.findings, err=True)
    if writes:
        _write(done, wanted, output)
    if form != "json":
        for line in summary_lines(done, wanted.job, output, written=writes):
            click.echo(line)
    return done.verdict.exit_code


def _write(done: Translation, wanted: Wanted, output: Path) -> None:
    """The files, each in one step; what is not proven says so in its first comment."""
    from gproof.driver.files import write_bytes
    from gproof.driver.targets import TARGETS

    note = ""
    if done.verdict is not Verdict.SAFE:
        reason = next((one for one in done.findings.kept if one.severity in {Severity.UNKNOWN, Severity.ERROR}), None)
        words = "NOT PROVEN" if reason is None else f"NOT PROVEN: {reason.message}"
        begin, end = TARGETS[wanted.to].comment
        plain = "".join(" " if one in "()[]%'\"" else one for one in words)[:200]
        note = f"{begin}{plain}{end}{done.target.style.newline}"
    for name, text in done.files.items():
        path = output.parent / name if name else output
        if name and path.exists():
            raise UsageError(f"output {path}: exists; choose another folder for -o")
        write_bytes(path, text if name else note.encode() + text, "output")
