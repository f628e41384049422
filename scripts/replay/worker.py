"""Runs one revision's gproof inside this process, a case a line, and answers with what each command left behind.

``worker.py ENTRY [FOLDER]``: ENTRY is ``module:function`` of the command; FOLDER has to hold the module. A line of
standard input is ``{"words": [...], "check": [...], "program": ..., "whole": bool}``; the answer, a line too, has by
aspect a hash, or with ``whole`` the text. What gproof prints never reaches the answer's pipe.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import io
import json
import os
import sys
import tempfile
import traceback
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

STAGES = ("program", "trace", "plan", "stream")
REPORTS = ("json", "sarif")
NO_REPORT, NO_PACKAGE = b"no report", b"no package"
FAILED = "-"
"""Before a hash: the command could not run, or wrote nothing."""

COULD_NOT_RUN = b"\n--- exit 3\n"
Main = Callable[[list[str]], int]


def run(main: Main, words: list[str]) -> bytes:
    """What a command prints, on both channels, and its exit code."""
    out, err = io.BytesIO(), io.BytesIO()
    with (
        io.TextIOWrapper(out, "utf-8", write_through=True) as output,
        io.TextIOWrapper(err, "utf-8", write_through=True) as errors,
        contextlib.redirect_stdout(output),
        contextlib.redirect_stderr(errors),
    ):
        try:
            code: Any = main(words)
        except SystemExit as left:
            code = left.code
        except Exception:  # counts as a command that could not run, or two revisions that both fail would be alike
            traceback.print_exc()
            code = 3
        printed = out.getvalue() + b"\n--- standard error\n" + err.getvalue()
    return printed + f"\n--- exit {code}\n".encode()


def aspects(main: Main, case: dict[str, Any], scratch: Path) -> dict[str, bytes]:
    """All that a user can see of one program."""
    words, found = case["words"], {}
    reports = {form: scratch / f"report.{form}" for form in REPORTS}
    asked = [f"--report={form}={path}" for form, path in reports.items()]
    found["check"] = run(main, ["check", *words, "--also", "all", *asked])
    for form, path in reports.items():
        found[f"check, {form}"] = path.read_bytes() if path.is_file() else NO_REPORT
    found["check, as its page"] = run(main, ["check", *words, *case["check"]]) if case["check"] else b""
    for stage in STAGES:
        found[f"dump, {stage}"] = run(main, ["dump", *words, "--stage", stage])
    found["dump, jsonl"] = run(main, ["dump", *words, "--stage", "trace", "--format", "jsonl"])
    found["fit"] = run(main, ["fit", *words, "--format", "json"])
    found["fmt"] = run(main, ["fmt", case["program"], "--stdout", *case["fmt"]])
    package = scratch / "job.gpx"
    found["compile"] = run(main, ["compile", *words, "--unsigned", "-o", str(package)])
    found["compile, body"] = NO_PACKAGE
    if package.is_file():
        with zipfile.ZipFile(package) as archive:
            found["compile, body"] = archive.read("body.json")
            found |= {f"compile, {name}": archive.read(name) for name in archive.namelist() if name.endswith(".ir")}
    for path in (*reports.values(), package):
        path.unlink(missing_ok=True)
    return found


def answer(found: dict[str, bytes], whole: bool, scratch: Path) -> dict[str, str]:
    """By aspect the text, or its hash, marked where nothing could be run; the scratch folder is left out of it."""
    plain = {name: text.replace(str(scratch).encode(), b"SCRATCH") for name, text in found.items()}
    if whole:
        return {name: text.decode("utf-8", "backslashreplace") for name, text in plain.items()}
    return {
        name: FAILED * came_to_nothing(text) + hashlib.sha256(text).hexdigest()[:16] for name, text in plain.items()
    }


def came_to_nothing(text: bytes) -> bool:
    """Whether the command could not run, or wrote nothing."""
    return text.endswith(COULD_NOT_RUN) or text in (b"", NO_REPORT, NO_PACKAGE)


def start(entry: str, folder: str | None) -> Main:
    """The command's function; refuses one from another folder than the revision's own."""
    module, _, name = entry.partition(":")
    main: Main = getattr(importlib.import_module(module), name)
    found = Path(sys.modules[module].__file__ or "")
    if folder is not None and not found.is_relative_to(folder):
        sys.exit(f"replay: {module} is imported from {found}, not from {folder}")
    return main


def serve() -> None:
    """Answer line by line, until standard input ends."""
    pipe = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what anything below prints past sys.stdout
    main = start(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None)
    with tempfile.TemporaryDirectory() as folder:
        for line in sys.stdin:
            case = json.loads(line)
            found = answer(aspects(main, case, Path(folder)), case["whole"], Path(folder))
            print(json.dumps(found), file=pipe, flush=True)


if __name__ == "__main__":
    serve()
