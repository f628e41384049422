"""G161 and G162: centres as places or as distances (manual 3.3, 3.35, 3.36)."""

from __future__ import annotations

from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, run

AWAY = ["G00 X10", "G161", "G03 X20 Y10 I10 J10 F100"]
"""The centre as a place; as a distance the radii would differ."""


def test_centres_are_places_where_the_option_is_on() -> None:
    trace, findings = run(AWAY, on=machine(absolute_centers=True))
    assert moves(trace)[-1] == ("ARC", 20, 10, 0)
    assert labels(findings) == []


def test_g161_makes_them_places_whatever_the_option_is() -> None:
    """3.35: in G90 they are absolute as well."""
    for option in (False, None):
        there, findings = run(AWAY, on=machine(absolute_centers=option))
        assert labels(findings) == []
        assert [m[1:] for m in moves(there)] == [m[1:] for m in moves(run(AWAY, on=machine(absolute_centers=True))[0])]
        trace, findings = run(["G161", "G03 X20 Y0 I10 J0 F100"], on=machine(absolute_centers=option))
        assert moves(trace) == [("ARC", 20, 0, 0)]
        assert labels(findings) == []


def test_distances_whatever_the_option_is() -> None:
    for option in (True, False, None):
        trace, findings = run(["G00 X10", "G162", "G03 X20 Y10 I0 J10 F100"], on=machine(absolute_centers=option))
        assert moves(trace)[-1] == ("ARC", 20, 10, 0)
        assert labels(findings) == []
