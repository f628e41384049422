"""``docs/dialects/eding-tables.md`` as the code gives it: what gproof does with everything the manual names.

Codes and commands are run: one that ends in an UNKNOWN finding is UNKNOWN. Written anew by ``make goldens``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from docs import eding_manual as manual
from gproof.driver.dialects import load_machine, load_setup
from gproof.driver.running import execute
from gproof.frontend.eding.load import load_program
from gproof.ir.dialects.eding.operators import LEVELS
from gproof.ir.dialects.eding.rules import EDING, FREE
from gproof.ir.finding import Findings, Severity
from gproof.ir.rules import CHECKED_ONLY, CodeRule, ParameterRange
from gproof.passes.interpret.core.shown_variables import SHOWN
from gproof.passes.interpret.eding.commands import HANDLERS, _nesting, _note

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "dialects" / "eding-tables.md"
EXAMPLES = ROOT / "docs" / "codes"

SUPPORTED, CHECKED, UNKNOWN = "supported", "checked-only", "UNKNOWN"

WITH_KNIFE = """
[axes.c]
kind = "rotary"
steps_per_unit = 100
min = -3600.0
max = 3600.0
max_velocity = 180.0
max_acceleration = 720.0

[knife]
axis = "c"
angle = 20.0
lift = 5.0
blend_angle = 6.0
blend_distance = 0.5
"""
"""What commands of a tangential knife need of a machine."""

HEAD = """\
# Eding CNC: everything the manual names

This page lists every code, operator, command and parameter of the manual, and what gproof does with it. How
gproof reads what the manual leaves open is in [eding.md](eding.md). The page is generated from the code (`make
goldens`) and tested to be complete.

- **supported**: gproof reads, checks and executes it. Its effect is in the Trace, or in the values of the
  program.
- **checked-only**: gproof reads and checks it, and it is an event of the Trace. gproof does not model what the
  device then does; no axis depends on it.
- **UNKNOWN**: gproof reads it. A program that executes it is UNKNOWN from there on, with a finding that says
  why.

The examples run on the machine of the finding codes' examples (`docs/codes/machine.toml`), with `thread_peak`
for G76 and a knife on C for its commands. A code may be UNKNOWN on a machine whose file says less.
"""


def run(text: str, folder: Path) -> Findings:
    """Findings of a program that runs behind ``manual.PREPARED``."""
    path = folder / "job.cnc"
    path.write_text(manual.PREPARED + text + "\nM30\n", encoding="utf-8")
    findings = Findings()
    has_knife = "knife" in text
    own = folder / "machine.toml"
    said = (EXAMPLES / "machine.toml").read_text(encoding="utf-8")
    said = said.replace('dialect = "eding"\n', 'dialect = "eding"\nthread_peak = "offset"\n')
    own.write_text(said + (WITH_KNIFE if has_knife else ""), "utf-8")
    machine, _ = load_machine(own, findings)
    own = folder / "setup.toml"
    said = (EXAMPLES / "setup.toml").read_text(encoding="utf-8")
    own.write_text(said.replace("a = 0.0}", "a = 0.0, c = 0.0}") if has_knife else said, "utf-8")
    setup, _ = load_setup(own, findings)
    program = load_program(path, findings)
    assert program is not None and machine is not None and setup is not None
    execute(program, setup, machine, findings)
    return findings


def is_unknown(example: str, folder: Path) -> bool:
    return bool(unknowns(example, folder))


def unknowns(example: str, folder: Path) -> list[str]:
    """What keeps a program from being judged, as ``GP280 height-control``."""
    findings = run(example, folder)
    wrong = [f.message for f in findings.kept if f.severity is Severity.ERROR]
    assert not wrong, (example, wrong)
    return list(dict.fromkeys(f"{f.code.label} {f.code.name}" for f in findings.kept if f.severity is Severity.UNKNOWN))


def rule_of(code: str) -> CodeRule:
    """The rule of a code as the manual writes it."""
    return EDING.codes[code[0], round(10 * float(code[1:]))]


def code_status(code: str, example: str, folder: Path) -> str:
    why = unknowns(example, folder)
    if why:
        return (
            f"{UNKNOWN} ({', '.join(why)}): {rule_of(code).open}"
            if rule_of(code).open
            else f"{UNKNOWN} ({', '.join(why)})"
        )
    return CHECKED if rule_of(code).function in CHECKED_ONLY else SUPPORTED


def _codes(codes: Mapping[str, tuple[str, str]], folder: Path) -> Iterator[str]:
    yield "| code | section | function | modal group | status |"
    yield "|---|---|---|---|---|"
    for code, (section, example) in codes.items():
        rule = rule_of(code)
        function = rule.function.name.lower().replace("_", " ")
        yield f"| {code} | {section} | {function} | {rule.group} | {code_status(code, example, folder)} |"


def _operators() -> Iterator[str]:
    yield "Stronger groups first; within a group the operator on the left is performed first (3.2.2.3)."
    yield ""
    yield "| binary operators | grouping | status |"
    yield "|---|---|---|"
    stated = {"**", "*", "/", "mod", "+", "-", "and", "or", "xor"}
    for level in reversed(LEVELS):
        for given, why in ((True, "3.2.2.3"), (False, "not in the manual: doubt is reported (GP230)")):
            names = [o for o in level.split() if (o in stated) is given]
            if names:
                yield f"| {' '.join(f'`{name}`' for name in names)} | {why} | {SUPPORTED} |"
    yield ""
    yield "| unary operators (3.2.2.4, 4.2) | status |"
    yield "|---|---|"
    yield f"| {' '.join(f'`{name}`' for name in manual.UNARY)} | {SUPPORTED} |"


def _commands(folder: Path) -> Iterator[str]:
    yield "| command | section | status |"
    yield "|---|---|---|"
    for form, (section, example) in manual.COMMANDS.items():
        yield f"| {form} | {section} | {command_status(example, folder)} |"


def command_status(example: str, folder: Path) -> str:
    if why := unknowns(example, folder):
        return f"{UNKNOWN} ({', '.join(why)})"
    program = load_program(folder / "job.cnc", Findings())
    assert program is not None
    names = {node.name for node in program.body if type(node).__name__ == "Device"}  # type: ignore[union-attr]
    return CHECKED if names and all(HANDLERS[name] in (_note, _nesting) for name in names) else SUPPORTED


def parameter_status(entry: ParameterRange) -> str:
    """Kinds that the executor has no value for are what the setup states, else unknown."""
    if entry.kind in ("tool_zero", "later"):
        return f"{UNKNOWN}: GP113"
    is_kept = entry.kind in ("free", "persistent", "park_1", "park_2")
    return SUPPORTED if is_kept or entry.kind in SHOWN else f"{UNKNOWN} unless the setup states it to be 0"


def _parameters() -> Iterator[str]:
    yield "| parameters | meaning | section | a program may write them | status |"
    yield "|---|---|---|---|---|"
    for entry in EDING.parameters:
        if entry.meaning == FREE:
            continue
        numbers = f"{entry.first}" if entry.first == entry.last else f"{entry.first}–{entry.last}"
        writable = "yes" if entry.writable else "no"
        yield f"| {numbers} | {entry.meaning} | {entry.source} | {writable} | {parameter_status(entry)} |"
    yield f"| others | {FREE} | 3.1.1 | yes | {SUPPORTED} |"


def page(folder: Path) -> str:
    """The whole page; folder: for the programs that are run."""
    parts = (
        [HEAD.rstrip()],
        ["", "## G codes", "", *_codes(manual.G_CODES, folder)],
        ["", "## M codes", "", *_codes(manual.M_CODES, folder)],
        ["", "## Operators", "", *_operators()],
        ["", "## Commands", "", *_commands(folder)],
        ["", "## Parameters", "", *_parameters()],
    )
    return "\n".join(line for part in parts for line in part) + "\n"
