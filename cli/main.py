"""The command ``gproof``: arguments in, exit code out. Everything heavy is imported by the command that needs it.

Exit codes: 0 SAFE (or done), 1 UNSAFE, 2 UNKNOWN, 3 the command itself could not run, 130 interrupted (Ctrl-C,
SIGTERM, SIGHUP).
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import sys
from functools import partial
from pathlib import Path
from typing import Any

import click

from gproof.cli.options import ALSO, FileName, OneOf, boards, dialects, documents, once
from gproof.cli.signals import INTERRUPTED, PROCESS, ended_by_signals
from gproof.cli.telling import tell_error
from gproof.driver.errors import COULD_NOT_RUN, UsageError
from gproof.driver.escape import in_one_line

_STDERR = 2
MOST = 10**15
"""Of what is counted: whatever is larger says nothing else."""


class _Interrupted(click.ClickException):
    """Ctrl-C, before click says something of its own."""

    exit_code = INTERRUPTED

    def show(self, file: Any = None) -> None:
        """Print the line, on a terminal not behind its ``^C``."""
        click.echo("\n" * sys.stderr.isatty() + self.message, err=True)


class _Commands(click.Group):
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


class _Finite(click.FloatRange):
    """A range of numbers, NaN and infinity not among them; a thousand million at most where none is named."""

    def __init__(self, low: float, high: float = 1e9) -> None:
        super().__init__(low, high)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number; a usage error for what is none."""
        with contextlib.suppress(TypeError, ValueError):
            if not math.isfinite(float(value)):
                self.fail(f"{value!r} is not a finite number.", param, ctx)
        return float(super().convert(value, param, ctx))


def _version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if not wanted or context.resilient_parsing:
        return
    from importlib.metadata import version

    click.echo(f"gproof {version('gproof')}")
    context.exit()


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]}, no_args_is_help=True)
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Show the version.")
def cli() -> None:
    """Check G-code before a machine sees it, compile it to certified steps, and run those on a board."""


_JOB = click.argument("job", type=FileName())


def _job_options(command: Any, *, machines: bool = False) -> Any:
    """The options of every command that reads a job; machines: of one that takes several of them."""
    said = "Machine file (TOML or the controller's)" + ("; repeatable." if machines else ".")
    several = click.option("--machine", type=FileName(), multiple=True, help=said)
    for option in reversed(
        (
            several if machines else once("--machine", type=FileName(), help=said),
            once("--setup", help="Setup file, or 'zero': homed, at machine 0, no offsets, tool 0."),
            click.option("--dialect", type=OneOf(dialects), help="Language; guessed when not given."),
            click.option(
                "--max-blocks",
                type=click.IntRange(1, MOST),
                help="Blocks to execute at most; 5 million and 4 a line by default.",
            ),
            click.option(
                "--max-branches",
                type=click.IntRange(0, MOST),
                default=4096,
                help="Outcomes of unknown conditions to follow at most; 4096 by default.",
            ),
            click.option("--call", help="Judge a subprogram of JOB, such as user_1, as its button runs it."),
            click.option("--render", is_flag=True, help="As the controller draws it: probes miss, dialogs say OK."),
        )
    ):
        command = option(command)
    return command


@cli.command()
@click.argument("jobs", metavar="JOB...", nargs=-1, required=True)
@_job_options
@click.option(
    "--format",
    "form",
    type=OneOf(documents),
    default="text",
    help="Report as text, or for other programs.",
)
@click.option("--output", type=FileName(), help="Write the report to this file.")
@click.option("--report", "reports", multiple=True, metavar="FORM=FILE", help="Write one more report; repeatable.")
@click.option("-q", "--quiet", is_flag=True, help="Only the verdicts.")
@click.option("--no-group", "--all", "every", is_flag=True, help="Show repeats of a finding one by one.")
@click.option(
    "-j", "--jobs", "workers", type=click.IntRange(1, 1024), help="Jobs judged at once; by default what pays."
)
@ALSO
@once("--policy", type=FileName(), help="What the shop asks of its jobs (TOML).")
@click.option(
    "--fail-on", type=click.Choice(["unknown", "warning", "note"]), help="Findings that fail a check; unknown else."
)
@click.option("--warnings-as-errors", "warnings_are_errors", is_flag=True, help="Warnings make a job UNSAFE.")
@once("--baseline", type=FileName(), help="Findings that are known and fail no check.")
@click.option("--write-baseline", "new_baseline", type=FileName(), help="Write what is found as known.")
@click.option("--exclude", multiple=True, metavar="PATTERN", help="Jobs to leave out of folders and patterns.")
@click.option("--strict", is_flag=True, help="Conditional answers count as UNKNOWN.")
@click.option("--picture", type=FileName(), help="Write a picture of the path (SVG).")
@click.option(
    "--units",
    type=click.Choice(["mm", "inch"]),
    help="Lengths in reports for people; those of the machine file else.",
)
def check(
    jobs: tuple[str, ...], machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, form: str, strict: bool, picture: Path | None,
    units: str | None, output: Path | None, quiet: bool, workers: int | None, exclude: tuple[str, ...],
    policy: Path | None, fail_on: str | None, warnings_are_errors: bool, baseline: Path | None,
    new_baseline: Path | None, also: tuple[str, ...], reports: tuple[str, ...], every: bool,
) -> int:  # fmt: skip
    """Prove or refute that each JOB is safe on a machine.

    A JOB is a program, a folder of them, a pattern such as "*.cnc", or a job file, which says what to judge with.
    """
    from gproof.cli.check import run_check
    from gproof.driver.session import Running

    return run_check(
        jobs, machine=machine, setup=setup, dialect=dialect, running=Running(max_blocks, max_branches, render, call),
        form=form, strict=strict, picture=picture, units=units, output=output, quiet=quiet, workers=workers,
        exclude=exclude, policy=policy, fail_on=fail_on, warnings_are_errors=warnings_are_errors, baseline=baseline,
        new_baseline=new_baseline, also=also, reports=reports, every=every,
    )  # fmt: skip


@cli.command(short_help="Say where the work zero may go.")
@_JOB
@partial(_job_options, machines=True)
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", help="Report as text or JSON.")
@click.option(
    "--units",
    type=click.Choice(["mm", "inch"]),
    help="Lengths in reports for people; those of the machine file else.",
)
@click.option("--picture", type=FileName(), help="Write a picture of where the zero may go (SVG).")
def fit(
    job: Path, machine: tuple[Path, ...], setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, form: str, units: str | None, picture: Path | None,
) -> int:  # fmt: skip
    """Say for which work offsets JOB is SAFE, what to change now, and how large a machine it needs.

    With several machines: which of them take it.

    Exit codes: 0 SAFE with the offsets stated, or, where none are, with some; 1 UNSAFE; 2 UNKNOWN.
    """
    from gproof.cli.fit import run_fit
    from gproof.driver.session import Running

    return run_fit(
        job, machines=machine, setup=setup, dialect=dialect, running=Running(max_blocks, max_branches, render, call),
        form=form, units=units, picture=picture,
    )  # fmt: skip


@cli.command()
@_JOB
@_job_options
@click.option(
    "--stage", type=click.Choice(["program", "trace", "plan", "stream"]), required=True, help="What to print."
)
@click.option("--format", "form", type=click.Choice(["text", "jsonl"]), default="text", help="jsonl: trace only.")
def dump(
    job: Path,
    machine: Path | None,
    setup: str | None,
    dialect: str | None,
    max_blocks: int | None,
    max_branches: int,
    call: str | None,
    render: bool,
    stage: str,
    form: str,
) -> int:
    """Print JOB as one of the compiler's stages."""
    from gproof.cli.dump import run_dump
    from gproof.driver.session import Running

    return run_dump(
        job,
        machine=machine,
        setup=setup,
        dialect=dialect,
        running=Running(max_blocks, max_branches, render, call),
        stage=stage,
        form=form,
    )


@cli.command(name="compile")
@_JOB
@_job_options
@click.option("-o", "--output", type=FileName(), required=True, help="The .gpx file to write.")
@click.option("--key", type=FileName(), help="Ed25519 private key (PEM) to sign with.")
@click.option("--unsigned", is_flag=True, help="Write the certificate without a signature.")
@ALSO
def compile_(
    job: Path, machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, output: Path, key: Path | None, unsigned: bool,
    also: tuple[str, ...],
) -> int:  # fmt: skip
    """Compile JOB to a certified step stream."""
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


def _package_options(command: Any) -> Any:
    """The options of every command that believes, or does not believe, a package."""
    for option in reversed(
        (
            once("--machine", type=FileName(), help="Also require that it was made for this machine."),
            once("--setup", help="Also require that it was made for this setup: a file, or 'zero'."),
            once("--source", type=FileName(), help="Also require that it was made of this program."),
            click.option("--trust", type=FileName(), multiple=True, help="Public key (PEM) to accept; repeatable."),
        )
    ):
        command = option(command)
    return command


@cli.command(short_help="Validate a certified stream, or check a record.")
@click.argument("package", type=FileName())
@_package_options
@click.option("--package", "run_package", type=FileName(), help="Of an execution record: the package that was run.")
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", help="Report as text or JSON.")
@once("--against", type=FileName(), help="Compile this program anew, and say which part of the package differs.")
@click.option("--dialect", type=OneOf(dialects), help="Language of --against; guessed when not given.")
@click.option("--max-blocks", type=click.IntRange(1, MOST), help="As --against was compiled.")
@click.option("--max-branches", type=click.IntRange(0, MOST), help="As --against was compiled.")
@click.option("--call", help="The subprogram of --against that was compiled.")
@click.option("--pure", is_flag=True, help="Prove the steps without compiled code and numba: slow, less to trust.")
def verify(
    package: Path, machine: Path | None, setup: str | None, source: Path | None, trust: tuple[Path, ...],
    run_package: Path | None, form: str, against: Path | None, dialect: str | None, max_blocks: int | None,
    max_branches: int | None, call: str | None, pure: bool,
) -> int:  # fmt: skip
    """Validate a certified stream again, from its parts alone; or check an execution record."""
    from gproof.cli.verify import run_verify
    from gproof.cli.verify_record import is_no_package, run_verify_record
    from gproof.driver.session import Running

    if against is None and (max_blocks, max_branches, call) != (None, None, None):
        raise UsageError("--max-blocks, --max-branches and --call say how the program of --against was compiled")
    if is_no_package(package):
        if machine is not None or setup is not None or source is not None:
            raise UsageError("--machine, --setup and --source are for packages; a record is compared with --package")
        if against is not None:
            raise UsageError("--against is for packages; a record is compared with --package")
        if form != "text":
            raise UsageError("--format is for packages; the report of a record is text")
        if pure:
            raise UsageError("--pure is for packages; a record has no steps to prove")
        return run_verify_record(package, package=run_package, trust=trust)
    if run_package is not None:
        raise UsageError("--package says which package a record is of; this is no record")
    branches = Running().max_branches if max_branches is None else max_branches
    return run_verify(
        package, machine=machine, setup=setup, source=source, trust=trust, form=form, against=against, dialect=dialect,
        running=Running(max_blocks, branches, call=call), pure=pure,
    )  # fmt: skip


@cli.command(short_help="Run a certified stream on a board.")
@click.argument("package", type=FileName())
@click.option("--board", type=OneOf(boards), required=True, help="Where to run it.")
@_package_options
@click.option("--allow-untrusted", is_flag=True, help="Whoever has signed it, or nobody; virtual board only.")
@click.option("--record", type=FileName(), help="Write the execution record (JSON) here.")
@click.option("--replace-record", is_flag=True, help="Replace a record that is there from an earlier run.")
@click.option("--runs", type=FileName(), help="Folder for journals and records; the user's own by default.")
@click.option(
    "--after-interruption", is_flag=True, help="Run although the last run did not end: the position has been checked."
)
@click.option("--real-time", is_flag=True, help="As slow as the real machine.")
@click.option("--hold-at", type=_Finite(0), help="Feed hold at this second of the first section.")
@click.option("--estop-at", type=_Finite(0), help="Emergency stop at this second.")
@click.option("--override", type=_Finite(0.1, 1.0), help="Feed override; 1 is 100 %.")
@click.option("--ask", is_flag=True, help="Ask at operator stops; a virtual board goes on by itself otherwise.")
def run(
    package: Path, board: str, machine: Path | None, setup: str | None, source: Path | None, trust: tuple[Path, ...],
    allow_untrusted: bool, record: Path | None, real_time: bool, hold_at: float | None, estop_at: float | None,
    override: float | None, ask: bool, replace_record: bool, runs: Path | None, after_interruption: bool,
) -> int:  # fmt: skip
    """Run a certified stream on a board; it is validated again before anything moves.

    It runs when a trusted key has signed it: your own, one of --trust, one of "gproof keys trust".
    """
    from gproof.cli.run import run_run
    from gproof.cli.run_journal import alone

    with alone(runs, board):
        return run_run(
            package, board=board, record=record, real_time=real_time, hold_at=hold_at, estop_at=estop_at,
            override=override, ask=ask, replace_record=replace_record, runs=runs, after_interruption=after_interruption,
            trust=trust, machine=machine, setup=setup, source=source, allow_untrusted=allow_untrusted,
        )  # fmt: skip


@cli.group(no_args_is_help=True)
def keys() -> None:
    """Your signing key, and whose signatures are believed."""


@keys.command()
@click.option("-o", "--output", type=FileName(), help="Write the private key here; it is not made your own.")
def new(output: Path | None) -> int:
    """Make a private key, readable by you alone; your own one, unless -o names a file."""
    from gproof.cli.keys import run_new

    return run_new(output)


@keys.command(name="list")
def list_() -> int:
    """Name all keys, with fingerprints and what they are worth."""
    from gproof.cli.keys import run_list

    return run_list()


@keys.command()
@click.argument("name", default="own")
def show(name: str) -> int:
    """Print the public key NAME (PEM), to be given away: your own when none is named, or that of a key file."""
    from gproof.cli.keys import run_show

    return run_show(name)


@keys.command()
@click.argument("file", type=FileName())
@click.option("--name", help="What to call it; the name of the file else.")
@click.option("--expires", metavar="YYYY-MM-DD", help="The last day (UTC) on which it counts.")
def trust(file: Path, name: str | None, expires: str | None) -> int:
    """Believe what the owner of a public key (PEM) signs."""
    from gproof.cli.keys import run_trust

    return run_trust(file, name, expires)


@keys.command()
@click.argument("name")
@click.option("--name", "new_name", help="What to call a key that is not known yet; the name of the file else.")
def revoke(name: str, new_name: str | None) -> int:
    """Refuse what a key signed and signs: one of "gproof keys list", a public key file, or "own"."""
    from gproof.cli.keys import run_revoke

    return run_revoke(name, new_name)


@cli.command(short_help="Format programs and macro files.")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=FileName(allow_dash=True))
@click.option("--check", "only_check", is_flag=True, help="Write nothing; exit 1 when a file would change.")
@click.option("--diff", is_flag=True, help="Write nothing; show what would change.")
@click.option("--stdout", "to_stdout", is_flag=True, help="Print the formatted text; the file stays as it is.")
@click.option("--dialect", type=OneOf(dialects), help="Language; guessed when not given.")
@click.option("--machine", type=FileName(), help="Whose settings say how lines are read (WINCNC.INI).")
@click.option("--stdin-name", type=FileName(), help="The file that standard input stands for.")
def fmt(
    files: tuple[Path, ...], only_check: bool, diff: bool, to_stdout: bool, dialect: str | None, machine: Path | None,
    stdin_name: Path | None,
) -> int:  # fmt: skip
    """Format programs and macro files in place; - reads standard input and prints.

    Only the form changes, never the program: every formatted text is read again and compared before it is written.
    """
    from gproof.cli.fmt import run_fmt

    return run_fmt(
        files, only_check=only_check, diff=diff, to_stdout=to_stdout, dialect=dialect, machine=machine,
        stdin_name=stdin_name,
    )  # fmt: skip


@cli.command()
@click.argument("code")
@click.option("--files", is_flag=True, help="Show the machine, setup and other files of the programs too.")
def explain(code: str, files: bool) -> int:
    """Explain a finding, such as GP301, with a bad and a good program."""
    from gproof.cli.explain import run_explain

    return run_explain(code, files=files)


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code, never raises for anything a user can cause."""
    # numpy's linear algebra is not used; its threads would only spin on the other cores.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if not _standard_streams():
        return COULD_NOT_RUN
    try:
        with ended_by_signals():
            return _run(arguments)
    except OSError:
        # Standard error can not be written: there is nowhere to say so, and a verdict's code would lie.
        _discard(sys.stderr)
        return COULD_NOT_RUN


def _plain(message: str) -> str:
    """click's message in one line, without its names of types."""
    words = " ".join(message.split())
    return words.replace("a valid integer range", "a whole number").replace("a valid float range", "a number")


def _run(arguments: list[str] | None) -> int:
    try:
        whose = PROCESS if arguments is None else None
        result = cli.main(args=arguments, prog_name="gproof", standalone_mode=False, obj=whose)
    except click.UsageError as error:
        if type(error).__name__ == "NoArgsIsHelpError":  # its message is the help
            click.echo(error.format_message(), err=True)
            return COULD_NOT_RUN
        where = error.ctx.command_path if error.ctx else "gproof"
        click.echo(f"{where}: error: {in_one_line(_plain(error.format_message()))}", err=True)
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
        _discard(sys.stdout)
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
            f"gproof: internal error: {in_one_line(what)}; please report it (GPROOF_TRACEBACK=1 shows more)", err=True
        )
        return COULD_NOT_RUN
    return result if isinstance(result, int) else 0


def _standard_streams() -> bool:
    """Make the streams fit for use; False, with a line on standard error, when nothing can be printed."""
    handle = os.open(os.devnull, os.O_RDWR)
    while handle <= _STDERR:  # The number of a closed stream must not become that of a job or a package.
        handle = os.open(os.devnull, os.O_RDWR)
    os.close(handle)
    if sys.stderr is None:
        sys.stderr = os.fdopen(_STDERR, "w", encoding="utf-8", closefd=False)
    if sys.stdout is None:
        click.echo("gproof: error: standard output is closed", err=True)
        return False
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # File names may hold bytes that are no text, and messages what the terminal can not show.
            stream.reconfigure(errors="backslashreplace")
    return True


def _discard(stream: Any) -> None:
    """What a stream still holds and could not write is given up, or the interpreter tries again when it ends."""
    if isinstance(stream, io.TextIOWrapper):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
            return
        with contextlib.suppress(OSError, ValueError):
            handle = os.open(os.devnull, os.O_WRONLY)
            os.dup2(handle, stream.fileno())
            os.close(handle)


if __name__ == "__main__":
    sys.exit(main())
