"""``gproof explain GP301``: the page of a finding code."""

from __future__ import annotations

import re
from importlib import resources

import click

from gproof.cli.main import UsageError
from gproof.ir.codes import CODES


def run_explain(text: str) -> int:
    """Print the explanation of a code given as ``GP301``, ``301`` or ``soft-limit``."""
    number = re.fullmatch(r"(?:gp)?0*(\d{1,3})", text.strip(), re.IGNORECASE)
    by_name = {code.name: code for code in CODES.values()}
    code = CODES.get(int(number[1])) if number else by_name.get(text.strip().lower())
    if code is None:
        import difflib

        known = {name: name for name in by_name} | {c.label.lower(): c.label for c in CODES.values()}
        close = difflib.get_close_matches(text.lower(), known, 1)
        hint = f"; did you mean {known[close[0]]}?" if close else "; codes look like GP301 or soft-limit"
        raise UsageError(f"there is no finding {text!r}{hint}")
    page = resources.files("gproof.docs_codes") / code.label / "explanation.md"
    click.echo(page.read_text(encoding="utf-8").rstrip())
    click.echo(f"\n{code.label} [{code.name}], severity {code.severity.value}, property {code.decides}")
    return 0
