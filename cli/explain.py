"""``gproof explain GP301``: the page of a finding code."""

from __future__ import annotations

import re
import sys

import click

from gproof.cli.markdown import show_markdown
from gproof.driver.errors import UsageError
from gproof.ir.codes import CODES, RETIRED
from gproof.ir.finding import Code
from gproof.report.finding_page import FILES, page_to_read, page_with_files, whole_page, within

WIDTH = 100
"""Columns, where the terminal has that many."""

_SHAPES = "a finding has a code such as GP301 or a name such as soft-limit"


SHOWN = 3
"""Codes that are named to somebody who named none."""


def run_explain(text: str, *, files: bool = False) -> int:
    """Print the page of a code given as ``GP301``, ``301``, ``soft-limit`` or ``soft limit``; files: all of it."""
    code = _meant(text)
    if code is None and (gone := _retired(text)):
        raise UsageError(gone)
    if code is None:
        raise UsageError(f"there is no finding {text!r}; {_near(text)}")
    if files and not sys.stdout.isatty():
        click.echo(page_with_files(code))  # as it is: others read files out of it
        return 0
    page = page_with_files(code) if files else page_to_read(code)
    lines = [f"{code.label} [{code.name}], severity {code.severity.value}, property {code.decides}"]
    if not files and FILES in whole_page(code):
        lines.insert(0, f"The files that these programs need: `gproof explain {code.label} --files`")
    text = "\n\n".join([page, *lines])
    if sys.stdout.isatty():
        show_markdown(text, WIDTH)
    else:
        click.echo(within(text, WIDTH))
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
    """A name as codes have it, whatever is between its words."""
    return "-".join(re.findall(r"[a-z0-9]+", text.lower()))


def _near(text: str) -> str:
    """What else may have been meant: names that are close, then those with one of the words in them."""
    import difflib

    if number := re.fullmatch(r"(?:gp)?[ -]?0*(\d+)", text.strip(), re.IGNORECASE):
        own = sorted(code for code in CODES if code // 100 == int(number[1]) // 100)
        return f"this group has GP{own[0]} to GP{own[-1]}" if own else _SHAPES
    words = [word for word in _name(text).split("-") if len(word) > 2]
    names = {code.name: code for code in CODES.values()}
    found = difflib.get_close_matches(_name(text), names, 3, 0.7)
    shared = {name: sum(word in name for word in words) for name in names}
    most = sorted((name for name in names if shared[name]), key=lambda name: (-shared[name], names[name].number))
    # A name with one letter wrong needs no others next to it.
    found = difflib.get_close_matches(_name(text), names, 1, 0.9) or list(dict.fromkeys([*found, *most]))[:SHOWN]
    if not found:
        return _SHAPES
    *first, last = (f"{name} ({names[name].label})" for name in found)
    return f"did you mean {', '.join(first) + ' or ' if first else ''}{last}?"
