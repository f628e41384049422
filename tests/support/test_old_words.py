"""The list of old words finds what it names, and nothing else."""

from __future__ import annotations

import pytest
from support.old_words import old_words, prose


@pytest.mark.parametrize(
    "text",
    [
        "text behind a comment",
        "which nobody\nstated",
        "it stands in the file",
        "Begins here",
        "a clearance of 1 mm is asked for",
        "it can not be read",
        "at the least 3",
        "Findings that fail; unknown else.",
    ],
)
def test_an_old_word_is_found(text: str) -> None:
    """Across lines and in capitals too."""
    assert len(old_words(text)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "GP531 spindle-not-told",
        "the spindle stands still",
        "T stands for the tool",
        "a standard",
        "understand",
        "go on",
    ],
)
def test_other_words_are_not(text: str) -> None:
    """Names, and phrases in which the word is right."""
    assert old_words(text, message=True) == []


def test_messages_have_more_of_them() -> None:
    """Rapid is the word at the machine."""
    assert old_words("a traverse") == []
    assert old_words("a traverse", message=True) == ["traverse: rapid, rapid move"]


def test_prose_is_a_page_without_its_code() -> None:
    """Blocks, code in lines, addresses; lines keep their numbers."""
    page = "one `behind`\n\n```console\n$ told\n```\n[two](begins.md) mend\n"
    assert old_words(prose(page)) == ["mend: fix"]
    assert prose(page).count("\n") == page.count("\n")
