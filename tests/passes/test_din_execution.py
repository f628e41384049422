"""Lines of DIN blocks executed: places, units, modes. Expected values are worked out from the manual by hand."""

from __future__ import annotations

from passes.din_programs import labels, machine, moves, run


def test_moves_go_on_until_another_command() -> None:
    trace, findings = run(["G90 G00 X10 Y20", "X30", "G01 X40 F100", "Y0", "G91 G01 X1"])
    assert moves(trace) == [
        ("TRAVERSE", 10, 20, 0), ("TRAVERSE", 30, 20, 0), ("FEED", 40, 20, 0), ("FEED", 40, 0, 0), ("FEED", 41, 0, 0),
    ]  # fmt: skip
    assert labels(findings) == []


def test_rapids_count_in_the_axis_unit_and_feeds_in_the_interpolation_unit() -> None:
    trace, findings = run(["G70", "G00 X10", "G01 X1 F10"])
    assert moves(trace) == [("TRAVERSE", 10, 0, 0), ("FEED", 25.4, 0, 0)]
    assert labels(findings) == []


def test_bare_words_without_a_command_are_refused() -> None:
    assert labels(run(["X10"])[1]) == ["GP202"]
    assert labels(run(["G00 X1", "G04 1", "X10"])[1]) == ["GP202"]
    assert labels(run(["G00 X1", "G90", "X10"])[1]) == ["GP113"]
    kept, findings = run(["G00 X1", "M8", "X10"])
    assert moves(kept)[-1] == ("TRAVERSE", 10, 0, 0)
    assert labels(findings) == []


def test_zero_offsets() -> None:
    trace, findings = run(["G90", "G54", "G00 X1 Y1 Z1", "G92 X100", "G00 X1", "G91 G92 X5", "G90 G00 X0", "G53",
                           "G00 X0 Y0"])  # fmt: skip
    assert [m[1:] for m in moves(trace)] == [(11, 21, 31), (101, 21, 31), (105, 21, 31), (0, 0, 31)]
    assert labels(findings) == []


def test_reflection_about_the_zero_offset() -> None:
    trace, findings = run(["G90", "G22", "G00 X5 Y5", "G39 X2", "G00 X5", "G91 G00 X1", "G24", "G00 X1"])
    assert [m[1:3] for m in moves(trace)] == [(-5, 5), (10, 5), (12, 5), (13, 5)]
    assert labels(findings) == []
    assert "GP276" in labels(run(["G54", "G22", "G00 X5"])[1])
    assert "GP276" in labels(run(["G22", "G39 X2", "G24", "G22", "G00 X5"])[1])


def test_mode_behind_g53_in_g91_is_open() -> None:
    assert labels(run(["G91", "G53", "G00 X5"])[1]) == ["GP113"]
    assert labels(run(["G91", "G53", "G91", "G00 X5"])[1]) == []


def test_task_codes() -> None:
    none = machine(tasks=None)
    assert labels(run(["M6", "G00 X1"], on=none)[1]) == ["GP514"]
    assert labels(run(["G74"], on=none)[1]) == ["GP514"]
    assert labels(run(["T3"], on=none)[1]) == ["GP514"]
    assert labels(run(["M3", "M8", "S100", "M5", "M9", "G00 X1"], on=none)[1]) == []
    assert labels(run(["G210 X5"], on=none)[1]) == ["GP514"]
    assert labels(run(["G210 X5"])[1]) == ["GP112"]
