"""Where the manual allows two readings and gproof says so: a job of which one leaves the limits is never SAFE.

Each program has two readings by hand; in one of them X goes to 10, in the other to 500, beyond its limit of 100. Turned
round (``FAR`` and ``NEAR`` exchanged) the answer must not be SAFE either: no reading may decide alone.
"""

from __future__ import annotations

import itertools
import random
from pathlib import Path

import pytest
from support.command import in_this_process

from gproof.frontend.eding.parse import parse_line
from gproof.ir.dialects.eding.operators import groupings
from gproof.ir.finding import Findings
from gproof.ir.program import Block
from gproof.ir.symbolic import bounds
from gproof.passes.interpret.core.expressions import Evaluator

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -100
max = 100
steps_per_unit = 100
max_velocity = 50
max_acceleration = 100
[controller]
dialect = "eding"
max_step_frequency = 100000
"""
CONDITIONS = (
    # settings, condition, finding: true in one reading, false in another
    ("#1 = 4", "#1 == 4 and 2", "GP230"),  # (4 == 4) and 2; 4 == (4 and 2), that is 4 == 1
    ("#1 = 2\n#2 = 1", "#1 == 1 or #2 == 1", "GP230"),
    ("#1 = 5", "10 - #1 > 7", "GP230"),  # 5 > 7; 10 - (5 > 7)
    ("#1 = 2", "#1 + 1 < 2", "GP230"),  # 3 < 2; 2 + (1 < 2)
    ("#1 = 6", "#1 band 3 == 2", "GP230"),  # (6 band 3) == 2; 6 band (3 == 2)
    ("#1 = 1", "#1 << 1 + 1 == 3", "GP230"),  # (1 << 1) + 1 = 3; 1 << 2 = 4
    ("#1 = 3", "#1 bor 4 and 0", "GP230"),  # (3 bor 4) and 0; 3 bor (4 and 0)
    ("#1 = 5", "1 < #1 < 2", ""),  # one group, left first (3.2.2.3): (1 < 5) < 2 is true
    ("#1 = [0.1 * 3]", "#1 == 0.3", "GP231"),
    ("#1 = [0.1 + 0.2]", "#1 <> 0.3", "GP231"),
    ("#1 = [1 / 3]", "#1 == [1 / 3]", "GP231"),
    ("#1 = 2.00005", "#1 == 2", "GP231"),
    ("#1 = -7", "[#1 mod 3] == 2", ""),  # -1 or 2
    ("#1 = -7.5", "[#1 mod 2] < 0", ""),
    ("#1 = 2.5", "round[#1] == 3", ""),
    ("#1 = -2.5", "round[#1] == -2", ""),
    ("#1 = 3", "-#1 ** 2 > 0", "GP230"),  # 9 or -9
    ("#1 = 7", "-#1 mod 4 > 0", "GP230"),  # (-7) mod 4 = 1 or -3; -(7 mod 4) = -3
)
WORDS = (
    # settings, an expression whose readings are 10 and beyond 100, or the reverse
    ("#1 = 11", "[130 - #1 ** 2]", ""),  # 9: no doubt, the power is first
    ("#1 = 9", "[91 + -#1 ** 2]", "GP230"),  # 172 or 10
    ("#1 = 9", "[-71 + -#1 ** 2]", "GP230"),  # 10 or -152
    ("#1 = 5", "[500 * #1 == 5 - 1]", "GP230"),
    ("#1 = -990", "[#1 mod 1000]", ""),  # -990 or 10
    ("#1 = 0.5", "[10 + 400 * round[#1]]", ""),
    ("#1 = [0.1 * 3]", "[10 + 400 * [#1 == 0.3]]", "GP231"),
    ("#1 = 1", "[#1 << 9 - 5]", "GP230"),  # 16 or 507
)


def check(folder: Path, text: str, *words: str, command: str = "check", more: str = "") -> tuple[int, str]:
    (folder / "mill.toml").write_text(MACHINE + more)
    (folder / "job.cnc").write_text(text)
    extra = ["-o", "out.gpx"] if command == "compile" else []
    done = in_this_process([command, "job.cnc", "--machine", "mill.toml", "--setup", "zero", *extra, *words], folder)
    return done.exit, done.out


@pytest.mark.parametrize(("settings", "condition", "code"), CONDITIONS)
def test_a_condition_of_two_readings_is_followed_both_ways(
    settings: str, condition: str, code: str, tmp_path: Path
) -> None:
    sure = condition == "1 < #1 < 2"
    for one, other in ((10, 500), (500, 10)):
        text = f"G21 G90\n{settings}\nif [{condition}]\nG53 G0 X{one}\nelse\nG53 G0 X{other}\nendif\nM30\n"
        exit_code, out = check(tmp_path, text)
        assert (exit_code == 0) is (sure and one == 10), out
        assert code in out
        made, _ = check(tmp_path, text, command="compile")
        assert (made == 0) is (exit_code == 0) and (tmp_path / "out.gpx").exists() is (made == 0)
        (tmp_path / "out.gpx").unlink(missing_ok=True)
    # Where both readings stay inside, both are followed and the job is SAFE.
    text = f"G21 G90\n{settings}\nif [{condition}]\nG53 G0 X10\nelse\nG53 G0 X20\nendif\nM30\n"
    assert check(tmp_path, text)[0] == 0


@pytest.mark.parametrize(("settings", "word", "code"), WORDS)
def test_a_word_of_two_readings_is_never_one_of_them(settings: str, word: str, code: str, tmp_path: Path) -> None:
    exit_code, out = check(tmp_path, f"G21 G90\n{settings}\nG53 G0 X{word}\nM30\n")
    assert (exit_code == 0) is (word == "[130 - #1 ** 2]"), out
    assert code in out
    exit_code, _ = check(tmp_path, f"G21 G90\n{settings}\n#9 = {word}\nG53 G0 X[#9 + 0]\nM30\n")
    assert (exit_code == 0) is (word == "[130 - #1 ** 2]")


@pytest.mark.parametrize(
    ("settings", "condition", "wanted"),
    [
        ("#1 = 4", "#1 == 4 and 2", True),
        ("#1 = 2\n#2 = 1", "#1 == 1 or #2 == 1", True),
        ("#1 = 5", "10 - #1 > 7", False),
        ("#1 = 2", "#1 * 2 + 1 < 5", False),
    ],
)
def test_a_shop_that_knows_the_precedence_says_so(settings: str, condition: str, wanted: bool, tmp_path: Path) -> None:
    near, far = (10, 500) if wanted else (500, 10)
    text = f"G21 G90\n{settings}\nif [{condition}]\nG53 G0 X{near}\nelse\nG53 G0 X{far}\nendif\nM30\n"
    exit_code, out = check(tmp_path, text)
    assert exit_code != 0 and 'accepts = ["usual-precedence"]' in out
    exit_code, out = check(tmp_path, text, more='accepts = ["usual-precedence"]\n')
    assert exit_code == 0 and "usual-precedence" in out, out


@pytest.mark.parametrize(
    "condition",
    ["#1 == 0.5", "#1 * 2 == 1", "[#1 == 0.5] and [2 > 1]", "#1 <> 0.7", "[7 mod 3] == 1", "round[0.4] == 0"],
)
def test_what_every_reading_takes_alike_is_decided(condition: str, tmp_path: Path) -> None:
    text = f"G21 G90\n#1 = 0.5\nif [{condition}]\nG53 G0 X10\nelse\nG53 G0 X500\nendif\nM30\n"
    alike = condition != "#1 * 2 == 1"  # 0.5 * (2 == 1) is 0
    assert (check(tmp_path, text)[0] == 0) is alike


def all_trees(operators: tuple[str, ...], begin: int, end: int) -> list[object]:
    """Every binary tree over the values begin to end; stated groups (3.2.2.3) hold between operators of theirs."""
    if begin == end:
        return [begin]
    found = []
    stated = {"+": 1, "-": 1, "and": 1, "or": 1, "*": 2}
    inner = [(stated[operators[at]], -at) for at in range(begin, end) if operators[at] in stated]
    for root in range(begin, end):
        if operators[root] in stated and (stated[operators[root]], -root) != min(inner):
            continue
        pairs = itertools.product(all_trees(operators, begin, root), all_trees(operators, root + 1, end))
        found += [(root, left, right) for left, right in pairs]
    return found


def compute(tree: object, operators: tuple[str, ...], values: list[float]) -> float:
    if isinstance(tree, int):
        return values[tree]
    root, left, right = tree  # type: ignore[misc]
    x, y = compute(left, operators, values), compute(right, operators, values)
    table = {
        "+": x + y, "-": x - y, "*": x * y, "and": x != 0 and y != 0, "or": x != 0 or y != 0, "==": x == y,
        "<>": x != y, "<": x < y, ">": x > y,
    }  # fmt: skip
    return float(table[operators[root]])


def test_readings_are_trees_that_the_stated_groups_allow_and_the_value_holds_them_all() -> None:
    """Against all binary trees, built here by another rule: each reading is one of them, but for the usual one."""
    rng = random.Random(616)
    several = 0
    for _ in range(300):
        count = rng.randint(2, 4)
        operators = tuple(rng.choice(["+", "-", "*", "and", "or", "==", "<>", "<", ">"]) for _ in range(count))
        values = [float(rng.randint(0, 4)) for _ in range(count + 1)]
        text = " ".join(f"{v:g} {o}" for v, o in zip(values, (*operators, ""), strict=True)).strip()
        (block,) = parse_line(f"#1 = [{text}]".encode(), "job.cnc", 1)
        assert isinstance(block, Block)
        low, high = bounds(Evaluator(lambda number, span: 0.0, Findings()).value(block.assigns[0].value))
        trees = all_trees(operators, 0, count)
        unstated = {"==", "<>", "<", ">"} & set(operators)
        if not unstated:
            assert low == high == compute(trees[0], operators, values) and len(trees) == 1, text
            continue
        found = [compute(tree, operators, values) for tree in groupings(operators, (False,) * (count + 1))]
        several += min(found) != max(found)
        assert (low, high) == (min(found), max(found)), text
        assert set(groupings(operators, (False,) * (count + 1))[1:]) <= set(trees), text  # type: ignore[arg-type]
    assert several > 50
