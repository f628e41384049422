"""``--call``: what the called subprogram can reach counts, in each file; nothing else of the files does."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.campaigns import share
from support.command import Done, in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 50
max_acceleration = 100
[controller]
dialect = "eding"
max_step_frequency = 100000
"""
FAULTS = {
    "GP108": "G53 G0 X",
    "GP107": "#1 = [1 + ]",
    "GP101": "G53 G0 X5 )",
    "GP103": "G53 G0 X5 (open",
    "GP115": "gosub nowhere",
    "GP114": "else",
    "GP122": "G53 G0 X5 then",
    "GP105": "N1234567 G53 G0 X5",
}
"""Lines with a mistake, by the code of its finding."""
GOOD = "G53 G0 X5"


def files(fault: str, place: str) -> str:
    """A file of subprograms with a faulty line in one place."""
    at = {where: fault if where == place else GOOD for where in ("called", "inner", "else", "other", "outside", "m7")}
    return f"""sub called
  {at["called"]}
  gosub inner
  if [#1 == 1]
    {GOOD}
  else
    gosub deep
  endif
endsub
sub inner
  {at["inner"]}
endsub
sub deep
  {at["else"]}
endsub
sub other
  {at["other"]}
endsub
sub m7
  {at["m7"]}
endsub
sub coolant
  M7
endsub
{at["outside"]}
"""


def run(folder: Path, words: list[str]) -> Done:
    (folder / "mill.toml").write_text(MACHINE)
    return in_this_process([*words, "--machine", "mill.toml", "--setup", "zero"], folder)


def codes(done: Done) -> set[str]:
    return {finding["code"] for finding in json.loads(done.out)["findings"]}


@pytest.mark.parametrize("fault", share(list(FAULTS), 3), ids=str)
@pytest.mark.parametrize("place", ["called", "inner", "else", "other", "outside", "m7"])
@pytest.mark.parametrize("file", ["job.cnc", "macro.cnc", "beside"])
def test_mistakes_count_where_the_call_reaches_them(fault: str, place: str, file: str, tmp_path: Path) -> None:
    text = files(FAULTS[fault], place)
    if file == "beside":
        (tmp_path / "macro.cnc").write_text(text)
        (tmp_path / "job.cnc").write_text("G0 X500\nM30\n")
    else:
        (tmp_path / file).write_text(text)
    job = "job.cnc" if file == "beside" else file
    done = run(tmp_path, ["check", job, "--call", "called", "--format", "json"])
    reached = place in ("called", "inner", "else")
    assert done.exit == (1 if reached else 0), done.out
    assert (fault in codes(done)) is reached
    assert ("GP126" in codes(done)) is not reached
    made = run(tmp_path, ["compile", job, "--call", "called", "-o", "out.gpx"])
    assert made.exit == (1 if reached else 0), made.out + made.err
    assert (tmp_path / "out.gpx").exists() is not reached


def test_what_replaces_a_code_is_reached_by_that_code_alone(tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text(files("G53 G0 X", "m7"))
    assert run(tmp_path, ["check", "job.cnc", "--call", "coolant"]).exit == 1
    assert run(tmp_path, ["check", "job.cnc", "--call", "other"]).exit == 0


@pytest.mark.parametrize(("call", "wanted"), [("", 0), ("once", 0), ("twice", 1), ("through", 1)])
@pytest.mark.parametrize("file", ["job.cnc", "macro.cnc"])
def test_two_subprograms_of_a_name_are_a_mistake_where_something_calls_it(
    call: str, wanted: int, file: str, tmp_path: Path
) -> None:
    both = "sub twice\n G53 G0 X5\nendsub\nsub twice\n G53 G0 X500\nendsub\n"
    subs = f"{both}sub once\n G53 G0 X5\nendsub\nsub through\n gosub twice\nendsub\n"
    (tmp_path / "macro.cnc").write_text(subs)
    (tmp_path / "job.cnc").write_text(
        (subs if file == "job.cnc" else "") + f"G53 G0 X5\n{call and f'gosub {call}'}\nM30\n"
    )
    if file == "job.cnc":
        (tmp_path / "macro.cnc").unlink()
    done = run(tmp_path, ["check", "job.cnc", "--format", "json"])
    assert done.exit == wanted, done.out
    assert ("GP116" in codes(done)) is bool(wanted) and ("GP126" in codes(done)) is not bool(wanted)


DEFAULT = Path(__file__).parents[2] / "corpus" / "eding" / "default-macros"


@pytest.mark.parametrize(
    ("call", "wanted"),
    [("user_1", 0), ("user_2", 0), ("user_3", 2), ("user_8", 2), ("user_9", 2), ("home_all", 0), ("change_tool", 0)],
)
def test_buttons_of_a_macro_file(call: str, wanted: int) -> None:
    """Unknown: where a probe finds the work, what the operator types, commands of newer versions; never an error."""
    words = ["check", "macro.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--call", call]
    done = in_this_process([*words, "--format", "json"], DEFAULT)
    assert done.exit == wanted, done.out
    assert not [finding for finding in json.loads(done.out)["findings"] if finding["severity"] == "error"]
