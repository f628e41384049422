"""``[inputs]`` of a setup is what M56 reads (Eding 3.5.9): the channel stays as stated for the whole job."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command import in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
[controller]
dialect = "eding"
"""
JOB = "G21 G90\nM56 {words}\nif [#5399 == {value}]\nG53 G0 X5\nelse\nG53 G0 X500\nendif\nM30\n"


@pytest.mark.parametrize(
    ("words", "stated", "value", "wanted"),
    [
        ("P3", "3 = 1", 1, 0),
        ("P3", "3 = 0", 0, 0),
        ("P3", "3 = 0", 1, 1),
        ("P3", "3 = 1", 0, 1),
        ("P3 L0", "3 = 1", 1, 0),
        ("P51", "51 = 1", 1, 0),
        ("P3 L2 Q30", "3 = 0", 0, 0),
        ("P3 L2 Q30", "3 = 1", 1, 0),  # it times out: 1
        ("P3 L1 Q30", "3 = 1", 1, 1),  # the state, 1, or "not timed out", 0
        ("P3 L1 Q30", "3 = 0", 1, 1),
        ("P4", "3 = 1", 1, 1),  # another channel
        ("E3", "3 = 1", 1, 1),  # an analogue one
        ("P3", "", 1, 1),
    ],
)
def test_m56_reads_what_the_setup_states(words: str, stated: str, value: int, wanted: int, tmp_path: Path) -> None:
    (tmp_path / "mill.toml").write_text(MACHINE)
    (tmp_path / "job.cnc").write_text(JOB.format(words=words, value=value))
    (tmp_path / "setup.toml").write_text(
        f'schema = "gproof-setup/1"\nunits = "mm"\nhomed = ["x"]\nstart = {{x = 1}}\n[inputs]\n{stated}\n'
    )
    done = in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "setup.toml"], tmp_path)
    assert done.exit == wanted, done.out
