"""``gproof translate``: a program, or a folder of programs, for another controller, with what is proven of it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click

from gproof.driver.errors import UsageError
from gproof.driver.files import require_place, write_bytes
from gproof.driver.session import open_session
from gproof.driver.targets import TARGETS
from gproof.driver.translation import Translation, Wanted, map_in, raised, translate
from gproof.driver.translation_folder import folder_programs, output_places
from gproof.driver.translation_machines import require_source
from gproof.driver.translation_map import proposed, toml_of
from gproof.ir.finding import Findings, Severity
from gproof.ir.verdict import Verdict, worst
from gproof.report.text import print_findings
from gproof.report.translation_folder import folder_json, folder_lines, folder_markdown
from gproof.report.translation_text import TranslatedProgram, markdown_of, translated_program

PROPOSE = "init"
"""In place of the file of ``--map``: print one instead of translating."""


def run_translate(wanted: Wanted, *, output: Path | None, allow_unproven: bool, form: str) -> int:
    """Translate, report, and write what is proven; the exit code."""
    if wanted.to not in TARGETS:
        raise UsageError(f"--to {wanted.to}: choose one of {', '.join(TARGETS)}")
    if wanted.map == Path(PROPOSE) and not Path(PROPOSE).exists():
        return _propose(wanted)
    if output is None:
        raise UsageError("-o FILE is missing: where to write the program")
    if wanted.job.is_dir():
        return _folder(wanted, output, allow_unproven=allow_unproven, form=form)
    done = _one(wanted, output, {}, allow_unproven=allow_unproven)
    if form == "text":
        print_findings(done.found, err=True)
    if form == "json":
        click.echo(json.dumps(done.data, indent=2))
    else:
        click.echo(markdown_of(done) if form == "markdown" else "\n".join(done.lines))
    return done.verdict.exit_code


def _propose(wanted: Wanted) -> int:
    """Print a map with every number that the job uses."""
    require_source(wanted.job, wanted.machine)
    session = open_session(wanted.job, machine=wanted.machine, setup=wanted.setup, dialect=wanted.dialect)
    if session.program is None:
        print_findings(session.findings, err=True)
        return Verdict.UNSAFE.exit_code
    target = TARGETS[wanted.to].target()
    click.echo(toml_of(proposed(raised(session), target), session.dialect, target.title), nl=False)
    return 0


def _folder(wanted: Wanted, output: Path, *, allow_unproven: bool, form: str) -> int:
    """Every program of a folder; files that several of them call are written once."""
    if output.exists() and not output.is_dir():
        raise UsageError(f"output {output}: is a file; for a folder of programs give a folder")
    programs = folder_programs(wanted, _print_files)
    if wanted.job.resolve() in (output.resolve(), *output.resolve().parents):
        raise UsageError(f"output {output}: is in the folder that is translated; choose another one")
    output.mkdir(parents=True, exist_ok=True)
    extension = map_in(wanted.map).styled(TARGETS[wanted.to].target().style).extension
    places = output_places(programs, wanted.job, output, extension)
    written: dict[Path, bytes] = {}
    done: list[TranslatedProgram] = []
    for one, place in zip(programs.jobs, places, strict=True):
        place.parent.mkdir(parents=True, exist_ok=True)
        others = {other.name: b"" for other in places if other.parent == place.parent and other != place}
        beside = others | {path.name: text for path, text in written.items() if path.parent == place.parent}
        done.append(_one(replace(one, beside=beside), place, written, allow_unproven=allow_unproven))
        if form == "text":
            print_findings(done[-1].found, err=True)
            click.echo(done[-1].lines[0])
    if form == "json":
        click.echo(json.dumps(folder_json(done, programs.called), indent=2))
    elif form == "markdown":
        click.echo(folder_markdown(done, programs.called, wanted.job))
    else:
        click.echo("\n".join(folder_lines(done, programs.called)))
    return worst(one.verdict for one in done).exit_code


def _print_files(findings: Findings) -> None:
    print_findings(findings, err=True)


def _one(
    wanted: Wanted, output: Path, written: dict[Path, bytes], *, allow_unproven: bool
) -> TranslatedProgram:  # fmt: skip
    """One program; written: files of this and earlier ones."""
    require_place(output, "output", (wanted.job, wanted.machine, wanted.machine_to, wanted.setup, wanted.map))
    done = translate(wanted)
    open_ = done.verdict is Verdict.UNKNOWN and (allow_unproven or done.partial)
    writes = bool(done.files) and (done.verdict is Verdict.SAFE or open_)
    if writes:
        _write(done, wanted, output, written)
    return translated_program(done, wanted.job, output, written=writes)


def _write(done: Translation, wanted: Wanted, output: Path, written: dict[Path, bytes]) -> None:
    """The files, each in one step; what is not proven says so in its first comment."""
    note = ""
    if done.verdict is not Verdict.SAFE:
        reason = next((one for one in done.findings.kept if one.severity in {Severity.UNKNOWN, Severity.ERROR}), None)
        words = "NOT PROVEN" if reason is None else f"NOT PROVEN: {reason.message}"
        begin, end = TARGETS[wanted.to].comment
        plain = "".join(" " if one in "()[]%'\"" else one for one in words)[:200]
        note = f"{begin}{plain}{end}{done.map.styled(done.target.style).newline}"
    files = {output.parent / name if name else output: text for name, text in done.files.items()}
    for path, text in files.items():
        if path != output and path.exists() and written.get(path, path.read_bytes()) != text:
            raise UsageError(f"output {path}: exists; choose another folder for -o")
    for path, text in files.items():
        write_bytes(path, note.encode() + text if path == output else text, "output")
        written[path] = text
