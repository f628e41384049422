"""What programs and `expect.toml` say must be found, and findings in a comparable form.

`; expect: GP301` on a line: this line gives GP301. `; allow: GP301`: it may (the way back from outside of a
limit, say). Several codes are separated by blanks. WinCNC's comments have it in brackets, `[expect: GP301]`,
McuWIN's behind a quote, `' expect: GP301`, or two slashes.

`expect.toml` has a table for each job: the one of `corpus/eding` by the names of its folders, the one of a workshop of
the other controllers by the names of its programs. What is above its first table holds for all jobs that do not say
otherwise. Paths in it are from its own folder.

Imports nothing of gproof: `make replay` runs the same jobs with another revision.
"""

from __future__ import annotations

import functools
import json
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORPUS = ROOT / "corpus"
SUFFIX = {"eding": ".cnc", "wincnc": ".tap", "mcuwin": ".src"}
JUDGED = ("error", "unknown")  # severities that decide a verdict

_MARKER = re.compile(r"(?:; |\[|' |// )(expect|allow): (GP\d{3}(?: GP\d{3})*)")
_SHOWN = re.compile(r"^(?P<file>.*?):(?P<line>\d+):(?:\d+:)? (?P<severity>\w+) (?P<code>GP\d{3})\b", re.M)


@dataclass(frozen=True)
class Found:
    """One finding: code, severity, name of the file without its folder, line (None: no line).

    accepted: the job itself says why it may be.
    """

    code: str
    severity: str
    file: str
    line: int | None
    accepted: bool = False


@dataclass(frozen=True)
class Markers:
    """(line, code) pairs of one program."""

    expected: frozenset[tuple[int, str]]
    allowed: frozenset[tuple[int, str]]

    @property
    def codes(self) -> set[str]:
        """Codes that at least one line is marked with."""
        return {code for _, code in self.expected}


@functools.cache
def _told(file: Path) -> dict:
    return tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


def expected(program: Path) -> dict | None:
    """What `expect.toml` says of a job, its machine and setup as whole paths; None: the program is no job.

    Other files next to an Eding job count as the job.
    """
    folder = program.parents[1]
    told = _told(folder / "expect.toml")
    job = told.get(program.parent.name if folder == CORPUS / "eding" else program.stem)
    if not isinstance(job, dict):
        return None
    found = {key: value for key, value in told.items() if not isinstance(value, dict)} | job
    return found | {key: str(folder / found[key]) for key in ("machine", "setup") if found.get(key, "zero") != "zero"}


def expectation(job: Path) -> dict:
    """What `expect.toml` says of a job."""
    found = expected(job)
    assert found is not None, f"{job} is in no expect.toml"
    return found


def jobs(dialect: str) -> list[Path]:
    """The programs of all jobs of a controller."""
    if dialect == "eding":
        return sorted(CORPUS.glob("eding/*/job.cnc"))
    shops = CORPUS.glob(f"{dialect}/*/expect.toml")
    return sorted(
        file.parent / "jobs" / f"{name}{SUFFIX[dialect]}"
        for file in shops
        for name, told in _told(file).items()
        if isinstance(told, dict)
    )


def around(job: Path) -> list[str]:
    """The options that name the machine and the setup of a job."""
    told = expectation(job)
    return ["--machine", told["machine"], *(["--setup", told["setup"]] if "setup" in told else [])]


def markers(program: Path) -> Markers:
    """The markers of a program, whatever bytes it holds."""
    expected, allowed = set(), set()
    for number, line in enumerate(program.read_bytes().decode("latin-1").split("\n"), start=1):
        for match in _MARKER.finditer(line):
            into = expected if match[1] == "expect" else allowed
            into |= {(number, code) for code in match[2].split()}
    return Markers(frozenset(expected), frozenset(allowed))


def findings(report: dict) -> list[Found]:
    """The findings of `check --format json`."""
    return [
        Found(
            code=f"GP{str(item['code']).removeprefix('GP')}",
            severity=item["severity"].lower(),
            file=Path(item["file"]).name if item.get("file") else "",
            line=item.get("line"),
            accepted="suppressed" in item,
        )
        for item in report["findings"]
    ]


def shown(text: str) -> list[Found]:
    """The findings in text output, `file:line:col: severity GPnnn [name] message`."""
    return [
        Found(match["code"], match["severity"].lower(), Path(match["file"]).name, int(match["line"]))
        for match in _SHOWN.finditer(text)
    ]


def report_of(stdout: str) -> dict:
    """The JSON report, with the output itself in the message when it is none."""
    try:
        return json.loads(stdout)
    except json.JSONDecodeError as error:
        raise AssertionError(f"no JSON report ({error}):\n{stdout[:2000]}") from error


def false_alarms(found: list[Found], expect: dict) -> set[str]:
    """Codes of the warnings that a SAFE job gives; one that the job itself accepts, with its reason, is none."""
    if expect["verdict"] != "SAFE":
        return set()
    return {one.code for one in found if one.severity == "warning" and not one.accepted}


def misplaced(found: list[Found], program: Path) -> list[str]:
    """Where the findings in one program and its markers disagree; empty when they agree.

    On a marked line a mistake may have further findings; a program without markers says nothing of lines.
    """
    marks = markers(program)
    here = [one for one in found if one.file == program.name]
    places = {(one.line, one.code) for one in here}
    judged = {(one.line, one.code) for one in here if one.severity in JUDGED}
    marked_lines = {line for line, _ in marks.expected}
    missing = [f"line {line} should give {code}" for line, code in sorted(marks.expected - places)]
    if not marked_lines:
        return missing
    surplus = sorted(judged - marks.expected - marks.allowed, key=str)
    return missing + [f"line {line} should not give {code}" for line, code in surplus if line not in marked_lines]


def readme_tables(dialect: str) -> dict[str, str]:
    """What corpus/README.md says under a dialect's heading of safe, unsafe and unknown jobs, by verdict."""
    text = (ROOT / "corpus" / "README.md").read_text(encoding="utf-8")
    part = re.split(r"^## ", text.split(f"\n## {dialect}\n")[1], flags=re.M)[0]
    pieces = re.split(r"^\*\*(Safe|Not safe|Not known)\*\*", part, flags=re.M)
    verdicts = {"Safe": "SAFE", "Not safe": "UNSAFE", "Not known": "UNKNOWN"}
    return {verdicts[name]: body for name, body in zip(pieces[1::2], pieces[2::2], strict=True)}


INSIDE = {
    "a symbol of an unknown": r"\b(?:work|start|g92|tool|head|probe|home|value|length|risen|mirrored|unhomed|beside)"
    r"\.(?:\d+\.)?[a-z]\b",
    "a constant of the source": r"\b(?:None|True|False)\b",
    "no number": r"(?<![\w.])[-+]?(?:inf|nan|infinity)\b",
    "a class": r"\b[A-Z][a-z]+[A-Z][a-z]\w*\(|object at 0x|<class|\bInterval\(|\b\w+\(\w+=",
    "a member of an enum": r"\b[A-Z][a-z]+[A-Za-z]*\.[A-Z][A-Z_]{2,}\b",
    "a field that nothing filled": r"(?<!\{)\{[a-z]\w*\}",
    "a nothing that is too much": r"(?<![\d.])-?0\.0{3,} ?(?:mm|inch|in|deg|degrees|s)? ?"
    r"(?:past|over|more than|into|beyond)\b",
    "a zero with a sign": r"(?<![\w.])-0(?:\.0+)?(?![\d.])",
    "a number of more digits than anybody can read": r"\d\.\d{9,}",
}
"""What a reader can make nothing of."""
COMPUTED = {"GP231"}
"""Codes that show a number to the last bit: that it is not the written one is what they tell."""


def strange(text: str) -> list[str]:
    """What of a text is none of a reader's business."""
    return [f"{what}: {found.group()!r}" for what, way in INSIDE.items() for found in re.finditer(way, text)]


def strange_texts(report: dict) -> list[str]:
    """What is none of a reader's business in the findings and assumptions of `check --format json`."""
    texts = list(report["assumptions"])
    for item in report["findings"]:
        if item["code"] not in COMPUTED:
            texts += [item["message"], item.get("hint") or "", *(r["message"] for r in item.get("related", ()))]
    return [f"{one} in {text!r}" for text in texts for one in strange(text)]
