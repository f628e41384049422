"""Outcomes come together where what follows is the same for them, or where one of them may do all that another does."""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD
from support.judging import judged

from gproof.driver.judge import Judgement

MACHINE = (
    'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "eding"\n'
    + "".join(f"[axes.{axis}]\nmin = {low}.0\nmax = 300.0\n" for axis, low in (("x", 0), ("y", 0), ("z", -40)))
)  # fmt: skip

GRID = """#10 = 0
#20 = 0
while [#10 < {rows}]
  #11 = 0
  while [#11 < {columns}]
    #12 = 0
    #13 = 0
    while [[#12 < {tries}] and [#13 == 0]]
      G0 Z-5
      G0 X[#11 * 10] Y[#10 * 10]
      G38.2 Z{deepest} F200
      if [#5067 == 1]
        #13 = 1
        #[1000 + #10 * 10 + #11] = #5063
        #20 = [#20 + 1]
      else
        #12 = [#12 + 1]
      endif
    endwhile
    if [#13 == 0]
      errmsg "no contact"
    endif
    {behind}
    #11 = [#11 + 1]
  endwhile
  #10 = [#10 + 1]
endwhile
G0 Z0
"""
USUAL = {"rows": 4, "columns": 10, "tries": 3, "deepest": -30, "behind": "G0 Z-5"}


def answer(folder: Path, text: str, **options: int) -> Judgement:
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "job.cnc").write_text(f"{HEAD}{text}M30\n")
    return judged(folder / "job.cnc", folder / "machine.toml", "zero", **options)


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        ({}, "SAFE"),
        ({"tries": 5}, "SAFE"),
        # The last point is 10 mm past the limit of X; the probe 1 mm past that of Z.
        ({"columns": 32, "rows": 1}, "UNSAFE"),
        ({"deepest": -41}, "UNSAFE"),
        # Up by 40 from the contact, which may be anywhere: past 0 at a point, not past 300.
        ({"behind": "G91 G0 Z40\nG90"}, "SAFE"),
        # From a contact that may be at -30 it goes to -45.
        ({"behind": "G91 G0 Z-15\nG90"}, "UNKNOWN"),
    ],
)
def test_a_grid_of_probes_with_other_tries(tmp_path: Path, changed: dict[str, object], verdict: str) -> None:
    found = answer(tmp_path, GRID.format(**USUAL | changed))
    assert found.verdict.value == verdict
    assert "GP232" not in {finding.code.label for finding in found.findings.kept}
    # Not three times three times three ...: a few outcomes a point.
    assert found.summary.branches < 600


def test_a_loop_that_goes_on_for_as_long_as_nothing_is_touched(tmp_path: Path) -> None:
    text = "#20 = 0\nwhile [#20 < 120]\nG0 Z-5\nG38.2 Z-30 F200\nif [#5067 == 1]\n#20 = [#20 + 1]\nendif\nendwhile\n"
    assert answer(tmp_path, text).verdict.value == "SAFE"
    deeper = text.replace("G38.2 Z-30", "G38.2 Z[0 - 30 - #20 / 8]")
    assert answer(tmp_path, deeper).verdict.value in ("UNSAFE", "UNKNOWN")


COUNTED = """#20 = 0
#21 = 0
while [#20 < 24]
  G0 Z-5
  G0 X[#20]
  G38.2 Z-30 F200
  if [#5067 == 1]
    #21 = [#21 + 1]
    #22 = #5063
  endif
  #20 = [#20 + 1]
endwhile
if [#21 < 3]
  errmsg "few"
endif
"""


def test_counts_of_contacts_do_not_keep_outcomes_apart(tmp_path: Path) -> None:
    assert answer(tmp_path, COUNTED).verdict.value == "SAFE"
    # As many contacts as points: the last move may go past 300.
    assert answer(tmp_path, f"{COUNTED}G0 X[#21 * 13]\n").verdict.value == "UNKNOWN"


def test_a_contact_on_the_way_to_a_place_of_which_bounds_are_known_has_bounds(tmp_path: Path) -> None:
    text = "#1 = 0\nM56 P3\nif [#5399 == 1]\n#1 = 5\nendif\n" * 1
    text += "G38.2 Z-20 F100\nG38.2 Z[0 - 25 - #1] F100\nG91 G0 Z{}\nG90 G0 Z0\n"
    assert answer(tmp_path, text.format(-5)).verdict.value == "SAFE"
    assert answer(tmp_path, text.format(-15)).verdict.value == "UNKNOWN"


def test_what_outcomes_do_to_places_stays_apart_while_there_are_few(tmp_path: Path) -> None:
    text = "M56 P3\nif [#5399 == 1]\nG0 X100\nelse\nG0 X200\nendif\nG91 G0 X{}\n"
    assert answer(tmp_path, text.format(100)).verdict.value == "SAFE"
    assert answer(tmp_path, text.format(101)).verdict.value == "UNSAFE"
