"""The command ``gproof``: arguments in, exit code out. Everything heavy is imported by the command that needs it.

Exit codes: 0 SAFE (or done), 1 UNSAFE, 2 UNKNOWN, 3 the command itself could not run, 130 interrupted (Ctrl-C,
SIGTERM, SIGHUP).
"""

from __future__ import annotations

import os
import re
import sys
from functools import partial
from pathlib import Path
from typing import Any

import click

from gproof.cli.board_commands import boards, run
from gproof.cli.diff import diff
from gproof.cli.help import Command, Group, option
from gproof.cli.options import (
    AGAIN,
    ALSO,
    FILE,
    FORMAT,
    JOB,
    MOST,
    NO_END,
    PACKAGE,
    READ,
    REPORT,
    REQUIRED,
    SEVERAL,
    UNITS,
    FileName,
    OneOf,
    dialects,
    documents,
    job_options,
    once,
    package_options,
)
from gproof.cli.resume_command import resume
from gproof.cli.signals import INTERRUPTED, PROCESS, ended_by_signals
from gproof.cli.status_command import status
from gproof.cli.streams import discard, standard_streams
from gproof.cli.telling import tell_error
from gproof.cli.translate_options import translate
from gproof.driver.errors import COULD_NOT_RUN, UsageError
from gproof.driver.escape import in_one_line


class _Interrupted(click.ClickException):
    """Ctrl-C, before click says something of its own."""

    exit_code = INTERRUPTED

    def show(self, file: Any = None) -> None:
        """Print the line; on a terminal not after its ``^C``."""
        click.echo("\n" * sys.stderr.isatty() + self.message, err=True)


class _Commands(Group):
    """The commands; an interrupt of any is an exit code of its own."""

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        """Read the arguments."""
        try:
            return super().make_context(*args, **extra)
        except KeyboardInterrupt:
            raise _Interrupted("gproof: interrupted") from None

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise _Interrupted("gproof: interrupted") from None


def _version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if not wanted or context.resilient_parsing:
        return
    from importlib.metadata import version

    click.echo(f"gproof {version('gproof')}")
    context.exit()


@click.group(
    cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]}, no_args_is_help=True,
    examples=("gproof check part.cnc --machine mill.toml --setup vise.toml", "gproof explain GP301"),
)  # fmt: skip
@option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Show the version")
def cli() -> None:
    """Check G-code before it runs on a machine, compile it to certified steps, and run those on a board."""


@cli.command(
    cls=Command, short_help="Check whether programs are safe to run",
    examples=(
        "gproof check part.cnc --machine mill.toml --setup vise.toml",
        "gproof check part.cnc --machine WINCNC.INI --setup zero --also all",
        "gproof check jobs/ --machine mill.toml --report junit=report.xml",
    ),
)  # fmt: skip
@click.argument("jobs", metavar="JOB...", nargs=-1, required=True)
@job_options
@ALSO
@once("--policy", title=REQUIRED, metavar=FILE, type=FileName(), help="Policy: what the shop requires of jobs (TOML)")
@option(
    "--fail-on", title=REQUIRED, metavar="LEVEL", type=click.Choice(["unknown", "warning", "note"]),
    help="Lowest severity that fails the check: {choices} [default: unknown]",
)  # fmt: skip
@option(
    "--warnings-as-errors", "warnings_are_errors", title=REQUIRED, is_flag=True,
    help="Count warnings as errors: a job with one is UNSAFE",
)  # fmt: skip
@option("--strict", title=REQUIRED, is_flag=True, help="Count SAFE under conditions (SAFE-IF) as UNKNOWN")
@once("--baseline", title=REQUIRED, metavar=FILE, type=FileName(), help="Known findings, which do not fail the check")
@option(
    "--write-baseline", "new_baseline", title=REQUIRED, metavar=FILE, type=FileName(),
    help="Write what is found to a new baseline",
)  # fmt: skip
@option(
    "--format", "form", title=REPORT, metavar="FORMAT", type=OneOf(documents), default="text",
    help="Format of the report: {choices} [default: text]",
)  # fmt: skip
@option("--output", title=REPORT, metavar=FILE, type=FileName(), help="Write the report to a file")
@option(
    "--report", "reports", title=REPORT, multiple=True, metavar="FORMAT=FILE",
    help="Write one more report; may be repeated",
)  # fmt: skip
@option("--picture", title=REPORT, metavar=FILE, type=FileName(), help="Draw the tool path (SVG)")
@UNITS
@option("-q", "--quiet", title=REPORT, is_flag=True, help="Print the verdicts only")
@option("--no-group", "--all", "every", title=REPORT, is_flag=True, help="List every repeat of a finding")
@option(
    "-j", "--jobs", "workers", title=SEVERAL, metavar="N", type=click.IntRange(1, 1024),
    help="Number of worker processes [default: automatic]",
)  # fmt: skip
@option(
    "--exclude", title=SEVERAL, multiple=True, metavar="PATTERN",
    help="Leave these jobs out of folders and patterns; may be repeated",
)  # fmt: skip
def check(
    jobs: tuple[str, ...], machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, form: str, strict: bool, picture: Path | None,
    units: str | None, output: Path | None, quiet: bool, workers: int | None, exclude: tuple[str, ...],
    policy: Path | None, fail_on: str | None, warnings_are_errors: bool, baseline: Path | None,
    new_baseline: Path | None, also: tuple[str, ...], reports: tuple[str, ...], every: bool,
) -> int:  # fmt: skip
    """Check whether each JOB is safe to run on a machine.

    A JOB is a program, a folder of programs, a pattern such as "*.cnc", or a job file: a TOML file that names
    programs, each with its machine, setup and policy.

    Exit code: 0 SAFE, 1 UNSAFE, 2 UNKNOWN, 3 the check could not run.
    """
    from gproof.cli.check import run_check
    from gproof.driver.session import Running

    return run_check(
        jobs, machine=machine, setup=setup, dialect=dialect, running=Running(max_blocks, max_branches, render, call),
        form=form, strict=strict, picture=picture, units=units, output=output, quiet=quiet, workers=workers,
        exclude=exclude, policy=policy, fail_on=fail_on, warnings_are_errors=warnings_are_errors, baseline=baseline,
        new_baseline=new_baseline, also=also, reports=reports, every=every,
    )  # fmt: skip


@cli.command(
    cls=Command, short_help="Find the work zeros for which a program is safe",
    examples=(
        "gproof fit part.cnc --machine mill.toml --setup vise.toml",
        "gproof fit part.cnc --machine mill.toml --machine router.toml --setup zero",
    ),
)  # fmt: skip
@JOB
@partial(job_options, machines=True)
@FORMAT
@option("--picture", title=REPORT, metavar=FILE, type=FileName(), help="Draw where the work zero can be (SVG)")
@UNITS
def fit(
    job: Path, machine: tuple[Path, ...], setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, form: str, units: str | None, picture: Path | None,
) -> int:  # fmt: skip
    """Find the work offsets for which JOB is safe, what to change now, and how large a machine it needs.

    With --machine given several times: which of these machines can run it.

    Exit code: 0 SAFE with the offsets of the setup file (or, if it gives none, with some), 1 UNSAFE, 2 UNKNOWN, 3 the
    command could not run.
    """
    from gproof.cli.fit import run_fit
    from gproof.driver.session import Running

    return run_fit(
        job, machines=machine, setup=setup, dialect=dialect, running=Running(max_blocks, max_branches, render, call),
        form=form, units=units, picture=picture,
    )  # fmt: skip


@cli.command(
    cls=Command, short_help="Print what gproof makes of a program, by stage",
    examples=(
        "gproof dump part.cnc --stage program",
        "gproof dump part.cnc --machine mill.toml --stage trace --format jsonl",
    ),
)  # fmt: skip
@JOB
@job_options
@option(
    "--stage", title=REPORT, metavar="STAGE", type=click.Choice(["program", "job", "trace", "plan", "stream"]),
    required=True,
    help="Stage to print: program (as it is read), job (its neutral form, for translation), trace (its moves), "
    "plan (with speeds), stream (motor steps)",
)  # fmt: skip
@option(
    "--format", "form", title=REPORT, metavar="[text|jsonl]", type=click.Choice(["text", "jsonl"]), default="text",
    help="Text, or JSON Lines (of the trace only) [default: text]",
)  # fmt: skip
def dump(
    job: Path, machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, stage: str, form: str,
) -> int:  # fmt: skip
    """Print a stage of JOB on its way to motor steps.

    Findings are printed to standard error.
    """
    from gproof.cli.dump import run_dump
    from gproof.driver.session import Running

    return run_dump(
        job, machine=machine, setup=setup, dialect=dialect, running=Running(max_blocks, max_branches, render, call),
        stage=stage, form=form,
    )  # fmt: skip


cli.add_command(translate)
cli.add_command(diff)


@cli.command(
    name="compile", cls=Command, short_help="Compile a program to a certified step stream",
    examples=("gproof compile part.cnc --machine mill.toml --setup vise.toml -o part.gpx",),
)  # fmt: skip
@JOB
@job_options
@ALSO
@option(
    "-o", "--output", title=PACKAGE, metavar=FILE, type=FileName(), required=True, help="Package to write (.gpx)"
)  # fmt: skip
@option(
    "--key", title=PACKAGE, metavar=FILE, type=FileName(),
    help="Private key to sign with (Ed25519, PEM) [default: your own key]",
)  # fmt: skip
@option("--unsigned", title=PACKAGE, is_flag=True, help="Do not sign the certificate")
def compile_(
    job: Path, machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, output: Path, key: Path | None, unsigned: bool,
    also: tuple[str, ...],
) -> int:  # fmt: skip
    """Compile JOB to a certified step stream.

    Only a job that is SAFE is compiled. Every step is checked before the package is written.

    Exit code: 0 written, 1 UNSAFE, 2 UNKNOWN, 3 the command could not run.
    """
    from gproof.cli.compile import run_compile
    from gproof.driver.pipeline import Request
    from gproof.driver.session import Running

    return run_compile(
        Request(
            job=job, machine=machine, setup=setup, dialect=dialect,
            running=Running(max_blocks, max_branches, render, call), output=output, key=key, unsigned=unsigned,
            also=also,
        )
    )  # fmt: skip


@cli.command(
    cls=Command, short_help="Verify a step stream, or an execution record",
    examples=(
        "gproof verify part.gpx --machine mill.toml --setup vise.toml",
        "gproof verify part.record.json --package part.gpx",
    ),
)  # fmt: skip
@click.argument("package", type=FileName())
@package_options
@option(
    "--package", "run_package", title="Execution record", metavar=FILE, type=FileName(),
    help="For a record: the package that was run",
)  # fmt: skip
@once(
    "--against", title=AGAIN, metavar=FILE, type=FileName(),
    help="Compile this program again and report which part of the package differs",
)  # fmt: skip
@option(
    "--dialect", title=AGAIN, metavar="NAME", type=OneOf(dialects),
    help="Controller of that program: {choices} [default: detected]",
)  # fmt: skip
@option("--max-blocks", title=AGAIN, metavar="N", type=click.IntRange(1, MOST), help="As it was compiled")
@option("--max-branches", title=AGAIN, metavar="N", type=click.IntRange(0, MOST), help="As it was compiled")
@option("--call", title=AGAIN, metavar="NAME", help="Subprogram that was compiled")
@option("--pure", is_flag=True, help="Prove the steps without compiled code and numba: slow, but less to trust")
@FORMAT
def verify(
    package: Path, machine: Path | None, setup: str | None, source: Path | None, trust: tuple[Path, ...],
    run_package: Path | None, form: str, against: Path | None, dialect: str | None, max_blocks: int | None,
    max_branches: int | None, call: str | None, pure: bool,
) -> int:  # fmt: skip
    """Verify a certified step stream, or an execution record.

    PACKAGE is what "gproof compile" wrote: every step is proved again, from the package alone. Or it is the record of
    a run: its signature is checked and, with --package, whether the record fits what was run.

    Exit code: 0 it holds, 1 it does not, 2 UNKNOWN (for example: signed with a key that you do not trust), 3 the
    command could not run.
    """
    from gproof.cli.verify import run_verify
    from gproof.cli.verify_record import is_no_package, run_verify_record
    from gproof.driver.session import Running

    if against is None and (max_blocks, max_branches, call) != (None, None, None):
        raise UsageError("--max-blocks, --max-branches and --call need --against: they say how it was compiled")
    if is_no_package(package):
        if machine is not None or setup is not None or source is not None:
            raise UsageError("--machine, --setup and --source are for packages; use --package to compare a record")
        if against is not None:
            raise UsageError("--against is for packages; use --package to compare a record")
        if form != "text":
            raise UsageError("--format is for packages; the report of a record is always text")
        if pure:
            raise UsageError("--pure is for packages; a record has no steps to prove")
        return run_verify_record(package, package=run_package, trust=trust)
    if run_package is not None:
        raise UsageError(f"--package is for execution records; {package} is not one")
    branches = Running().max_branches if max_branches is None else max_branches
    return run_verify(
        package, machine=machine, setup=setup, source=source, trust=trust, form=form, against=against, dialect=dialect,
        running=Running(max_blocks, branches, call=call), pure=pure,
    )  # fmt: skip


cli.add_command(run)
cli.add_command(status)
cli.add_command(resume)
cli.add_command(boards)


@cli.group(
    cls=Group, no_args_is_help=True, short_help="Manage your signing key and the keys you trust",
    examples=("gproof keys list", "gproof keys trust colleague.pem"),
)  # fmt: skip
def keys() -> None:
    """Manage your signing key and the keys that you trust."""


@keys.command(cls=Command, short_help="Make a private key", examples=("gproof keys new",))
@option(
    "-o", "--output", metavar=FILE, type=FileName(), help="Write the private key to a file; your own key stays as it is"
)
def new(output: Path | None) -> int:
    """Make a private key that only you can read: your own key or, with -o, one in a file."""
    from gproof.cli.keys import run_new

    return run_new(output)


@keys.command(
    name="list", cls=Command, short_help="List the keys: name, fingerprint, trusted or not",
    examples=("gproof keys list",),
)  # fmt: skip
def list_() -> int:
    """List the keys: name, fingerprint, and whether they are trusted."""
    from gproof.cli.keys import run_list

    return run_list()


@keys.command(
    cls=Command, short_help="Print a public key, to give to others",
    examples=("gproof keys show > my-key.pem", "gproof keys show colleague"),
)  # fmt: skip
@click.argument("name", default="own")
def show(name: str) -> int:
    """Print a public key (PEM), to give to others: your own or that of NAME, a key in the list or a key file."""
    from gproof.cli.keys import run_show

    return run_show(name)


@keys.command(
    cls=Command, short_help="Trust what a key signs",
    examples=("gproof keys trust colleague.pem --name colleague --expires 2027-12-31",),
)  # fmt: skip
@click.argument("file", type=FileName())
@option("--name", metavar="NAME", help="Name of the key [default: the file's name]")
@option("--expires", metavar="YYYY-MM-DD", help="Last day (UTC) on which the key is trusted [default: none]")
def trust(file: Path, name: str | None, expires: str | None) -> int:
    """Trust what the owner of a public key signs. FILE is the key (PEM)."""
    from gproof.cli.keys import run_trust

    return run_trust(file, name, expires)


@keys.command(
    cls=Command, short_help="Refuse everything that a key has signed", examples=("gproof keys revoke colleague",)
)
@click.argument("name")
@option("--name", "new_name", metavar="NAME", help="Name for a key that is not in the list [default: the file's name]")
def revoke(name: str, new_name: str | None) -> int:
    """Refuse everything that a key signs or has signed. NAME is a key of "gproof keys list", a public key file, or
    "own" for your own key."""
    from gproof.cli.keys import run_revoke

    return run_revoke(name, new_name)


@cli.command(
    cls=Command, short_help="Format programs and macro files",
    examples=("gproof fmt part.cnc", "gproof fmt --check --diff jobs/", "gproof fmt - < part.cnc > formatted.cnc"),
)  # fmt: skip
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=FileName(allow_dash=True))
@option("--check", "only_check", title=REPORT, is_flag=True, help="Write nothing; exit 1 if a file would change")
@option("--diff", title=REPORT, is_flag=True, help="Write nothing; show the changes")
@option("--stdout", "to_stdout", title=REPORT, is_flag=True, help="Print the formatted text; do not change the file")
@option(
    "--dialect", title=READ, metavar="NAME", type=OneOf(dialects),
    help="Controller of the files: {choices} [default: detected]",
)  # fmt: skip
@option(
    "--machine", title=READ, metavar=FILE, type=FileName(),
    help="Machine file whose settings say how lines are read (WINCNC.INI)",
)  # fmt: skip
@option("--stdin-name", title=READ, metavar=FILE, type=FileName(), help="File name to assume for standard input")
def fmt(
    files: tuple[Path, ...], only_check: bool, diff: bool, to_stdout: bool, dialect: str | None, machine: Path | None,
    stdin_name: Path | None,
) -> int:  # fmt: skip
    """Format programs and macro files in place. "-" reads standard input and prints the result.

    Only the layout changes, never the program: each formatted text is read again and compared before it is written.
    """
    from gproof.cli.fmt import run_fmt

    return run_fmt(
        files, only_check=only_check, diff=diff, to_stdout=to_stdout, dialect=dialect, machine=machine,
        stdin_name=stdin_name,
    )  # fmt: skip


@cli.command(
    cls=Command, short_help="Explain a finding", examples=("gproof explain GP301", "gproof explain soft-limit")
)
@click.argument("code")
@option("--files", is_flag=True, help="Show the machine, setup and other files of the programs too")
def explain(code: str, files: bool) -> int:
    """Explain a finding: what CODE means, why it matters and what to do, with a bad and a good program.

    CODE is the number or the name of a finding.
    """
    from gproof.cli.explain import run_explain

    return run_explain(code, files=files)


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code, never raises for anything a user can cause."""
    # numpy's linear algebra is not used; its threads would only spin on the other cores.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if not standard_streams():
        return COULD_NOT_RUN
    try:
        with ended_by_signals():
            return _run(arguments)
    except OSError:
        # Standard error cannot be written: there is nowhere to say so, and a verdict's code would lie.
        discard(sys.stderr)
        return COULD_NOT_RUN


def _plain(message: str) -> str:
    """click's message in one line, without its names of types and its way to write a range."""
    words = " ".join(message.split())
    words = words.replace("a valid integer range", "a whole number").replace("a valid float range", "a number")
    return re.sub(r"(\S+) is not in the range (\S+)<=x<=(\S+)\.$", _range, words)


def _range(found: re.Match[str]) -> str:
    """What a number must be, and what it is; an end that is there only to have one is not named."""
    value, low, high = (f"{float(text):.12g}" for text in found.groups())
    ends = f"from {low} to {high}"
    if float(high) >= NO_END:
        ends = f"at most {high}" if float(value) > float(high) else f"at least {low}"
    return f"must be {ends}, not {value}."


def _run(arguments: list[str] | None) -> int:
    try:
        whose = PROCESS if arguments is None else None
        result = cli.main(args=arguments, prog_name="gproof", standalone_mode=False, obj=whose)
    except click.UsageError as error:
        if type(error).__name__ == "NoArgsIsHelpError":  # its message is the help
            click.echo(error.format_message(), err=True)
            return COULD_NOT_RUN
        where = error.ctx.command_path if error.ctx else "gproof"
        words = _plain(error.format_message())
        if not isinstance(error, click.BadParameter) or isinstance(error, click.MissingParameter):
            words = f"{words} See {where} --help" if words.endswith("?") else f"{words.rstrip('.')}; see {where} --help"
        click.echo(f"{where}: error: {in_one_line(words)}", err=True)
        return COULD_NOT_RUN
    except UsageError as error:
        tell_error(error)
        return COULD_NOT_RUN
    except click.ClickException as error:
        error.show()
        return error.exit_code if isinstance(error, _Interrupted) else COULD_NOT_RUN
    except (click.Abort, KeyboardInterrupt):
        click.echo("gproof: interrupted", err=True)
        return INTERRUPTED
    except SystemExit:
        # click's answer to a reader that went away (``| head``); its exit code is that of a verdict.
        return COULD_NOT_RUN
    except OSError as error:
        discard(sys.stdout)
        what = f"{error.strerror or error}: {error.filename or ''}".rstrip(": ")
        click.echo(f"gproof: error: {in_one_line(what)}", err=True)
        return COULD_NOT_RUN
    except MemoryError:
        click.echo("gproof: error: not enough memory", err=True)
        return COULD_NOT_RUN
    except Exception as error:
        # A defect of gproof, never of the input: say so, and stay out of the exit codes of verdicts.
        if os.environ.get("GPROOF_TRACEBACK"):
            raise
        what = f"{type(error).__name__}: {error}"
        click.echo(
            f"gproof: internal error: {in_one_line(what)}; please report it (set GPROOF_TRACEBACK=1 for details)",
            err=True,
        )
        return COULD_NOT_RUN
    return result if isinstance(result, int) else 0


if __name__ == "__main__":
    sys.exit(main())
