"""What a page of a finding (docs/codes/GPnnn.md) holds, and what a run of its programs takes.

A page has the explanation, under ``## Programs`` a pair of programs for each controller whose jobs can get the finding
(`bad.cnc` and `good.cnc` for Eding CNC, `.tap` for WinCNC, `.src` for McuWIN) or the reason why there is none, and
under ``## Files`` what else the programs need (support/bundles.py: how a page holds files). The programs run on the
shared machine and setup of docs/codes, docs/codes/wincnc or docs/codes/mcuwin, or on the page's own (`WINCNC.INI`,
`setup.toml` for WinCNC, `machine.toml` for McuWIN where it has no other pair).

`run.toml` of a page says what is special about it: `setup` ("zero", "none" or a file), `machine` (a file), `program`
(one program for both runs; the machine or setup differs), `command` ("check" or "compile"), `options` (further
arguments); `[bad]` and `[good]` override single keys. That holds for the page's first pair in the order above, or
the one that `dialect` names; tables `[eding]`, `[wincnc]`, `[mcuwin]`, with the same keys, for the others.

Imports nothing of gproof: `make replay` runs the same programs with another revision.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from pathlib import Path

from support.bundles import unpacked

PAGES = Path(__file__).resolve().parents[2] / "docs" / "codes"
DOCS = unpacked("docs/codes")
FOLDERS = sorted(DOCS / page.stem for page in PAGES.glob("GP*.md"))
"""A folder with the files of each page; one without any does not exist."""

DEFAULTS = {"setup": "../setup.toml", "machine": "../machine.toml", "command": "check", "options": []}
SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}
NAMES = {"eding": "Eding CNC", "wincnc": "WinCNC", "mcuwin": "McuWIN"}
"""The controllers, as the headings of a page call them."""


def text_of(folder: Path) -> str:
    """The page whose files are in a folder."""
    return (PAGES / f"{folder.name}.md").read_text(encoding="utf-8")


def special(folder: Path) -> dict:
    """What `run.toml` says."""
    path = folder / "run.toml"
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def first_dialect(folder: Path) -> str | None:
    """The controller of the folder's first pair, which the keys of `run.toml` are for."""
    told = special(folder)
    found = [dialect for dialect, suffix in SUFFIX.items() if (folder / f"bad.{suffix}").is_file()]
    return told.get("dialect", found[0] if found else "eding" if told else None)


def dialects(folder: Path) -> list[str]:
    """The controllers of which a folder has a pair."""
    told, first = special(folder), first_dialect(folder)
    return [d for d, suffix in SUFFIX.items() if (folder / f"bad.{suffix}").is_file() or d == first or d in told]


def reasons(page: str) -> dict[str, str]:
    """Why a page has no programs for a controller: lines `- WinCNC: ...` under its programs."""
    _, _, programs = page.partition("\n## Programs\n")
    told: dict[str, str] = {}
    for names, because in re.findall(r"^- ([\w ,]+): (.+(?:\n  .+)*)", programs.partition("\n## Files\n")[0], re.M):
        for name in names.split(", "):
            dialect = {name: dialect for dialect, name in NAMES.items()}[name]
            assert dialect not in told, f"two reasons for {name}"
            told[dialect] = " ".join(because.split())
    return told


def defaults(folder: Path, dialect: str) -> dict:
    """What a run of a folder's programs takes where `run.toml` says nothing."""
    if dialect == "eding":
        return {**DEFAULTS, "options": []}
    alone = first_dialect(folder) == dialect
    shared = {"machine": f"../{dialect}/{'WINCNC.INI' if dialect == 'wincnc' else 'machine.toml'}"}
    shared["setup"] = f"../{dialect}/setup.toml"
    own = {"machine": "WINCNC.INI", "setup": "setup.toml"} if dialect == "wincnc" else {"machine": "machine.toml"}
    own = {key: name for key, name in own.items() if alone and (folder / name).is_file()}
    return {**DEFAULTS, **shared, **own, "options": []}


def settings(folder: Path, dialect: str, side: str) -> dict:
    """What a run of one program of a folder takes."""
    told = special(folder)
    if dialect != first_dialect(folder):
        told = told.get(dialect, {})
    plain = {key: value for key, value in told.items() if not isinstance(value, dict) and key != "dialect"}
    out = {**defaults(folder, dialect), "program": f"{side}.{SUFFIX[dialect]}", **plain, **told.get(side, {})}
    if dialect != "eding" and "--dialect" not in out["options"]:
        out["options"] = [*out["options"], "--dialect", dialect]
    return out


def sentences(folder: Path, dialect: str) -> list[str]:
    """What a page says of both programs, each before its program; options and files as `run.toml` has them."""
    bad, good = (settings(folder, dialect, side) for side in ("bad", "good"))
    with_files = {key for key in ("machine", "setup") if bad[key] != good[key]}
    start = f"`gproof compile` of `{bad['program']}`" if bad["command"] == "compile" else f"`{bad['program']}`"
    also = " ".join(_options(bad))
    return [
        f"**Bad.** {start}{also and f', with `{also}`,'} gives {folder.name}{_with(bad, with_files)}.",
        f"**Good.** `{good['program']}` gives no error{_with(good, with_files)}.",
    ]


def _options(run: dict) -> list[str]:
    """Options that say more than the language, which the file's name says too."""
    words = list(run["options"])
    if "--dialect" in words:
        at = words.index("--dialect")
        del words[at : at + 2]
    return words


def _with(run: dict, keys: set[str]) -> str:
    """The files that make the difference between a bad and a good run."""
    told = [_file(key, run[key]) for key in ("machine", "setup") if key in keys]
    return f" {' and '.join(told)}" if told else ""


def _file(key: str, name: str) -> str:
    if name in ("zero", "none"):
        return "with `--setup zero`" if name == "zero" else "without a setup file"
    named = _named(name)
    if named.startswith("the shared "):
        return f"with the shared {key} file {named.removeprefix('the shared ')}"
    return f"with the {key} file {named}"


def table(folder: Path) -> list[str]:
    """The lines that say on which machine and with which setup the programs of a page run."""
    rows: dict[tuple[str, str], list[str]] = {}
    for dialect in dialects(folder):
        runs = {side: settings(folder, dialect, side) for side in ("bad", "good")}
        same = runs["bad"]["program"] == runs["good"]["program"]
        for side, run in runs.items():
            program = f"`{run['program']}`" + f", {side}" * same
            rows.setdefault((_linked(run["machine"]), _linked(run["setup"])), []).append(program)
    lines = [f"| {', '.join(programs)} | {machine} | {setup} |" for (machine, setup), programs in rows.items()]
    return ["| Programs | Machine file | Setup file |", "|---|---|---|", *lines] if lines else []


def _linked(name: str) -> str:
    """A file of the page, one that is shared, or one of another page."""
    shared = name.removeprefix("../")
    if other := re.fullmatch(r"(GP\d{3})/(.+)", shared):
        return f"`{other[2]}` of [{other[1]}]({other[1]}.md#files)"
    if name in ("zero", "none"):
        return f"`{name}`" if name == "zero" else "none"
    return f"[{shared}]({shared})" if name != shared else f"`{name}`"


MOST_CHANGES = 12
"""Lines of a difference that help a reader; more are a file of their own."""

_HEADING = re.compile(r"\[\[?[\w.-]+\]\]?")


def differences(folder: Path, dialect: str) -> list[str]:
    """Blocks that show what the files of the bad and the good run differ in, where that is little."""
    bad, good = (settings(folder, dialect, side) for side in ("bad", "good"))
    out = []
    for key in ("machine", "setup"):
        names = (bad[key], good[key])
        if names[0] == names[1] or {"zero", "none"} & set(names):
            continue
        lines = _changes(*(folder / name for name in names))
        if 0 < len(lines) <= MOST_CHANGES:
            first, second = (_named(name) for name in names)
            second = "the shared one" if second == f"the shared {first}" else second
            out.append("\n".join([f"From {first} to {second} this changes:", "", "```diff", *lines, "```"]))
    return out


def _named(name: str) -> str:
    """A file as a sentence calls it."""
    shared = name.removeprefix("../")
    if other := re.fullmatch(r"(GP\d{3})/(.+)", shared):
        return f"`{other[2]}` of {other[1]}"
    return f"{'the shared ' * (name != shared)}`{shared}`"


def _changes(*files: Path) -> list[str]:
    """Lines that go and come, each below the heading of its table; comments and empty lines do not count."""
    one, other = ([line for line in path.read_text("utf-8", "replace").splitlines() if _counts(line)] for path in files)
    has_tables = "WINCNC.INI" not in {path.name for path in files}
    out: list[str] = []
    heading = said = ""
    for line in difflib.ndiff(one, other):
        mark, text = line[0], line[2:]
        is_heading = has_tables and _HEADING.fullmatch(text)
        heading = text if is_heading else heading
        if mark not in "-+":
            continue
        if heading != said and not is_heading:
            out.append(f" {heading}")
        said = heading
        out.append(f"{mark}{text}")
    return out if all(line.isprintable() for line in out) and "\ufffd" not in "".join(out) else []


def _counts(line: str) -> bool:
    """Whether it is more than a comment: those of WINCNC.INI are in brackets, as its headings are."""
    return bool(line.strip()) and not line.startswith("#") and not (line.startswith("[") and " " in line)
