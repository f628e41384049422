"""What a run of a page's programs (docs/codes/GPnnn) takes: machine, setup, command and options.

A folder has a pair for each controller whose jobs the code can be told of: `bad.cnc` and `good.cnc` for Eding CNC,
`.tap` for WinCNC, `.src` for McuWIN; `cells.toml` beside this file says for which controllers there is none, and why.
They run on the shared machine and setup of docs/codes, docs/codes/wincnc or docs/codes/mcuwin, or on the folder's own
(`WINCNC.INI`, `setup.toml` for WinCNC, `machine.toml` for McuWIN where it has no other pair).

`run.toml` in a folder says what is special about it: `setup` ("zero", "none" or a file), `machine` (a file), `program`
(one program for both runs; the machine or setup differs), `command` ("check" or "compile"), `options` (further
arguments); `[bad]` and `[good]` override single keys. That holds for the folder's first pair in the order above, or
the one that `dialect` names; tables `[eding]`, `[wincnc]`, `[mcuwin]`, with the same keys, for the others.

Imports nothing of gproof: `make replay` runs the same programs with another revision.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs" / "codes"
FOLDERS = sorted(DOCS.glob("GP*"))
DEFAULTS = {"setup": "../setup.toml", "machine": "../machine.toml", "command": "check", "options": []}
SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}


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
