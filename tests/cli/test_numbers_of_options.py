"""Every numeric option of every command: what is no number in its range is one line and exit code 3."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from verify.package_files import write

from gproof.cli.main import cli, main

FOREIGN = (
    "nan", "-nan", "inf", "-inf", "Infinity", "1e308", "1e400", "-1e308", "-1", "1e-300", "x", "", " ", "0x10", "1_0",
    "9" * 400, "9" * 5000, "-" + "9" * 400, "1e", "\u0661\u0662", "1;2", "1/0",
)  # fmt: skip
REAL = ("1e-300", "1_0", "\u0661\u0662")
"""Numbers as Python reads them, in range for a time."""


def numeric() -> Iterator[tuple[str, str]]:
    for name, command in cli.commands.items():
        for option in command.params:
            if isinstance(option.type, click.types.FloatParamType | click.types.IntParamType):
                yield name, option.opts[-1]


def test_there_are_such_options() -> None:
    assert {("run", "--hold-at"), ("run", "--estop-at"), ("run", "--override"), ("check", "--max-blocks")} <= {
        *numeric()
    }


@pytest.mark.parametrize(("command", "option"), [*numeric()])
def test_what_is_no_number_in_range(
    command: str, option: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    job = tmp_path / "job.cnc"
    job.write_text("G21 G90\nM30\n")
    package = write(tmp_path / "job.gpx", name="square")
    needed = {
        "run": [package, "--board", "virtual", "--runs", tmp_path / "runs"], "dump": [job, "--stage", "trace"],
        "compile": [job, "-o", tmp_path / "out.gpx"], "verify": [package],
    }  # fmt: skip
    for text in FOREIGN:
        words = [command, *needed.get(command, [job]), f"{option}={text}"]
        code = main([str(word) for word in words])
        said = capfd.readouterr().err
        if code != 3:
            assert text in REAL, words
            continue
        assert len(said.splitlines()) == 1 and "error" in said, words
        assert len(said) < 6_000
        if text == "1e308":
            assert "at least" not in said, words


@pytest.mark.parametrize("option", ["--hold-at", "--estop-at"])
def test_times_far_beyond_the_job_are_no_crash(option: str, tmp_path: Path) -> None:
    package = write(tmp_path / "job.gpx", name="square")
    words = ["run", str(package), "--board", "virtual", "--runs", str(tmp_path / "runs"), option, "1e9"]
    assert main(words) in (0, 1, 2)
