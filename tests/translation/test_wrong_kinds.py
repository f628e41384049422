"""Kinds of wrong translation on every pair of the traps: none is proven.

``wrong_moves.py`` and ``wrong_events.py`` say what a kind does to a target, and where that changes what the machine
does: by the manuals, never by the validator. So a text that is proven here is a wrong proof, or a rule that is wrong.
"""

from __future__ import annotations

import dataclasses
import random
import shutil
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from support.campaigns import seeds
from support.each import each
from support.traps import READ, Case, cases
from translation.target_text import Text
from translation.test_traps_proved import OF_BOTH, terms_of, traced
from translation.test_traps_proved import _traced as fresh_trace
from translation.wrong_moves import KINDS

import translation.wrong_events  # registers its kinds  # isort: skip
from gproof.ir.program import NO_OUTPUTS
from gproof.ir.translation_terms import SymbolMeaning
from gproof.ir.verdict import Verdict
from gproof.verify.translation.compare import compare
from gproof.verify.translation.rs274_reader import GRBL, LINUXCNC, read_back

assert translation.wrong_events
OTHERS = {"linuxcnc": LINUXCNC, "grbl": GRBL}
"""Languages that only the validator's own reader reads."""
HEAD = b"G40 G80 G91.1\n"
"""Modes that it takes from no earlier program, and that the pages leave out."""
PAIRS = [(case, name) for case in cases() if not case.unproven for name in case.programs("target")]
NO_LENGTH = (SymbolMeaning(symbol="tool.0.z"),)
"""No case has tool lengths."""
PARTS = 40
"""Parts of all wrong texts; the first one in every run."""


@cache
def wrong_texts(case: Case, name: str) -> dict[str, list[tuple[str, str]]]:
    """By kind the wrong texts of a target: the file, its text."""
    files = [name, *(n for n in case.section.files if n.startswith("target/") and n.endswith(".TAP"))]
    found: dict[str, list[tuple[str, str]]] = {}
    for file in files:
        text = case.section.files[file].decode()
        if file == name or case.dialect(name) == "wincnc":
            read = Text(text, case.dialect(name), called=file != name)
            for kind, wrong in KINDS.items():
                found.setdefault(kind, []).extend((file, new) for new in dict.fromkeys(wrong(read)) if new != text)
    return found


def judged(case: Case, name: str, file: str, text: str, folder: Path) -> Verdict:
    """SAFE where the validator proves a wrong text in each state of the setup that it may rest on."""
    section = dataclasses.replace(case.section, files=case.section.files | {file: text.encode()})
    wrong = Case(case.name, section)
    answer = Verdict.SAFE
    for state in {str({k: v for k, v in state.items() if k not in OF_BOTH}): state for state in case.setups()}.values():
        known = state if case.dialect(name) in READ else state | {"tool": None}
        source, one, is_open = traced(case, case.source, known, folder)
        assert one is not None and not is_open
        language = OTHERS.get(case.dialect(name))
        if language is not None:
            back = read_back({"": HEAD + text.encode()}, name, language, source.machine)
            terms = dataclasses.replace(
                terms_of(case, name, source, source), target_outputs=NO_OUTPUTS, target_symbols=NO_LENGTH
            )
            other, is_bad = back.trace, bool(back.unread)
        else:
            target, found, is_bad = fresh_trace(wrong, name, state, folder)
            if found is None:
                return Verdict.UNKNOWN
            terms, other = terms_of(case, name, source, target), found
        verdict = compare(one, other, terms).verdict
        if verdict is Verdict.UNSAFE:
            return verdict
        if is_bad or verdict is Verdict.UNKNOWN:
            answer = Verdict.UNKNOWN
    return answer


def test_there_are_sixty_kinds_and_each_has_a_place() -> None:
    places = Counter(kind for case, name in PAIRS for kind, texts in wrong_texts(case, name).items() if texts)
    assert len(KINDS) >= 60
    assert sorted(KINDS.keys() - places.keys()) == []


@each("case,name", [pair for pair in PAIRS if pair[0].dialect(pair[1]) in OTHERS])
def test_right_targets_of_the_reader_are_proven(case: Case, name: str, tmp_path: Path) -> None:
    assert judged(case, name, name, case.section.files[name].decode(), tmp_path) is Verdict.SAFE


def parts(count: int) -> list[list[tuple[str, Case, str, str, str]]]:
    """All wrong texts in so many parts, each of which has of all kinds."""
    found: list[list[tuple[str, Case, str, str, str]]] = [[] for _ in range(count)]
    for kind in KINDS:
        texts = [(kind, *pair, *one) for pair in PAIRS for one in wrong_texts(*pair).get(kind, ())]
        random.Random(kind).shuffle(texts)
        for n, one in enumerate(texts):
            found[n % count].append(one)
    return found


@pytest.mark.parametrize("part", seeds(1, PARTS))
def test_no_wrong_translation_is_proven(part: int, tmp_path: Path) -> None:
    proven = []
    for n, (kind, case, name, file, text) in enumerate(parts(PARTS)[part]):
        folder = tmp_path / str(n)
        if judged(case, name, file, text, folder) is Verdict.SAFE:
            proven.append((kind, case.name, name, text))
        shutil.rmtree(folder, ignore_errors=True)
    assert proven == []
