"""``gproof translate``: a program for another controller, with what is proven of it."""

from __future__ import annotations

import json
from pathlib import Path

import click

from gproof.driver.errors import UsageError
from gproof.driver.files import require_place
from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.verdict import Verdict
from gproof.report.text import print_findings
from gproof.report.translation_text import summary_lines, translation_json


def run_translate(wanted: Wanted, *, output: Path, allow_unproven: bool, form: str) -> int:
    """Translate, report, and write what is proven; the exit code."""
    require_place(output, "output", (wanted.job, wanted.machine, wanted.machine_to, wanted.setup))
    done = translate(wanted)
    writes = bool(done.files) and (done.verdict is Verdict.SAFE or (allow_unproven and done.verdict is Verdict.UNKNOWN))
    if form == "json":
        click.echo(json.dumps(translation_json(done, output, written=writes), indent=2))
    else:
        print_findings(done.findings, err=True)
    if writes:
        _write(done, output)
    if form != "json":
        for line in summary_lines(done, wanted.job, output, written=writes):
            click.echo(line)
    return done.verdict.exit_code


def _write(done: Translation, output: Path) -> None:
    """The files, each in one step."""
    from gproof.driver.files import write_bytes

    for name, text in done.files.items():
        path = output.parent / name if name else output
        if name and path.exists():
            raise UsageError(f"output {path}: exists; choose another folder for -o")
        write_bytes(path, text, "output")
