"""The tables of the WinCNC page are what the code gives, and the code has everything that the manual names."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from docs.wincnc_tables import PAGE, ROOT, UNKNOWN, command_status, page, rule_of, unknowns
from support.each import each

from docs import wincnc_examples as examples
from docs import wincnc_manual as manual
from gproof.frontend.wincnc.ini_keys import KEYS as RULES
from gproof.ir.codes import CODES as FINDINGS
from gproof.ir.dialects.wincnc.keys import KEYS
from gproof.ir.dialects.wincnc.rules import WINCNC
from gproof.ir.dialects.wincnc.words import COMMANDS, Axes, Command
from gproof.ir.rules import Function

CODES = manual.G_CODES | manual.L_CODES | manual.M_CODES
AXES = set("XYZWUVABC")
NOT_IN_ITS_HEADING = {f"g{n}": {"A"} for n in range(54, 60)}
"""Letters of keys that stand elsewhere in the manual (Program Operation: Workspace)."""


def test_the_page_is_what_the_code_gives(tmp_path: Path, golden: Callable[[Path, str], None]) -> None:
    golden(PAGE, page(tmp_path))


def test_the_rules_have_the_codes_of_the_manual_and_no_others() -> None:
    assert {rule.text for rule in WINCNC.codes.values()} == set(CODES)


def test_every_command_has_an_example_that_uses_it() -> None:
    for table, named in (
        (examples.G_CODES, manual.G_CODES), (examples.L_CODES, manual.L_CODES), (examples.M_CODES, manual.M_CODES),
    ):  # fmt: skip
        assert list(table) == list(named)
    called = "".join(examples.FILES.values())
    for name, text in (examples.G_CODES | examples.L_CODES | examples.M_CODES).items():
        assert re.search(rf"\b{re.escape(name)}(?![0-9.])", text + called), name


def taken(command: Command) -> set[str]:
    """Letters that a command takes, those of axes left out where it has axis words."""
    letters = {p.letter for p in command.parameters if p.letter != "text"}
    return letters


@each("name", CODES)
def test_the_rules_take_the_letters_of_the_manual(name: str) -> None:
    rule, command = rule_of(name), COMMANDS[name]
    assert rule is not None
    own = taken(command) - set(rule.takes)
    assert not own or (rule.uses_axes and own <= AXES) or rule.has_text, (name, own)
    if command.axes is not Axes.NONE:
        assert rule.uses_axes
    if any(p.letter == "text" for p in command.parameters):
        assert rule.has_text


@pytest.mark.parametrize("name", examples.OPEN)
def test_what_is_open_of_a_supported_command_is_unknown(name: str, tmp_path: Path) -> None:
    for what, text, *more in examples.OPEN[name]:
        assert unknowns(name, text, tmp_path, *more), what


@pytest.mark.parametrize("name", [name for name in CODES if rule_of(name).function is Function.UNSUPPORTED])
def test_a_code_that_is_not_modelled_is_unknown(name: str, tmp_path: Path) -> None:
    assert command_status(name, tmp_path).startswith(UNKNOWN)


def test_the_variables_are_those_of_the_manual() -> None:
    assert set(WINCNC.variables) == set(manual.VARIABLES)


def test_the_reader_of_the_machine_file_knows_the_keys_of_the_manual_and_no_others() -> None:
    assert set(RULES) == set(KEYS)


@each("name", KEYS)
def test_the_reader_knows_the_letters_of_a_key(name: str) -> None:
    key, rule = KEYS[name], RULES[name]
    assert {p.letter for p in key.parameters} == set(rule.letters) - NOT_IN_ITS_HEADING.get(name, set())
    if key.form in ("number", "text", "command"):
        assert rule.bare


def test_the_settings_of_the_page_are_settings_of_machine_files() -> None:
    known = set(re.findall(r"^(\w+) = ", (ROOT / "docs" / "machine-files.md").read_text("utf-8"), re.M))
    rows = [line.split(" | ") for line in (ROOT / "docs" / "dialects" / "wincnc.md").read_text("utf-8").splitlines()]
    reasons = set(re.findall(r"^\| (– [a-z ]+) \|", "\n".join(" | ".join(row) for row in rows), re.M))
    assert len(reasons) == 6
    cells = [row[2] for row in rows if len(row) == 4 and row[2] not in ("setting", *reasons)]
    assert "–" not in cells
    named = {name for cell in cells for name in cell.split(":")[0].split(", ")}
    assert named
    assert named <= known


def test_the_codes_of_the_page_are_finding_codes() -> None:
    text = (ROOT / "docs" / "dialects" / "wincnc.md").read_text("utf-8")
    assert {int(number) for number in re.findall(r"\bGP(\d{3})\b", text)} <= set(FINDINGS)
