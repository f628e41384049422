"""Many small cases as one test: it goes over all of them and names every one that fails.

pytest costs some milliseconds for each test, more than a look at a row of a table. What takes long, or is best run
alone, stays with ``pytest.mark.parametrize``.
"""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

SHOWN = 40
"""Failures whose message is in the report; of more only the names."""


def each(names: str, cases: Iterable[Any], ids: Callable[[Any], str] | None = None) -> Callable[[Any], Any]:
    """Like ``parametrize``: ``names`` of arguments with commas, a value or a tuple of values for each case.

    Fixtures are the same for all cases. ids: the name of a case from each of its values.
    """
    arguments = names.split(",")
    given = [case if len(arguments) > 1 else (case,) for case in cases]
    assert given, "no cases"

    def name_of(case: tuple[Any, ...]) -> str:
        return " ".join(map(ids or str, case)).strip()

    def decorate(test: Any) -> Any:
        def all_cases(**fixtures: Any) -> None:
            wrong: list[tuple[str, str]] = []
            for case in given:
                try:
                    test(**dict(zip(arguments, case, strict=True)), **fixtures)
                except (Exception, pytest.fail.Exception) as error:
                    wrong.append((name_of(case), _told(error)))
            if wrong:
                texts = [f"{name}: {text}" for name, text in wrong[:SHOWN]] + [name for name, _ in wrong[SHOWN:]]
                pytest.fail(f"{len(wrong)} of {len(given)} cases:\n" + "\n".join(texts), pytrace=False)

        given_by_pytest = [one for name, one in inspect.signature(test).parameters.items() if name not in arguments]
        assert len(given_by_pytest) + len(arguments) == len(inspect.signature(test).parameters), names
        keywords = [one.replace(kind=inspect.Parameter.KEYWORD_ONLY) for one in given_by_pytest]
        all_cases.__signature__ = inspect.Signature(keywords)  # type: ignore[attr-defined]
        for what in ("__name__", "__qualname__", "__module__", "__doc__"):
            setattr(all_cases, what, getattr(test, what))
        all_cases.pytestmark = list(getattr(test, "pytestmark", []))  # type: ignore[attr-defined]
        return all_cases

    return decorate


def _told(error: BaseException) -> str:
    """What went wrong, and the lines of the tests that it came by."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != __file__]
    places = [
        f"{Path(frame.filename).name}:{frame.lineno}" for frame in frames if "site-packages" not in frame.filename
    ]
    return f"{' > '.join(places)}: {type(error).__name__}: {error}"
