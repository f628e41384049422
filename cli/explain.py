"""``gproof explain GP301``: the page of a finding code."""

from __future__ import annotations

import re
from importlib import resources

import click

from gproof.driver.errors import UsageError
from gproof.ir.codes import CODES, RETIRED
from gproof.ir.finding import Code

_SHAPES = "codes look like GP301 or soft-limit"


SHOWN = 3
"""Codes that are named to somebody who named none."""


def run_explain(text: str) -> int:
    """Print the explanation of a code given as ``GP301``, ``301``, ``soft-limit`` or ``soft limit``."""
    code = _meant(text)
    if code is None and (gone := _retired(text)):
        raise UsageError(gone)
    if code is None:
        raise UsageError(f"there is no finding {text!r}; {_near(text)}")
    page = resources.files("gproof.docs_codes") / code.label / "explanation.md"
    click.echo(page.read_text(encoding="utf-8").rstrip())
    click.echo(f"\n{code.label} [{code.name}], severity {code.severity.value}, property {code.decides}")
    return 0


def _meant(text: str) -> Code | None:
    number = re.fullmatch(r"(?:gp)?[ -]?0*(\d{1,3})", text.strip(), re.IGNORECASE)
    if number:
        return CODES.get(int(number[1]))
    return next((code for code in CODES.values() if code.name == _name(text)), None)


def _retired(text: str) -> str:
    """What is to be said of a code that is no more; "" where none is meant."""
    for number, (name, instead) in RETIRED.items():
        if _name(text) in (name, f"gp{number}", str(number)):
            return f"GP{number} [{name}] is retired: {instead}"
    return ""


def _name(text: str) -> str:
    """A name as codes have it, whatever stands between its words."""
    return "-".join(re.findall(r"[a-z0-9]+", text.lower()))


def _near(text: str) -> str:
    """What else may have been meant: names that are close, then those with one of the words in them."""
    import difflib

    if number := re.fullmatch(r"(?:gp)?[ -]?0*(\d+)", text.strip(), re.IGNORECASE):
        own = sorted(code for code in CODES if code // 100 == int(number[1]) // 100)
        return f"codes of its hundred are GP{own[0]} ... GP{own[-1]}" if own else _SHAPES
    words = [word for word in _name(text).split("-") if len(word) > 2]
    names = {code.name: code for code in CODES.values()}
    found = difflib.get_close_matches(_name(text), names, 3, 0.7)
    shared = {name: sum(word in name for word in words) for name in names}
    most = sorted((name for name in names if shared[name]), key=lambda name: (-shared[name], names[name].number))
    # A name with one letter wrong needs no others beside it.
    found = difflib.get_close_matches(_name(text), names, 1, 0.9) or list(dict.fromkeys([*found, *most]))[:SHOWN]
    if not found:
        return _SHAPES
    *first, last = (f"{name} ({names[name].label})" for name in found)
    return f"did you mean {', '.join(first) + ' or ' if first else ''}{last}?"
