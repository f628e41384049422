"""The ready-made operators."""

import pytest

from gproof.backend.control import Control
from gproof.backend.operators import AutoContinue, HoldRequest, RefuseAll, Terminal, WaitRequest
from gproof.ir.trace import Wait


def request(wait: Wait = Wait.OPERATOR, *outcomes: str) -> WaitRequest:
    return WaitRequest(wait=wait, section=0, line=7, text="turn the part", outcomes=outcomes or ("on",))


HELD = HoldRequest(section=0, tick=5)


def test_auto_continue_answers_only_for_people() -> None:
    auto = AutoContinue()
    assert auto.wait(request()) == "on"
    assert auto.wait(request(Wait.TOOL_CHANGE)) == "on"
    assert auto.wait(request(Wait.OPERATOR, "a", "b")) is None
    for wait in (Wait.INPUT, Wait.PROBE, Wait.HOME, Wait.BRANCH, Wait.UNKNOWN):
        assert auto.wait(request(wait)) is None
    assert not auto.held(HELD)
    assert AutoContinue(resume=True).held(HELD)
    assert RefuseAll().wait(request()) is None
    assert not RefuseAll().held(HELD)


def terminal(*lines: str) -> tuple[Terminal, list[str]]:
    said: list[str] = []
    left = list(lines)

    def ask(prompt: str) -> str:
        said.append(prompt)
        if not left:
            raise EOFError
        return left.pop(0)

    return Terminal(ask, said.append), said


@pytest.mark.parametrize(
    ("lines", "outcomes", "answer"),
    [
        ([""], ["on"], "on"),
        (["q"], ["on"], None),
        ([], ["on"], None),
        (["7", "x", "2"], ["a", "b"], "b"),
        (["QUIT"], ["a", "b"], None),
    ],
)
def test_the_terminal_asks(lines: list[str], outcomes: list[str], answer: str | None) -> None:
    person, said = terminal(*lines)
    assert person.wait(request(Wait.OPERATOR, *outcomes)) == answer
    assert said[0] == "line 7: turn the part"


def test_the_terminal_asks_in_a_hold() -> None:
    assert terminal("")[0].held(HELD)
    assert not terminal("q")[0].held(HELD)


def test_control_counts_interrupts() -> None:
    control = Control()
    control.interrupt()
    assert control.hold_asked
    assert not control.stop_asked
    control.interrupt()
    assert control.stop_asked
    control = Control()
    control.hold()
    control.answered()
    assert not control.hold_asked
    assert control.ask(lambda: 5) == 5
    assert control.ask(control.interrupt) is None
    assert not control.hold_asked
