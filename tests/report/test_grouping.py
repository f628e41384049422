"""Findings that differ in numbers only: counts, lines and the worst against a count by hand, in every report."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest
from support.campaigns import seeds
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.ir import codes
from gproof.ir.finding import GROUPS, Findings, Span, measure, pattern

MACHINE = str(ROOT / "docs" / "codes" / "machine.toml")
LIMITS = {"X": (0.0, 600.0), "Y": (0.0, 400.0), "Z": (-150.0, 0.0)}


def checked(capsys: pytest.CaptureFixture[str], job: Path, *words: str) -> str:
    main(["check", str(job), "--machine", MACHINE, "--setup", "zero", *words])
    return capsys.readouterr().out


def beyond(lines: list[str]) -> dict[tuple[str, str], list[tuple[int, float]]]:
    """(axis, side) → (line, how far) of each block of absolute moves that ends or stays past a limit, by hand."""
    at = dict.fromkeys("XYZ", 0.0)
    out: dict[tuple[str, str], list[tuple[int, float]]] = {}
    for number, line in enumerate(lines, 1):
        words = {word[0]: float(word[1:]) for word in line.split() if word[0] in "XYZ"}
        at |= words
        for axis, value in at.items() if words else ():
            low, high = LIMITS[axis]
            if value < low:
                out.setdefault((axis, "lower"), []).append((number, low - value))
            if value > high:
                out.setdefault((axis, "upper"), []).append((number, value - high))
    return out


@pytest.mark.parametrize("seed", seeds(6, 60))
def test_every_kind_is_counted_to_the_last_line(
    seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:  # fmt: skip
    dice = random.Random(seed)
    lines = ["G21 G90 G94 F600"]
    for _ in range(dice.choice([3, 60, 70, 400, 3000])):
        axes = dice.sample("XYZ", dice.randint(1, 3))
        middle = {"X": 300, "Y": 200, "Z": -75}
        lines.append(
            f"G{dice.randint(0, 1)} "
            + " ".join(f"{axis}{middle[axis] + dice.gauss(0, 1) * dice.choice([50, 250]):.3f}" for axis in axes)
        )
    lines.append("M30")
    job = tmp_path / "job.cnc"
    job.write_text("\n".join(lines) + "\n", encoding="utf-8")
    report = json.loads(checked(capsys, job, "--format", "json"))
    wanted = beyond(lines)
    groups = {g["pattern"]: g for g in report["groups"] if g["code"] == "GP301"}
    listed = [f for f in report["findings"] if f["code"] == "GP301"]
    assert report["counts"].get("GP301", 0) == sum(map(len, wanted.values()))
    assert len(groups) == sum(len(found) > 1 for found in wanted.values())
    for (axis, side), found in wanted.items():
        assert any(f["message"].startswith(f"{axis} would") and f" {side} " in f["message"] for f in listed)
        first = min(line for line, _ in found)
        assert any(f["line"] == first for f in listed)
        if len(found) < 2:
            continue
        group = groups[f"{axis} would reach # mm, # mm past its {side} travel limit of # mm"]
        assert (group["times"], group["line"], group["last_line"]) == (len(found), first, found[-1][0])
        most = max(far for _, far in found)
        assert f", {most:.3f} mm past its" in group["worst"]["message"]
        assert group["worst"]["line"] in {line for line, far in found if abs(far - most) < 1e-9}


def test_the_worst_arc_is_found_behind_many(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    off = [0.01 * (1 + (37 * n) % 200) for n in range(200)]
    lines = ["G21 G90 G17 F600 G0 X50 Y50"]
    for far in off:
        lines += ["G1 X50 Y50", f"G2 X{70 + far:.3f} Y50 I10 J0"]
    job = tmp_path / "arcs.cnc"
    job.write_text("\n".join([*lines, "M30"]) + "\n", encoding="utf-8")
    (group,) = (g for g in json.loads(checked(capsys, job, "--format", "json"))["groups"] if g["code"] == "GP401")
    assert (group["times"], group["line"], group["last_line"]) == (200, 3, 401)
    assert group["worst"]["line"] == 3 + 2 * off.index(max(off))
    assert f"{max(off):.4f} mm apart" in group["worst"]["message"]


FAR = ["G21 G90", *(f"G1 X{x} F600" for x in (590, 610, 620, 650, 640, 645)), "M30"]


def test_more_than_three_of_a_kind_are_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "far.cnc"
    job.write_text("\n".join(FAR) + "\n", encoding="utf-8")
    said = (
        "and 4 more like this in lines 4, 5, 6, 7; the worst in line 5: X would reach 650.000 mm, 50.000 mm past its "
        "upper travel limit of 600.000 mm"
    )
    first = "X would reach 610.000 mm, 10.000 mm past its upper travel limit of 600.000 mm"
    text = checked(capsys, job)
    assert text.count("GP301") == 1
    assert f"{job}:3:1: error GP301 [soft-limit] {first}\n    3 | G1 X610 F600\n      = {said}\n" in text
    assert f"::{first}%0A{said}\n" in checked(capsys, job, "--format", "github")
    page = checked(capsys, job, "--format", "markdown")
    assert f"{first}, {said}\n" in page
    assert "5 errors" in page
    for words, count in ((("--no-group",), 5), (("--all", "--format", "github"), 5), (("--all", "-q"), 0)):
        every = checked(capsys, job, *words)
        assert every.count("GP301") == count
        assert "more like this" not in every
    assert checked(capsys, job, "--all", "--format", "markdown").count("**error GP301**") == 5
    inches = checked(capsys, job, "--units", "inch")
    assert f"the worst in line 5: X would reach {650 / 25.4:.4f} inch" in inches


def test_three_of_a_kind_are_three(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "far.cnc"
    job.write_text("\n".join([*FAR[:5], "M30"]) + "\n", encoding="utf-8")
    assert checked(capsys, job).count("GP301") == 3


def test_a_loop_counts_each_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "loop.cnc"
    job.write_text("G21 G90\n#1=0\nwhile [#1 < 30]\n#1=[#1+1]\nG1 X[600+#1] F600\nendwhile\nM30\n", encoding="utf-8")
    text = checked(capsys, job)
    assert "      = and 29 more like this; the worst in line 5: X would reach 630.000 mm" in text


def test_accepted_ones_are_a_kind_of_their_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "stops.cnc"
    stops = ["M0"] * 5 + ["M0 ; gproof: allow GP243: the operator turns the part"] * 6
    job.write_text("\n".join(["G21 G90", *stops, "M30"]) + "\n", encoding="utf-8")
    text = checked(capsys, job)
    assert text.count("note GP243") == 2
    assert "      = and 4 more like this in lines 3, 4, 5, 6\n" in text
    assert (
        "      = and 5 more like this in lines 8, 9, 10, 11, 12\n      = accepted: the operator turns the part\n"
        in text
    )
    github = checked(capsys, job, "--format", "github")
    assert "and 4 more like this in lines 3, 4, 5, 6" in github
    assert github.count("GP243") == 1


def test_numbers_are_no_names() -> None:
    assert pattern("X would reach -1.5000 mm, 2. past .5") == "X would reach # mm, # past #"
    assert pattern("X12.5: M999 behind G54.1, T3, #100, CD601, $MN") == "X#: M999 behind G54.1, T3, #100, CD601, $MN"
    far = codes.SOFT_LIMIT.at(Span("a", 1), axis="X", reached=7.0, unit="mm", over=2.0, side="upper", limit=5.0)
    off = codes.SOFT_LIMIT_GUARD_OFF.at(Span("a", 1), axis="X", reached=7.5, unit="mm", side="upper", limit=5.0)
    assert (measure(far), measure(off)) == (2.0, 2.5)


def test_the_first_of_each_kind_is_kept_and_memory_is_bounded() -> None:
    findings = Findings()
    for line in range(1, 100):
        findings.add(codes.SYNTAX.at(Span("a", line), what=f"value {line} is none"))
    findings.add(codes.SYNTAX.at(Span("a", 500), what="something else"))
    assert [f.span.line for f in findings.kept] == [*range(1, 21), 500]
    for line in range(1000, 2000):
        text = "".join(chr(97 + int(digit)) for digit in str(line))
        findings.add(codes.SYNTAX.at(Span("a", line), what=text))
    assert len(findings.kept) == 40
    assert len(findings.groups) == GROUPS
    assert findings.counts[101] == 1100
    assert findings.hidden(codes.SYNTAX) == 1060
    assert [f.span.line for f in findings.shortened(5).kept][:6] == [1, 2, 3, 4, 5, 500]
