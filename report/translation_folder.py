"""What the translation of a folder did: one line a program, then what all of them rest on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from gproof.ir.verdict import Verdict, worst
from gproof.report.translation_text import TranslatedProgram, markdown_of


def folder_lines(done: Sequence[TranslatedProgram], called: Mapping[Path, Path]) -> list[str]:
    """What comes after the lines of the programs."""
    lines = [f"{file}: part of {caller}" for file, caller in called.items()]
    lines += [f"  assumed{where}: {text}" for text, where in _assumed(done)]
    proven = sum(one.verdict is Verdict.SAFE for one in done)
    refuted = sum(one.verdict is Verdict.UNSAFE for one in done)
    counts = f"{proven} proven, {refuted} refuted, {len(done) - proven - refuted} not translated or not proven"
    return [*lines, f"{len(done)} program{'s' if len(done) != 1 else ''}: {counts}"]


def _assumed(done: Sequence[TranslatedProgram]) -> list[tuple[str, str]]:
    """(sentence, of how many programs, nothing for all) of those that are proven."""
    proven = [one for one in done if one.verdict is Verdict.SAFE]
    counts = Counter(text for one in proven for text in one.assumed)
    return [(text, "" if n == len(proven) else f" for {n} of {len(proven)}") for text, n in counts.items()]


def folder_json(done: Sequence[TranslatedProgram], called: Mapping[Path, Path]) -> dict[str, Any]:
    """The same for programs."""
    verdict = worst(one.verdict for one in done)
    return {
        "schema": "gproof-translation-folder/1",
        "verdict": verdict.value,
        "exit_code": verdict.exit_code,
        "programs": [one.data for one in done],
        "called": {str(file): str(caller) for file, caller in called.items()},
    }


def folder_markdown(done: Sequence[TranslatedProgram], called: Mapping[Path, Path], folder: Path) -> str:
    """The same as a page: a table, then a part for each program."""
    title = done[0].target if done else ""
    lines = [f"# {folder.name} for {title}", "", "| program | verdict |", "|---|---|"]
    lines += [f"| {one.job.relative_to(folder)} | {one.verdict.value} |" for one in done]
    lines += [
        f"| {file.relative_to(folder)} | part of {caller.relative_to(folder)} |" for file, caller in called.items()
    ]
    return "\n".join(lines) + "\n\n" + "\n\n".join(markdown_of(one, "##") for one in done)
