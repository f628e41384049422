"""What a fresh process executes of gproof to prove streams again: run as a program, it proves what is handed to it.

The program takes jobs in a file; it prints what it loaded and which functions were entered: ``count`` counts lines.
"""

from __future__ import annotations

import ast
import io
import json
import pickle
import subprocess
import sys
import tokenize
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, NamedTuple

SCHEMAS = {"trace": "gproof.ir.trace.TRACE_ROW", "runs": "gproof.ir.stream.RUN", "events": "gproof.ir.stream.EVENT"}
"""Tables are known by their schema itself, not by an equal one."""

NO_CODE = {
    tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER,
}  # fmt: skip


def packed(jobs: list[tuple[Any, Any, Any]]) -> bytes:
    """Streams, traces and drives, for the program."""

    class Pickler(pickle.Pickler):
        def persistent_id(self, value: Any) -> str | None:
            return SCHEMAS[value.name] if type(value).__name__ == "Schema" else None

    out = io.BytesIO()
    Pickler(out).dump(jobs)
    return out.getvalue()


class Lines(NamedTuple):
    """all: with docstrings, comments and blank lines; code: without; executed: code, but for functions that were never
    entered."""

    all: int
    code: int
    executed: int


class Proved(NamedTuple):
    """lines: by module of gproof that was loaded; modules: all that were; verdicts: of the jobs."""

    lines: dict[str, Lines]
    modules: frozenset[str]
    verdicts: tuple[str, ...]

    def total(self) -> Lines:
        return Lines(*map(sum, zip(*self.lines.values(), strict=True)))


def count(jobs: list[tuple[Any, Any, Any]], folder: Path, *, pure: bool = True) -> Proved:
    """Prove the jobs in a fresh process."""
    given = folder / "jobs"
    given.write_bytes(packed(jobs))
    words = [sys.executable, str(Path(__file__).resolve()), str(given), "pure" if pure else "compiled"]
    done = subprocess.run(words, check=False, capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    entered: dict[str, set[tuple[int, str]]] = {}
    for file, line, name in said["entered"]:
        entered.setdefault(file, set()).add((line, name))
    lines = {name: _lines(Path(file), entered.get(file, set())) for name, file in said["files"].items()}
    return Proved(lines, frozenset(said["modules"]), tuple(said["verdicts"]))


def _lines(file: Path, entered: set[tuple[int, str]]) -> Lines:
    source = file.read_text(encoding="utf-8")
    tree = ast.parse(source)
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in NO_CODE:
            code.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            code.difference_update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return Lines(len(source.splitlines()), len(code), len(code - _never(tree, entered)))


def _never(tree: ast.AST, entered: set[tuple[int, str]]) -> set[int]:
    """Lines of functions that were never entered."""
    lines: set[int] = set()
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
            if not {(first, node.name), (node.lineno, node.name)} & entered:
                lines.update(range(first, (node.end_lineno or first) + 1))
                continue
        lines |= _never(node, entered)
    return lines


def main() -> None:
    """Prove the jobs of a file; nothing of gproof is imported but what proves, and what the jobs are made of."""
    pure = sys.argv[2] == "pure"
    entered: set[CodeType] = set()

    def seen(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            entered.add(frame.f_code)

    sys.setprofile(seen)
    from gproof.verify.kernel.prove import prove

    class Unpickler(pickle.Unpickler):
        def persistent_load(self, name: str) -> Any:
            module, _, attribute = name.rpartition(".")
            return getattr(sys.modules[module], attribute)

    with Path(sys.argv[1]).open("rb") as file:
        jobs = Unpickler(file).load()
    verdicts = [prove(*job, pure=pure).verdict.value for job in jobs]
    sys.setprofile(None)
    loaded = {name: module.__file__ for name, module in list(sys.modules.items()) if name.startswith("gproof.")}
    files = {name: file for name, file in sorted(loaded.items()) if file}
    own = set(files.values())
    calls = [(code.co_filename, code.co_firstlineno, code.co_name) for code in entered if code.co_filename in own]
    print(json.dumps({"files": files, "entered": calls, "modules": sorted(sys.modules), "verdicts": verdicts}))


if __name__ == "__main__":
    main()
