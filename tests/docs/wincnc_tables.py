"""``docs/dialects/wincnc-tables.md`` as the code gives it: what gproof does with everything the manual names.

The examples of the commands are run: one that ends in an UNKNOWN finding is UNKNOWN. Written anew by ``make goldens``.
"""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from docs import wincnc_examples as examples
from gproof.cli.main import main
from gproof.frontend.wincnc.ini_keys import KEYS as RULES
from gproof.frontend.wincnc.ini_keys import KeyRule
from gproof.ir.codes import UNSUPPORTED_CODE
from gproof.ir.dialects.wincnc.keys import KEYS, VARIABLES, Key
from gproof.ir.dialects.wincnc.messages import MESSAGES, ControllerMessage
from gproof.ir.dialects.wincnc.rules import WINCNC
from gproof.ir.dialects.wincnc.words import G_CODES, L_CODES, LETTERS, M_CODES, Axes, Command, Parameter
from gproof.ir.machine import TOUCHES
from gproof.ir.rules import CHECKED_ONLY, CodeRule

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "dialects" / "wincnc-tables.md"
MACHINE = ROOT / "docs" / "codes" / "wincnc"

SUPPORTED, CHECKED, UNKNOWN = "supported", "checked-only", "UNKNOWN"

HEAD = """\
# WinCNC: everything the manual names

This page lists every command, variable, key and message of the manual, and what gproof does with it. How gproof
reads what the manual leaves open is in [wincnc.md](wincnc.md). The page is generated from the code (`make
goldens`), and a test compares it with a list of the manual's headings.

- **supported**: gproof reads, checks and executes it. Its effect is in the Trace, or in the values of the
  program.
- **checked-only**: gproof reads and checks it, and it is an event of the Trace. gproof does not model what the
  device then does; no axis depends on it.
- **UNKNOWN**: gproof reads it. A program that executes it is UNKNOWN from there on, with a finding that says
  why.

The examples run on the machine of `docs/codes/wincnc`, with the device that a command needs. A command may be
UNKNOWN on a machine, or with a setup, that is described less completely.
"""

_COMMANDS = {**examples.G_CODES, **examples.L_CODES, **examples.M_CODES, **examples.LETTERS}


def prepared(name: str, folder: Path, more: str = "") -> Path:
    """The machine file for an example, beside its macros and the files it calls; more: lines in place of its own."""
    ini = (MACHINE / "WINCNC.INI").read_text("utf-8")
    if name in examples.WITH_TURNING_AXIS:
        for place, put in examples.TURNING_AXIS:
            assert place in ini
            ini = ini.replace(place, put, 1)
    if name in examples.WITH_SECOND_MOTOR:
        ini = examples.SECOND_MOTOR_OF.sub(lambda found: found[0] + examples.SECOND_MOTOR, ini, count=1)
    ini += "".join(examples.DEVICES[device] for device in examples.NEEDS.get(name, ()))
    keys = tuple(f"{line.partition('=')[0]}=" for line in more.splitlines())
    kept = [line for line in ini.splitlines(keepends=True) if not (keys and line.startswith(keys))]
    (folder / "WINCNC.INI").write_text("".join(kept) + more, "utf-8")
    (folder / "CNC.MAC").write_text((MACHINE / "CNC.MAC").read_text("utf-8"), "utf-8")
    for file, text in examples.FILES.items():
        (folder / file).write_text(text, "utf-8")
    setup = (MACHINE / "setup.toml").read_text("utf-8")
    if name in examples.WITH_TURNING_AXIS:
        setup = setup.replace("w = 0.0}", "w = 0.0, c = 0.0}").replace('"w"]', '"w", "c"]')
    (folder / "setup.toml").write_text(setup.replace("[measures]", examples.STATED + "\n[measures]"), "utf-8")
    return folder / "WINCNC.INI"


@dataclass(frozen=True)
class Run:
    """What ``gproof check`` says of an example: its unknown findings, one message of each code, and its errors."""

    unknowns: dict[str, str]
    errors: list[str]
    verdict: str


def run(name: str, text: str, folder: Path, more: str = "") -> Run:
    """A program that runs behind ``PREPARED`` on the machine of the command ``name``."""
    folder.mkdir(exist_ok=True)
    ini = prepared(name, folder, more)
    path = folder / "job.tap"
    path.write_text(f"{examples.PREPARED}{text}\n", "utf-8")
    words = ["check", str(path), "--machine", str(ini), "--setup", str(folder / "setup.toml")]
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        main([*words, "--dialect", "wincnc", "--format", "json"])
    report = json.loads(said.getvalue())
    found = report["findings"]
    unknown = {f["code"]: f["message"] for f in found if f["severity"] == "unknown"}
    wrong = [f"{f['code']} {f['line']}: {f['message']}" for f in found if f["severity"] == "error"]
    return Run(unknown, wrong, report["verdict"])


def unknowns(name: str, text: str, folder: Path, more: str = "") -> dict[str, str]:
    """What keeps a program from being judged: messages by code."""
    done = run(name, text, folder, more)
    assert not done.errors, (name, text, done.errors)
    assert bool(done.unknowns) == (done.verdict == "UNKNOWN"), (name, text, done)
    return done.unknowns


def rule_of(name: str) -> CodeRule | None:
    """The rule of a code as the manual writes it; None for a letter."""
    if len(name) == 1:
        return None
    return WINCNC.codes[name[0], round(10 * float(name[1:]))]


def command_status(name: str, folder: Path) -> str:
    why = unknowns(name, _COMMANDS[name], folder)
    rule = rule_of(name)
    if why:
        return f"{UNKNOWN} ({', '.join(why)}): {_reason(why, rule)}"
    status = CHECKED if rule is not None and rule.function in CHECKED_ONLY else SUPPORTED
    some = [
        f"{what} ({', '.join(unknowns(name, text, folder, *more))})"
        for what, text, *more in examples.OPEN.get(name, ())
    ]
    return f"{status}; {UNKNOWN}: {'; '.join(some)}" if some else status


def _reason(why: dict[str, str], rule: CodeRule | None) -> str:
    """What the rule says is open, else the first message of what is not modelled, else the first one."""
    if rule is not None and rule.open:
        return rule.open
    message = next((text for code, text in why.items() if code == UNSUPPORTED_CODE.label), next(iter(why.values())))
    return message.split(" is not modelled;")[0].rstrip(",")


def _range(parameter: Parameter) -> str:
    low, high = parameter.low, parameter.high
    if low is None and high is None:
        return ""
    if high is None:
        return f", {low:g} or more"
    return f", {high:g}" if low == high else f", {low:g} to {high:g}"


def _parameters(parameters: Iterable[Parameter]) -> Iterator[str]:
    for p in parameters:
        needed = ", required" if p.needed else ""
        yield f"{p.letter}: {p.meaning}{_range(p)}{needed}"


def _takes(command: Command) -> str:
    words = {Axes.NONE: [], Axes.NAMES: ["letters of axes"], Axes.VALUES: ["axis words"]}[command.axes]
    return "; ".join([*words, *_parameters(command.parameters)])


def _codes(commands: Iterable[Command], folder: Path) -> Iterator[str]:
    yield "| command | meaning | takes | status |"
    yield "|---|---|---|---|"
    for c in commands:
        name = f"`{c.name}`" if len(c.name) == 1 else c.name
        yield f"| {name} | {c.meaning} | {_takes(c)} | {command_status(c.name, folder)} |"


TREATMENTS = {"modelled": SUPPORTED, "checked": CHECKED, "kept": f"{CHECKED} (kept as text)", "unmodelled": UNKNOWN}


def key_status(rule: KeyRule) -> str:
    reason = f": {rule.reason}" if rule.reason else ""
    where = " where it is on (GP605)" if rule.treatment == "unmodelled" else ""
    return f"{TREATMENTS[rule.treatment]}{where}{reason}"


def odd_letter(rule: KeyRule) -> str:
    """What a letter that the manual does not name does: which jobs are UNKNOWN by it (GP605)."""
    kind, _, number = rule.touches.partition(".")
    told = {"axis": "jobs that move the axis", "all": "every job", "corners": "a warning; corners are not sharp",
            "state": "a warning; the output's state is not known", "": "a warning"}  # fmt: skip
    if not rule.letters and rule.named.form != "axes":
        return "–"
    return told.get(kind) or TOUCHES[kind].replace("the workspace of the number behind the dot", f"G{number}")


def _value(key: Key) -> str:
    forms = {"number": "a number", "text": "a text", "command": "a command", "axes": "axis words", "letters": ""}
    return "; ".join(filter(None, [forms[key.form], *_parameters(key.parameters)]))


def _keys() -> Iterator[str]:
    yield "| key | meaning | value | default | moves axes | a letter that the manual lacks makes UNKNOWN | status |"
    yield "|---|---|---|---|---|---|---|"
    for key in KEYS.values():
        moves = "yes" if key.moves else "no"
        rule = RULES[key.name]
        odd, status = odd_letter(rule), key_status(rule)
        yield f"| {key.name}= | {key.meaning} | {_value(key)} | {key.default} | {moves} | {odd} | {status} |"


def variable_status(name: str, folder: Path) -> str:
    like, before = examples.VARIABLES[name]
    why = unknowns(like, f"{before}G1 X{{{name}+100}}", folder)
    return f"{UNKNOWN} ({', '.join(why)})" if why else SUPPORTED


def _variables(folder: Path) -> Iterator[str]:
    yield "| variable | meaning | from | status |"
    yield "|---|---|---|---|"
    for v in VARIABLES.values():
        yield f"| {v.name} | {v.meaning} | {v.known} | {variable_status(v.name, folder)} |"


def _message(message: ControllerMessage) -> str:
    if not message.codes:
        return f"no checker can say it: {message.why}"
    return ", ".join(f"{code.label} {code.name}" for code in message.codes)


def _messages() -> Iterator[str]:
    yield "| message | finding |"
    yield "|---|---|"
    for message in MESSAGES:
        yield f"| {message.text} | {_message(message)} |"


def page(folder: Path) -> str:
    """The whole page; folder: for the programs that are run."""
    parts = (
        [HEAD.rstrip()],
        ["", "## Letters and brackets", "", *_codes(LETTERS, folder)],
        ["", "## G codes", "", *_codes(G_CODES, folder)],
        ["", "## L codes", "", *_codes(L_CODES, folder)],
        ["", "## M codes", "", *_codes(M_CODES, folder)],
        ["", "## Variables in braces", "", *_variables(folder)],
        ["", "## Keys of WINCNC.INI", "", *_keys()],
        ["", "## Messages", "", *_messages()],
    )
    return "\n".join(line for part in parts for line in part) + "\n"
