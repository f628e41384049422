"""Outputs, torch height, clamp, drives, heaters: rows, errors and what they leave unknown (3.5.8 to 3.5.12)."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from passes.interpret.core.test_plane_transform import HEAD, codes_of, motions, run, unknown

from gproof.ir.setup import NOTHING
from gproof.ir.trace import SETPOINTS, Op, Trace, Wait


def events(trace: Trace) -> list[tuple[str, str, float, float]]:
    """(op, what is set, arguments) of outputs and set points."""
    out = []
    for section in trace.sections:
        r = section.rows
        for i in range(len(r)):
            op = Op(int(r["op"][i]))
            if op in (Op.OUTPUT, Op.SETPOINT):
                name = trace.texts[int(r["text"][i])] if op is Op.SETPOINT else ""
                out.append((op.name, name, *r["arg"][i].tolist()))
    return out


ROWS = {
    # 3.5.9: outputs, and pulse widths in thousandths
    "M54 P1": [("OUTPUT", "", 1, 1)],
    "M55 P208": [("OUTPUT", "", 208, 0)],
    "M54 E2 Q500": [("SETPOINT", "pwm", 2, 0.5)],
    "M54 E1 Q0": [("SETPOINT", "pwm", 1, 0)],
    # 3.5.10: P names the output of the brake
    "M26 P1": [("OUTPUT", "", 1, 1)],
    "M27 P1": [("OUTPUT", "", 1, 0)],
    "M26": [],
    "M80": [("SETPOINT", "drives", 0, 1)],
    "M81": [("SETPOINT", "drives", 0, 0)],
    "M100 P1": [],
    "M23 Q120": [("SETPOINT", "height_setpoint", 0, 120)],
    # 3.5.12
    "M104 S50": [("SETPOINT", "extruder_temperature", 0, 50)],
    "M140 S60": [("SETPOINT", "bed_temperature", 0, 60)],
    "M143 S260": [("SETPOINT", "extruder_maximum", 0, 260)],
    "M106": [("SETPOINT", "fan", 0, 1)],
    "M106 S0": [("SETPOINT", "fan", 0, 0)],
    "M106 S255": [("SETPOINT", "fan", 0, 1)],
    "M107": [("SETPOINT", "fan", 0, 0)],
}  # fmt: skip


@pytest.mark.parametrize("line", ROWS)
def test_rows(line: str, tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + f"{line}\nM30\n")
    assert codes_of(findings) == []
    assert events(trace) == ROWS[line]
    assert {name for _, name, _, _ in events(trace) if name} <= set(SETPOINTS)


REFUSED = {
    "M54": "GP275", "M55": "GP275", "M54 E1": "GP275", "M54 E1 Q1001": "GP283", "M54 E1 Q-1": "GP283",
    "M54 P-1": "GP283", "M55 P-2": "GP283", "M54 E-1 Q5": "GP283",
    "G64 P-.1": "GP129", "G61 Q-1": "GP129", "G64 R-1": "GP129", "G64 R181": "GP129",
    "M54 P1 E1 Q1": "GP283", "M55 E1": "GP113", "M54 P1 Q5": "GP121", "M54 P1.5": "GP229", "M27 P.5": "GP229",
    "M104": "GP275", "M140": "GP275", "M143": "GP275", "M109": "GP275", "M104 S-1": "GP283", "M106 S256": "GP283",
    "M23": "GP275", "M22": "GP113", "M100": "GP275", "M100 P1.01": "GP282", "M20": "GP280", "M21": "GP280",
    "M3 M104 S50": "GP113", "M3 M106 S50": "GP113", "M26 Q1": "GP121",
}  # fmt: skip


@pytest.mark.parametrize("line", REFUSED)
def test_findings(line: str, tmp_path: Path) -> None:
    _, findings = run(tmp_path, HEAD + f"{line}\nM30\n")
    assert codes_of(findings) == [REFUSED[line]]


def test_a_fan_in_between_is_not_known(tmp_path: Path) -> None:
    """Table 3-6 counts to 255, 3.5.12 to 100."""
    trace, findings = run(tmp_path, HEAD + "M106 S80\nM30\n")
    assert codes_of(findings) == []
    assert math.isnan(events(trace)[0][3])


def test_a_temperature_is_no_spindle_speed(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + "M3\nM104 S50\nG95\nG1 X10 F2\nM30\n")
    assert codes_of(findings) == []
    assert motions(trace)[-1]["feed"] == 2000.0  # 2 mm a turn at the S1000 of the head


@pytest.mark.parametrize("line", ["M109 S200", "M190 S60", "M190"])
def test_waiting_for_a_temperature_ends_a_section(line: str, tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + f"G0 X1\n{line}\nG0 X2\nM30\n")
    assert codes_of(findings) == []
    assert [section.edges[0].wait for section in trace.sections] == [Wait.INPUT, Wait.END]
    assert trace.sections[0].edges[0].target == 1


CLAMPED = {
    "G0 A5": ["GP279"],
    "G0 X5 A5": ["GP279"],
    "G91 G0 A1": ["GP279"],
    "G53 G0 A7": ["GP279"],
    "#5164=9 G28": ["GP279"],
    "G0 X5 Y5 Z5": [],
    "G0 X5 A0": [],
    "F100 G1 X5 A0": [],
    "G91 G0 A0": [],
    "M27\nG0 A5": [],
    "home a": ["GP279"],
    "home x": [],
}


@pytest.mark.parametrize("text", CLAMPED)
def test_a_clamped_axis_does_not_move(text: str, tmp_path: Path) -> None:
    """3.5.10: the work piece is milled while A is clamped; what is refused is moving A."""
    for lines in (text, text.replace("A5", "A[5]").replace("A0", "A[0]")):
        _, findings = run(tmp_path, HEAD + f"G0 X1 A0\nM26 P1\n{lines}\nM30\n")
        assert codes_of(findings) == CLAMPED[text]


def test_whether_a_clamped_axis_moves_may_be_unknown(tmp_path: Path) -> None:
    _, findings = run(tmp_path, HEAD + "G0 X1\nM26\nG0 A5\nM30\n", NOTHING)
    assert codes_of(findings) == ["GP225"]


def test_torch_height_is_the_controllers(tmp_path: Path) -> None:
    """Of X and Y everything stays known, of Z nothing, whatever words it gets."""
    trace, findings = run(tmp_path, HEAD + "G0 X1 Z5\nM20\nG1 X2\nG1 X3 Z1\nM21\nG53 G0 Z0\nG2 X5 I1\nG28\nM30\n")
    assert codes_of(findings) == ["GP280", "GP280"]
    assert unknown(trace) == ["", *["Z"] * 5]


def test_drives_that_were_off(tmp_path: Path) -> None:
    """Told at the next motion, once; at the end of a job nothing follows."""
    for text, expected in (
        ("M81\nM80\nG0 X2\nG0 X3\n", ["GP281"]),
        ("M81\nG0 X[2]\n", ["GP281"]),
        ("M80\nG0 X2\nM81\n", []),
        ("M81\nG0 X1\nG92 X0\n", []),
    ):
        _, findings = run(tmp_path, HEAD + f"G0 X1\n{text}M30\n")
        assert codes_of(findings) == expected


def test_a_resized_axis_is_not_known(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + "G0 A5\nM100 P1.01\nG0 X1\nG0 A0\nM100 P1\nG53 G0 A1\nM30\n")
    assert codes_of(findings) == ["GP282", "GP282"]
    rows = trace.sections[0].rows
    forms = [trace.frames[f][3] for f in rows["frame"][rows["op"] < Op.DWELL].tolist()]
    assert forms == [(), *[(("?", 1),)] * 3]
