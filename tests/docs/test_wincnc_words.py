"""The tables of WinCNC's language have what the manual's headings name, and nothing else."""

from __future__ import annotations

import pytest
from support.each import each

from docs import wincnc_manual as manual
from gproof.ir.codes import CODES
from gproof.ir.dialects.wincnc.keys import KEYS, VARIABLES, Key
from gproof.ir.dialects.wincnc.messages import MESSAGES, ControllerMessage
from gproof.ir.dialects.wincnc.words import COMMANDS, G_CODES, L_CODES, LETTERS, M_CODES, Axes, Command, Parameter


def form(command: Command) -> str:
    """A command's letters as the manual's list has them."""
    axes = {Axes.NONE: [], Axes.NAMES: ["names"], Axes.VALUES: ["axes"]}[command.axes]
    return " ".join([*axes, *(p.letter for p in command.parameters)])


def key_form(key: Key) -> str:
    if key.form == "axes":
        return " ".join(["axes", *key.letters])
    return " ".join(key.letters) if key.form == "letters" else key.form


@pytest.mark.parametrize(
    ("table", "named"),
    [(G_CODES, manual.G_CODES), (L_CODES, manual.L_CODES), (M_CODES, manual.M_CODES)],
    ids=["G", "L", "M"],
)
def test_commands_and_their_letters_are_those_of_the_manual(table: tuple[Command, ...], named: dict[str, str]) -> None:
    assert [(c.name, form(c)) for c in table] == list(named.items())


def test_letters_are_those_of_the_manual() -> None:
    assert tuple(c.name for c in LETTERS) == manual.BRACKETS
    assert len(COMMANDS) == len(LETTERS) + len(G_CODES) + len(L_CODES) + len(M_CODES)


def test_keys_and_their_letters_are_those_of_the_manual() -> None:
    assert {name: key_form(key) for name, key in KEYS.items()} == manual.KEYS


def test_variables_are_those_of_the_manual() -> None:
    assert tuple(VARIABLES) == manual.VARIABLES


def test_messages_are_those_of_the_manual() -> None:
    assert tuple(m.text for m in MESSAGES) == manual.MESSAGES


@each("message", MESSAGES, ids=lambda m: m.text)
def test_a_message_has_a_finding_or_a_reason_why_not(message: ControllerMessage) -> None:
    assert bool(message.codes) != bool(message.why)
    assert all(CODES[code.number] is code for code in message.codes)


def parameters() -> list[tuple[str, Parameter]]:
    own = [(c.heading, p) for c in COMMANDS.values() for p in c.parameters]
    return own + [(k.heading, p) for k in KEYS.values() for p in k.parameters]


def test_every_row_says_what_it_means() -> None:
    for row in (*COMMANDS.values(), *KEYS.values(), *VARIABLES.values()):
        assert row.meaning
        assert row.heading
    for heading, parameter in parameters():
        assert parameter.meaning, heading
        assert parameter.low is None or parameter.high is None or parameter.low <= parameter.high, heading


RANGES = {
    ("G Codes: G1", "L"): (1, 100),
    ("G Codes: G5", "T"): (0, 4),
    ("L Codes: L1", "N"): (0, 29),
    ("L Codes: L7", "P"): (1, 100),
    ("L Codes: L20", "X"): (1, 2),
    ("L Codes: L60", "C"): (1, 64),
    ("L Codes: L61", "C"): (1, 64),
    ("L Codes: L111", "A"): (0, 2),
    ("L Codes: L251", "P"): (1, 100),
    ("L Codes: L901", "D"): (1, 30),
    ("M Codes: M17.1", "D"): (0, 1),
    ("M Codes: M17.3", "C"): (1, 64),
    ("M Codes: M17.4", "C"): (0, 1),
    ("M Codes: M18.3", "C"): (1, 64),
    ("M Codes: M18.4", "C"): (0, 1),
    ("M Codes: M37.3", "M"): (0, 2),
    ("WINCNC.INI Settings: axisspec=", "S"): (0, 5),
    ("WINCNC.INI Settings: axisspec=", "D"): (0, 5),
    ("WINCNC.INI Settings: axislo=", "P"): (0, 3),
    ("WINCNC.INI Settings: axislo=", "B"): (0, 7),
    ("WINCNC.INI Settings: accel=", "S"): (0, 200),
    ("WINCNC.INI Settings: auxin=", "C"): (1, 32),
    ("WINCNC.INI Settings: auxout=", "C"): (1, 32),
    ("WINCNC.INI Settings: knifeangle=", "A"): (-89, 89),
    ("WINCNC.INI Settings: override=", "L"): (1, 200),
    ("WINCNC.INI Settings: override=", "H"): (1, 200),
    ("WINCNC.INI Settings: pumpcont=", "I"): (0, 99),
    ("WINCNC.INI Settings: pumpcont=", "R"): (0, 15),
    ("WINCNC.INI Settings: softlim=", "T"): (0, 2),
    ("WINCNC.INI Settings: thc=", "V"): (20, 250),
    ("WINCNC.INI Settings: thc=", "P"): (1, 100),
    ("WINCNC.INI Settings: vmatch=", "P"): (0.9, 1.0),
}
"""Ranges that the manual prints, read from it."""


def test_ranges_are_those_of_the_manual() -> None:
    table = {(heading, p.letter): (p.low, p.high) for heading, p in parameters()}
    assert {place: table[place] for place in RANGES} == RANGES
