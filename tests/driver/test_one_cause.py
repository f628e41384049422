"""One mistake of a McuWIN program makes one finding, hides no other one, and proves nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
from gproof.ir.finding import Severity
from gproof.ir.verdict import Verdict

MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n' + "".join(
    f"[axes.{axis}]\nmin = -100\nmax = 100\nmax_velocity = 50\nmax_acceleration = 500\nposition_unit = 'mm'\n"
    for axis in "xyz"
)
SETUP = (
    'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 0.0, y = 0.0, z = 0.0}\n'
    "g92 = {x = 0.0, y = 0.0, z = 0.0}\n"
)


def judged(tmp_path: Path, text: str, **files: str) -> tuple[Verdict, list[tuple[str, int, str]], dict[str, Verdict]]:
    for name, content in {"machine.toml": MACHINE, "setup.toml": SETUP, "job.src": text, **files}.items():
        (tmp_path / name).write_text(content)
    job, machine, setup = (tmp_path / name for name in ("job.src", "machine.toml", "setup.toml"))
    session = open_session(job, machine=machine, setup=str(setup), dialect="mcuwin")
    judgement = judge(session, running=Running(10_000))
    shown = [
        (f.code.label, f.span.line, f.message)
        for f in session.findings.kept
        if f.severity in (Severity.ERROR, Severity.UNKNOWN)
    ]
    return judgement.verdict, shown, {one.name: one.verdict for one in judgement.properties}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("%A\nG00 X1\nM96 L30\nM30\n%\n", [("GP143", 3)]),
        ("%A\nG00 X1\n$goto 30;\nM30\n%\n", [("GP136", 3)]),
        ("%A\nG00 X1\n$goto 30;\nL30\nM30\n%\n", [("GP136", 3)]),
        ("$DINEND\nlabel 30;\n{$DINSTART}\n%A\nG00 X1\n$goto 30;\nM30\n%\n", [("GP143", 6)]),
        ("%A\nG00 X1\nM98 L30\nM30\n%\n", [("GP115", 3)]),
        ("%A\nG00 X1\n%\n", [("GP141", 1)]),
        ("%A\nM98 L30\nM30\n%\n%30\nG00 X1\n%\n", [("GP141", 5)]),
        ("%A\nM96 L30\n$if (true) then begin\nL30\nG00 X1\n$end\nM30\n%\n", [("GP144", 2)]),
        # What would have run may have changed anything: nothing is said of where the next move goes.
        ("%A\nM96 L30\nG00 X300\nM30\n%\n", [("GP143", 2)]),
        ("%A\nM98 L30\nG00 X300\n%\n", [("GP115", 2), ("GP141", 1)]),
        # A module that has an end, and a way past it: nobody else tells of that one.
        ("%A\nM98 L30\nM30\n%\n%30\n$if (X.digib.1) then begin\nM17\n$end\nG00 X1\n%\n", [("GP515", 9)]),
        ("%A\nM98 L30\nM98 L40\nM30\n%\n%30\n$if (X.digib.1) then begin\nM17\n$end\n%\n%40\nG00 X1\n%\n",
         [("GP141", 11), ("GP515", 9)]),
    ],
)  # fmt: skip
def test_one_cause_makes_one_finding(tmp_path: Path, text: str, expected: list[tuple[str, int]]) -> None:
    verdict, shown, properties = judged(tmp_path, text)
    assert sorted({(label, line) for label, line, _ in shown if label != "GP304"}) == sorted(expected)
    assert verdict is (Verdict.UNKNOWN if {label for label, _ in expected} <= {"GP144", "GP515"} else Verdict.UNSAFE)
    assert properties["limits"] is not Verdict.SAFE


def test_includes_that_are_only_too_many_are_no_cycle(tmp_path: Path) -> None:
    chain = {f"f{n}.inc": f"$I f{n + 1}.inc\n" for n in range(1, 66)} | {"f66.inc": ""}
    verdict, shown, _ = judged(tmp_path, "%A\nM30\n%\n$I f1.inc\n", **chain)
    (one,) = shown
    assert one[:2] == ("GP145", 1)
    assert one[2].startswith(
        "the include file 'f64.inc' would be include number 64 inside another; gproof reads 63: job.src -> f1.inc"
    )
    assert verdict is Verdict.UNSAFE
    _, shown, _ = judged(tmp_path, "%A\nM30\n%\n$I f1.inc\n", **{"f1.inc": "$I f1.inc\n"})
    assert shown == [("GP145", 1, "the include file 'f1.inc' includes itself: job.src -> f1.inc -> f1.inc")]
