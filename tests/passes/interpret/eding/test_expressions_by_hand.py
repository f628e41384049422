"""Values of expressions, each worked on paper from the Eding CNC manual: 3.2.2.2 to 3.2.2.4, parameter setting, 4.2.

What the manual gives no one value is marked so: two readings (precedence of comparisons, bits and shifts, a sign before
a power, MOD of negatives, ROUND of halves), a comparison that rounding decides, and what has no value.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from passes.interpret.core.programs import run

from gproof.ir.trace import Op

SETTINGS = "#1 = 5\n#2 = 3\n#3 = 4\n#4 = -7\n#5 = 0.5\n"
KNOWN = {
    # groups: power, then * / mod, then + - and or xor; within a group the left one first
    "2.0 / 3 * 1.5 - 5.5 / 11.0": 0.5, "1 + 2 * 3": 7, "2 ** 3 ** 2": 64, "2 * 3 ** 2": 18, "10 - 4 - 3": 3,
    "24 / 4 / 2": 3, "7 mod 4": 3, "10 + 7 mod 4": 13, "2 * 7 mod 4": 2, "8 / 2 ** 2": 2, "10 / 4 * 2": 5,
    "7.5 mod 2": 1.5, "2 ** [0 - 1]": 0.5, "[2 + 3] * 4": 20, "5 - -3": 8, "3 * -2": -6, "fix[7/2] * 2": 6,
    # logic on any numbers, in the group of + and -
    "1 or 0": 1, "5 and 0": 0, "5 and 2": 1, "5 xor 2": 0, "0 xor 2": 1, "0 or 0": 0, "0.5 and 0.1": 1,
    "1 + 1 and 0": 0, "0 and 1 + 5": 5, "2 - 1 or 0": 1, "not[3] + 4": 4, "not[0]": 1,
    # parameters: # before all operations
    "#1 + 2": 7, "#[1 + 2]": 4, "##2": 4, "#[#2 - 2]": 5, "-#1": -5, "-#1 + 8": 3, "#1 - -#2": 8, "[-#1] ** 2": 25,
    # unary operations; degrees
    "abs[-3]": 3, "abs[-2] ** 2": 4, "fix[2.8]": 2, "fix[-2.8]": -3, "fup[2.8]": 3, "fup[-2.8]": -2,
    "round[2.4]": 2, "round[2.6]": 3, "round[-2.6]": -3, "int[3.7]": 3, "sqrt[16]": 4, "sqrt[#3] + 1": 3,
    "sin[30]": 0.5, "cos[60]": 0.5, "tan[45]": 1, "asin[0.5]": 30, "acos[0.5]": 60, "atan[1]/[1]": 45,
    "atan[1]/[-1]": 135, "atan[-1]/[-1]": -135, "atan[3]/[3] * 2": 90, "exp[0]": 1, "ln[1]": 0, "ln[exp[2]]": 2,
    "1 + acos[0] - [#2 ** [4.0/2]]": 82, "2 * sin[90] ** 2": 2,
    # comparisons in brackets
    "[#1 > 4] * 10": 10, "[#1 < 4] * 10": 0, "[#1 == 5] + [#2 <> 3]": 1, "10 * [[#1 >= 5] and [#2 <= 3]]": 10,
}  # fmt: skip
OPEN = (
    "-#1 ** 2", "#1 == 5 and 2", "10 - 1 > 7", "1 << 1 + 1", "6 band 3 == 2", "#4 mod 4", "7 mod [0 - 4]",
    "round[2.5]", "round[-0.5]", "[0.1 * 3] == 0.3", "#1 == 1 or #2 == 3",
)  # fmt: skip
NONE = ("1 / 0", "#1 / [#1 - 5]", "3 mod 0", "sqrt[-1]", "ln[0]", "acos[2]", "asin[-1.5]", "[-8] ** [1/3]")


def places(folder: Path, expressions: list[str]) -> dict[str, float | None]:
    """Where X goes for each, None where nothing says so."""
    lines = "".join(f"G53 G0 X0\nG53 G0 X[{one}]\n" for one in expressions)
    trace, _ = run(folder, f"{SETTINGS}{lines}M30\n")
    first = 2 + SETTINGS.count("\n") + 1
    found: dict[str, float | None] = dict.fromkeys(expressions)
    for section in trace.sections:
        for n in range(len(section.rows)):
            at, odd = divmod(int(section.rows["line"][n]) - first, 2)
            if section.rows["op"][n] == Op.TRAVERSE and not odd and 0 <= at < len(expressions):
                known = not trace.frames[int(section.rows["frame"][n])][0]
                found[expressions[at]] = float(section.rows["to"][n][0]) if known else None
    return found


def test_what_the_manual_gives_one_value_has_it(tmp_path: Path) -> None:
    found = places(tmp_path, list(KNOWN))
    wrong = {one: (found[one], value) for one, value in KNOWN.items() if not _near(found[one], value)}
    # A move to where X is makes a row too.
    assert not wrong


def _near(found: float | None, value: float) -> bool:
    return found is not None and math.isclose(found, value, rel_tol=1e-12, abs_tol=1e-12)


@pytest.mark.parametrize("expression", [*OPEN, *NONE])
def test_what_it_leaves_open_or_without_a_value_has_none(tmp_path: Path, expression: str) -> None:
    assert places(tmp_path, [expression])[expression] is None


def test_a_setting_counts_from_the_next_line_on(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, f"{SETTINGS}#3 = 6 G1 X#3 F100\nG1 X#3\nM30\n")
    feeds = [
        float(s.rows["to"][n][0]) for s in trace.sections for n in range(len(s.rows)) if s.rows["op"][n] == Op.FEED
    ]
    assert feeds == [4.0, 6.0]
