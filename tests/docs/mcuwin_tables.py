"""``docs/dialects/mcuwin-tables.md`` as the code gives it: what gproof does with everything the manuals name.

The examples are run: one that ends in an UNKNOWN finding is UNKNOWN, one that ends in an error is refused. Written anew
by ``make goldens``.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from docs.mcuwin_examples import EXAMPLES, OPEN, Example

from docs import mcuwin_examples as examples
from gproof.cli.main import main
from gproof.frontend.mcuwin.ini_keys import KEPT, SETTINGS
from gproof.ir.dialects.mcuwin.messages import MESSAGES, ControllerMessage
from gproof.ir.dialects.mcuwin.pascal import FUNCTIONS
from gproof.ir.dialects.mcuwin.rules import MCUWIN
from gproof.ir.dialects.mcuwin.words import TABLES, Entry
from gproof.ir.rules import CHECKED_ONLY, CodeRule

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "dialects" / "mcuwin-tables.md"

SUPPORTED, CHECKED, UNKNOWN, REFUSED = "supported", "checked-only", "UNKNOWN", "refused"

HEAD = """\
# McuWIN: everything the manuals name

This page lists every code, statement, variable and message of the two manuals, and what gproof does with it.
How gproof reads what the manuals leave open is in [mcuwin.md](mcuwin.md). The page is generated from the code
(`make goldens`), and a test compares it with lists made from the manuals. Sections are those of the manual of V
2.5.3.133, and of V 2.5.3.32 in the column of that name.

- **supported**: gproof reads, checks and executes it. Its effect is in the Trace, or in the values of the
  program.
- **checked-only**: gproof reads and checks it, and it is an event of the Trace. gproof does not model what the
  device then does; no axis depends on it.
- **UNKNOWN**: gproof reads it. A program that executes it is UNKNOWN from there on, with a finding that says
  why.
- **refused**: it is an error, as on the controller.

The examples run on a machine whose file says what Task 0 does. Without that, a code of Task 0 is UNKNOWN.
"""


@dataclass(frozen=True)
class Run:
    """What ``gproof check`` says of an example: messages by code."""

    unknowns: dict[str, str]
    errors: dict[str, str]
    verdict: str


def run(example: Example, folder: Path) -> Run:
    """An example on the machine of the examples."""
    for name, text in {
        "machine.toml": examples.MACHINE, "ToolComp.INI": examples.TOOLS, "setup.toml": examples.SETUP,
        "job.src": example.text, **example.files,
    }.items():  # fmt: skip
        (folder / name).write_text(text, "utf-8")
    words = ["check", str(folder / "job.src"), "--machine", str(folder / "machine.toml")]
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        main([*words, "--setup", str(folder / "setup.toml"), "--format", "json"])
    report = json.loads(said.getvalue())
    found = report["findings"]

    def by(severity: str) -> dict[str, str]:
        return {f["code"]: f["message"] for f in found if f["severity"] == severity}

    return Run(by("unknown"), by("error"), report["verdict"])


def rule_of(name: str) -> CodeRule | None:
    """The rule of a code as the manual writes it."""
    code = re.fullmatch(r"([GM])(\d+)", name)
    return None if code is None else MCUWIN.codes.get((code[1], 10 * int(code[2])))


def status(name: str, folder: Path) -> str:
    """What becomes of an entry, by its example."""
    done = run(EXAMPLES[name], folder)
    if done.errors:
        return f"{REFUSED} ({', '.join(done.errors)})"
    if done.unknowns:
        return f"{UNKNOWN} ({', '.join(done.unknowns)})"
    rule = rule_of(name)
    word = CHECKED if rule is not None and rule.function in CHECKED_ONLY else SUPPORTED
    return "; ".join([word, *_open(name, folder)])


def _open(name: str, folder: Path) -> Iterator[str]:
    """Uses that are not judged, each with its code."""
    for what, example in OPEN.get(name, ()):
        done = run(example, folder)
        told = done.errors or done.unknowns
        yield f"{REFUSED if done.errors else UNKNOWN}: {what} ({', '.join(told)})"


def _entries(table: tuple[Entry, ...], folder: Path) -> Iterator[str]:
    yield "| name | meaning | section | V 2.5.3.32 | status |"
    yield "|---|---|---|---|---|"
    for entry in table:
        name = f"`{entry.name}`"
        yield f"| {name} | {entry.meaning} | {entry.section} | {entry.old or '–'} | {status(entry.name, folder)} |"


def _message(message: ControllerMessage) -> str:
    if not message.codes:
        return f"no checker can say it: {message.why}"
    return ", ".join(f"{code.label} {code.name}" for code in message.codes)


def _messages() -> Iterator[str]:
    yield "| message | text | section | finding |"
    yield "|---|---|---|---|"
    for message in MESSAGES:
        yield f"| {message.name} | {message.text} | {message.section} | {_message(message)} |"


def _keys() -> Iterator[str]:
    yield "| key | meaning | section | status |"
    yield "|---|---|---|---|"
    yield f"| `[FEHLERTEXTE…]`, `[ERRORTEXTS…]` | texts of errors | 14 (2.5.3.103, .107) | {CHECKED} (kept as text) |"
    for key in KEPT:
        yield f"| `{key.shown}` | {key.meaning} | {key.source} | {CHECKED} (kept as text) |"
    for row in SETTINGS:
        stated = f"`{row.stated_by}` of `[din]` gives it" if row.stated_by else f"{CHECKED} (kept as text)"
        usual = f"; {UNKNOWN} (GP605) while a key with an unknown name may hold it" if row.usual else ""
        yield f"| unknown | {row.what} | {row.source} | {stated}{usual} |"


def _functions() -> str:
    named = {entry.name.lower() for entry in TABLES["Functions"]}
    more = sorted(set(FUNCTIONS) - named)
    return f"The manual refers to rw_SymPas for others; gproof knows the usual ones of Pascal: `{'`, `'.join(more)}`."


def page(folder: Path) -> str:
    """The whole page; folder: for the programs that are run."""
    parts = [HEAD.rstrip()]
    for title, table in TABLES.items():
        parts += ["", f"## {title}", "", *_entries(table, folder)]
        if title == "Functions":
            parts += ["", _functions()]
    parts += ["", "## Settings of McuWIN.ini", "", *_keys(), "", "## Messages", "", *_messages()]
    return "\n".join(parts) + "\n"
