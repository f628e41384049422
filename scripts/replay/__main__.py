"""Run two revisions of gproof over all programs of the project, and list where they differ.

``make replay BASE=rev`` compares the working tree with the git revision: every program of ``corpus/``, ``docs/codes``,
``tests/hand`` and ``tests/differential`` (cases.py), in all that a user can see of it (worker.py): verdicts and
findings as JSON, text and SARIF, the text of each stage, where the zero may go, the formatted program, the body of its
package.
Both revisions read the programs of the tree at hand.

What differs only in the words of a sentence, with the same code, place, numbers and names (wordings.py), is listed
once at the end, apart from the differences.

``--mapping FILE``: a change of form that was announced. The file has a class ``Mapping``, made with the folder of the
other revision's packages, whose ``common(before, now)`` brings the texts of a program, by aspect, to one form: what is
the same then is explained.

``--files`` runs nothing: it says whether each case of the revision is here with the same program, machine, setup and
options, under its name or another one (moved.py).

Exit code 0: the same bytes everywhere, or other words for the same, or explained; 1: something differs; 3: could not
compare, which includes that a language has no program that gives a package.
"""

from __future__ import annotations

import argparse
import difflib
import os
import runpy
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Protocol

from cases import ROOT, SUFFIXES, Case, all_cases
from moved import cases_of, lost
from revisions import NotComparable, Runner, site_of_revision, tree_of_revision
from wordings import Wordings
from worker import FAILED, came_to_nothing


def question(case: Case, *, whole: bool) -> dict[str, Any]:
    """What the workers are asked."""
    fmt = ["--dialect", case.dialect]
    if case.dialect == "wincnc" and case.machine is not None:
        fmt += ["--machine", str(case.machine)]
    program = str(case.program)
    return {"words": case.words(), "check": list(case.check), "fmt": fmt, "program": program, "whole": whole}


NEEDED = ("check", "check, json", "check, sarif", "check, as its page", "dump, program", "dump, trace", "dump, plan")
NEEDED += ("dump, stream", "dump, jsonl", "fit", "fmt", "compile", "compile, body")
"""Each language has to have a program that gives each of these, or nothing was compared."""


@dataclass(frozen=True)
class Result:
    """Of one case: by aspect that differs both texts; ran: aspects in which both did their work; explained: those that
    a mapping makes the same.
    """

    case: Case
    differing: dict[str, tuple[str, str]]
    ran: list[str]
    explained: list[str]


class Mapping(Protocol):
    """What explains an announced change of form."""

    def common(self, before: dict[str, str], now: dict[str, str]) -> tuple[dict[str, str], dict[str, str]]:
        """Both sides of one program, by aspect, in one form."""
        ...


def mapping_of(file: Path, base: Path) -> Mapping:
    """The mapping of a file, for a revision's packages."""
    found: Mapping = runpy.run_path(str(file))["Mapping"](base)
    return found


class Pair:
    """Both revisions, each in a process."""

    def __init__(self, base: Path, mapping: Mapping | None) -> None:
        self._both = Runner(base), Runner(None)
        self._mapping = mapping

    def compare(self, case: Case) -> Result:
        """Hashes first; the texts only of what differs. With a mapping all texts, for all may differ."""
        if self._mapping is not None:
            return self._mapped(case, self._mapping)
        before, now = self._ask(question(case, whole=False))
        names = [name for name in before | now if before.get(name) != now.get(name)]
        differing = {}
        if names:
            first, second = self._ask(question(case, whole=True))
            differing = {name: (first.get(name, ""), second.get(name, "")) for name in names}
        ran = [name for name in now if FAILED not in (before.get(name, FAILED)[0], now[name][0])]
        return Result(case, differing, ran, [])

    def _mapped(self, case: Case, mapping: Mapping) -> Result:
        first, second = self._ask(question(case, whole=True))
        names = [name for name in first | second if first.get(name) != second.get(name)]
        nothing = {name for side in (first, second) for name, text in side.items() if came_to_nothing(text.encode())}
        ran = [name for name in second if name in first and name not in nothing]
        one, other = mapping.common(first, second)
        differing = {n: (one.get(n, ""), other.get(n, "")) for n in names if one.get(n) != other.get(n)}
        return Result(case, differing, ran, [name for name in names if name not in differing])

    def _ask(self, asked: dict[str, Any]) -> tuple[dict[str, str], dict[str, str]]:
        for runner in self._both:
            runner.ask(asked)
        return self._both[0].answer(), self._both[1].answer()

    def close(self) -> None:
        for runner in self._both:
            runner.close()


def compared(cases: list[Case], base: Path, mapping: Mapping | None) -> Iterator[Result]:
    """Results in the order of the cases; a pair of processes for each two processors."""
    count = max(1, (os.cpu_count() or 2) // 2)
    free: SimpleQueue[Pair] = SimpleQueue()
    pairs = [Pair(base, mapping) for _ in range(count)]
    for pair in pairs:
        free.put(pair)

    def one(case: Case) -> Result:
        pair = free.get()
        try:
            return pair.compare(case)
        finally:
            free.put(pair)

    try:
        with ThreadPoolExecutor(count) as threads:
            yield from threads.map(one, cases)
    finally:
        for pair in pairs:
            pair.close()


def shown(texts: tuple[str, str], lines: int) -> list[str]:
    """The first lines in which two texts differ."""
    differing = difflib.unified_diff(*(text.splitlines() for text in texts), "base", "now", n=0, lineterm="")
    told = [f"    {line[:200]}" for line in differing][2:]
    return [*told[:lines], "    ..."] if len(told) > lines else told


def same_files(revision: str) -> int:
    """Whether each case of a revision is here with its files; prints those that are not."""
    try:
        with tree_of_revision(revision) as tree:
            before, now = cases_of(tree), cases_of(ROOT)
    except NotComparable as why:
        print(f"replay: {why}", file=sys.stderr)
        return 3
    missing = list(lost(before, now))
    moved = {case.name for case in before} - {case.name for case in now}
    print(*missing, sep="\n", end="\n" if missing else "")
    print(f"replay: {len(before)} cases, {len(now)} here; {len(moved)} have another name, {len(missing)} other files")
    return 1 if missing else 0


def main(words: list[str] | None = None) -> int:
    """Compare all cases; prints each difference, and a summary."""
    parser = argparse.ArgumentParser(prog="make replay", description="Compare with another revision.")
    parser.add_argument("base", help="git revision, or a folder of installed packages")
    parser.add_argument("--only", action="append", default=[], help="cases whose name has this text; repeatable")
    parser.add_argument("--lines", type=int, default=12, help="lines of each difference [12]")
    parser.add_argument("--mapping", type=Path, help="a file that explains an announced change of form")
    parser.add_argument("--files", action="store_true", help="compare only which cases there are, and their files")
    asked = parser.parse_args(words)
    if asked.files:
        return same_files(asked.base)
    cases = [case for case in all_cases() if not asked.only or any(part in case.name for part in asked.only)]
    programs: Counter[str] = Counter()
    differing: Counter[str] = Counter()
    ran: Counter[tuple[str, str]] = Counter()
    explained: Counter[str] = Counter()
    wordings = Wordings()
    try:
        base = Path(asked.base) if (Path(asked.base) / "gproof").is_dir() else site_of_revision(asked.base)
        mapping = None if asked.mapping is None else mapping_of(asked.mapping, base.resolve())
        for done, result in enumerate(compared(cases, base.resolve(), mapping), 1):
            programs[result.case.dialect] += 1
            real = wordings.explain(result.differing)
            differing.update(real.keys())
            explained.update(result.explained)
            ran.update((result.case.dialect, name) for name in result.ran)
            for name, texts in real.items():
                print(f"{result.case.name}: {name} differs", *shown(texts, asked.lines), sep="\n", flush=True)
            if sys.stderr.isatty():
                print(f"\r{done} of {len(cases)}", end="", file=sys.stderr)
    except NotComparable as why:
        print(f"replay: {why}", file=sys.stderr)
        return 3
    print(*wordings.lines(), sep="\n", end="\n" * bool(wordings.count))
    for dialect in SUFFIXES:
        print(f"{dialect}: {programs[dialect]} programs, {ran[dialect, 'compile, body']} gave a package on both sides")
    for name, count in differing.most_common():
        print(f"{name}: {count} differ")
    if wordings.count:
        print(f"wording: {len(wordings.count)} sentences changed, {sum(wordings.count.values())} times")
    for name, count in explained.most_common():
        print(f"{name}: {count} explained")
    if asked.mapping is None:
        print(f"replay: {sum(programs.values())} programs, {sum(differing.values())} differences")
    else:
        of = f"{sum(explained.values())} differences explained, {sum(differing.values())} unexplained"
        print(f"replay: {sum(programs.values())} programs, {of}")
    empty = [f"{name} of {dialect}" for dialect in SUFFIXES for name in NEEDED if not ran[dialect, name]]
    ran_at_all = {name for _, name in ran}
    if not differing and (not ran_at_all or (empty and not asked.only)):
        print(f"replay: nothing was compared: {', '.join(empty)}", file=sys.stderr)
        return 3
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
