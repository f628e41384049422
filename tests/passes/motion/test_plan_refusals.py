"""Jobs that are SAFE and have no steps: one finding for a cause, at its own line and file, with what would help."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from corpus.jobs import lowered
from passes.motion.traces import Path as Rows
from passes.motion.traces import machine as bench

from gproof.driver.pipeline import lower
from gproof.driver.session import Running, open_session
from gproof.ir.finding import Finding, Findings
from gproof.passes.interpret.mcuwin.value_hints import of_value
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step

MOTION = ("GP503", "GP504", "GP511", "GP520", "GP521")


def told(name: str) -> list[tuple[str, str, int, str]]:
    session, stages = lowered(name)
    assert stages.stream is None
    found = [f for f in session.findings.kept if f.code.label in MOTION]
    return [(f.code.label, Path(f.span.file).name, f.span.line, f"{f.message} | {f.hint}") for f in found]


@pytest.mark.parametrize(
    ("name", "places", "words"),
    [
        ("mcuwin/engraver/carousel", [("carousel.src", 9)], [("never ends", "an end")]),
        ("mcuwin/engraver/three-planes", [("three-planes.src", 12)], [("tool 2 next to", "radius 0")]),
        (
            "mcuwin/engraver/which-fixture",
            [("fixtures.inc", 2), ("fixtures.inc", 4), ("fixtures.inc", 6)],
            [("the path depends", "[inputs]")] * 3,
        ),
        (
            "wincnc/knife-twohead/gasket",
            [("gasket.tap", 5), ("gasket.tap", 12)],
            [("waits for an input", "known only when"), ("and of 5 more", "arcs_share_feed under [controls]")],
        ),
        (
            "wincnc/plasma/flange",
            [("TOUCH.MAC", 5), ("TORCHON.MAC", 2), ("flange.tap", 14)],
            [("a probe", "known only when"), ("an input", "known only when"), ("and of 8", "arcs_share_feed")],
        ),
    ],
)
def test_jobs_of_the_corpus(name: str, places: list[tuple[str, int]], words: list[tuple[str, str]]) -> None:
    found = told(name)
    assert [(label, file, line) for label, file, line, _ in found] == [("GP503", *place) for place in places]
    for (*_, text), (cause, hint) in zip(found, words, strict=True):
        assert cause in text.split(" | ")[0]
        assert hint in text.split(" | ")[1]


def job(tmp_path: Path, machine: str, text: str, stated: str = "") -> list[Finding]:
    """The findings of a McuWIN program on its way to steps."""
    path = tmp_path / "machine.toml"
    path.write_text(f'schema = "gproof-machine/1"\nunits = "mm"\n{machine}\n')
    setup = tmp_path / "setup.toml"
    setup.write_text(
        'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 0.0, y = 0.0, z = 0.0}\n'
        f"g92 = {{x = 0.0, y = 0.0, z = 0.0}}\n{stated}"
    )
    program = tmp_path / "job.src"
    program.write_text(text)
    session = open_session(program, machine=path, setup=str(setup), dialect="mcuwin")
    lower(session, Running(1000), "stream")
    return [f for f in session.findings.kept if f.code.label in (*MOTION, "GP518")]


AXES = "".join(
    f"[axes.{a}]\nmin = -100\nmax = 100\nmax_velocity = 50\nmax_acceleration = 500\nposition_unit = 'mm'\n"
    for a in "xyz"
)
LINES = "%A\nG00 X1\nG01 X10 Y5 F100\nM30\n%\n"


def test_each_axis_without_steps_is_named_with_its_key(tmp_path: Path) -> None:
    found = job(tmp_path, f'{AXES}[din]\ntime_unit = "min"\n', LINES)
    assert [(f.code.label, f.span.line, f.message[0]) for f in found] == [("GP504", 2, "X"), ("GP504", 3, "Y")]
    assert "steps_per_unit under [axes.x]" in found[0].hint
    assert "steps_per_unit under [axes.y]" in found[1].hint


def test_a_feed_of_which_no_file_tells_the_time_names_the_setting(tmp_path: Path) -> None:
    steps = AXES.replace("min =", "steps_per_unit = 100\nmin =")
    found = job(tmp_path, f"{steps}[din]\n", LINES)
    assert [(f.code.label, f.span.line) for f in found] == [("GP518", 3), ("GP503", 3)]
    assert "time_unit" in found[0].hint
    assert "GP518" in found[1].hint


def test_places_name_what_the_setup_would_state() -> None:
    for symbol, hint in (
        ("start.x", "start = {x = ...} of the setup file"),
        ("work.1.z", "z of [work.1] of the setup file"),
        ("g92.y", "y of [g92] of the setup file"),
        ("tool.3.z", "length of [tools.3] of the setup file"),
        ("probe.1.z", "known only when the job runs"),
        ("beside.2a.x", "radius 0"),
    ):
        findings = Findings()
        assert plan(Rows().frame(symbol).traverse(y=5).done(), bench(), findings) is None
        (one,) = findings.kept
        assert hint in one.hint, symbol


def test_missing_data_of_one_axis_is_told_once_for_all_sections() -> None:
    bare = bench()
    axes = (dataclasses.replace(bare.axes[0], max_velocity=None), *bare.axes[1:])
    findings = Findings()
    trace = Rows().traverse(x=1).traverse(x=2).done()
    assert plan(trace, dataclasses.replace(bare, axes=axes), findings) is None
    (one,) = findings.kept
    assert "max_velocity under [axes.x]" in one.hint


def test_steps_need_motors_of_all_axes_that_move() -> None:
    bare = bench()
    axes = tuple(dataclasses.replace(axis, steps_per_unit=None) for axis in bare.axes)
    machine = dataclasses.replace(bare, axes=axes)
    findings = Findings()
    trace = Rows().traverse(x=1, y=2).done()
    planned = plan(trace, machine, findings)
    assert planned is not None
    assert step(trace, planned, machine, findings) is None
    assert [f.message[0] for f in findings.kept] == ["X", "Y"]


@pytest.mark.parametrize(
    ("cause", "hint"),
    [
        ("CD601", "601 = ... under [parameters]"),
        ("CI603", "1603 = ... under [parameters]"),
        ("X.RP", "X.tp"),
        ("what an earlier job kept of CI601", "[resident] of the setup file"),
        ("input X.digib.3", "[inputs]"),
        ("#100", ""),
    ],
)
def test_values_of_programs_name_where_they_are_stated(cause: str, hint: str) -> None:
    text = of_value(cause)
    assert hint in text
    assert bool(text) == bool(hint)


def test_what_is_stated_in_the_setup_needs_no_hint(tmp_path: Path) -> None:
    """McuWIN manual 11: CD and CI are variables of their own; the setup counts CI from 1000."""
    steps = AXES.replace("min =", "steps_per_unit = 100\nmin =")
    text = "%A\nG90 G00 X(CD601) Y(CI602)\nM30\n%\n"
    assert [f.code.label for f in job(tmp_path, f"{steps}[din]\n", text, "[parameters]\n601 = 5.5\n1602 = 7\n")] == []
    assert [f.code.label for f in job(tmp_path, f"{steps}[din]\n", text)] == ["GP503"]
