"""One test for many cases: all are run, those that fail are named with what went wrong and where."""

from __future__ import annotations

import pytest
from support.each import SHOWN, each

seen: list[object] = []


@pytest.fixture
def ten() -> int:
    return 10


@each("one,other", [(1, 11), (2, 12), (3, 13)])
def test_every_case_is_run_with_the_fixtures(one: int, ten: int, other: int) -> None:
    seen.append(one)
    assert one + ten == other


def test_all_of_them() -> None:
    assert seen in ([1, 2, 3], [])  # another process of pytest may have had the test before


def test_every_failure_is_named() -> None:
    @each("n", range(4), ids=lambda n: f"case {n}")
    def odd(n: int) -> None:
        if n == 0:
            raise KeyError("gone")
        assert n % 2 == 1, f"{n} is even"

    with pytest.raises(pytest.fail.Exception) as found:
        odd()
    first, second, third = str(found.value).splitlines()[:3]
    assert first == "2 of 4 cases:"
    assert second.startswith("case 0: test_each.py:") and second.endswith("KeyError: 'gone'")
    assert third.startswith("case 2: test_each.py:") and "AssertionError: 2 is even" in third


def test_of_very_many_the_last_have_their_names_alone() -> None:
    @each("n", range(SHOWN + 2), ids=lambda n: f"case {n}")
    def never(n: int) -> None:
        raise ValueError(f"of {n}")

    with pytest.raises(pytest.fail.Exception) as found:
        never()
    assert str(found.value).splitlines()[-2:] == [f"case {SHOWN}", f"case {SHOWN + 1}"]


def test_marks_stay() -> None:
    @each("n", [1])
    @pytest.mark.usefixtures("ten")
    def test(n: int) -> None:
        assert n

    assert [mark.name for mark in test.pytestmark] == ["usefixtures"]


def test_an_argument_that_the_test_does_not_take() -> None:
    with pytest.raises(AssertionError):
        each("m", [1])(lambda n: None)
