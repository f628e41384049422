"""Messages that a person can use: many keys in one line, hints for comments, one cause once, marks in the trace."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gproof.cli.main import main

HEAD = "G21 G90 G94 G17 G40 G49 G54\n"
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n' + "".join(
    f"[axes.{a}]\nmin = 0.0\nmax = 300.0\n" for a in "xyz"
)
INI = "[GENERAL]\nunits = mm\n" + "".join(
    f"[JOINT_{n}]\nvisible = 1\nportID = {n + 1}\nresolution = 320\npositiveLimit = 300\nnegativeLimit = 0\n"
    "maxVelocity = 100\nmaxAcceleration = 500\n"
    for n in range(3)
)
OWN = {
    "eding": ("job.cnc", "G21 G90\nG0 X1 {}\n{}\nM30\n", "from ; to the end", (";", "(")),
    "wincnc": ("job.tap", "G20\nG0 X1 {}\n{}\n", "start a comment with [ or (", ("[", "(", "%")),
    "mcuwin": ("job.src", "%A\nG90\nG00 X1 {}\n{}\nM30\n%\n", "from ' to the end", ("'", "(")),
}


def checked(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    main(["check", *map(str, words)])
    told = capsys.readouterr()
    return told.out + told.err


@pytest.mark.parametrize("sign", [";", "'", "//", "{", "!"])
@pytest.mark.parametrize("dialect", OWN)
def test_a_comment_of_another_controller(
    sign: str, dialect: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name, text, said, own = OWN[dialect]
    comment = f"{sign} what the tool does here"
    (tmp_path / name).write_text(text.format(comment, comment))
    out = checked(capsys, tmp_path / name, "--dialect", dialect, "--setup", "zero")
    hints = [line for line in out.splitlines() if "hint: " in line and "a comment" in line]
    assert len(hints) == (0 if sign in own else 2), out
    assert all(said in line for line in hints), out


def test_hundreds_of_unknown_keys_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    odd = [f"oddKey{chr(97 + n % 26)}{chr(97 + n // 26)}" for n in range(520)]
    (tmp_path / "cnc.ini").write_text(INI + "[JOINT_0]\n" + "".join(f"{key} = 1\n" for key in odd))
    (tmp_path / "job.cnc").write_text(HEAD + "G0 X1\nM30\n")
    words = tmp_path / "job.cnc", "--machine", tmp_path / "cnc.ini", "--setup", "zero"
    told = [line for line in checked(capsys, *words).splitlines() if "oddKey" in line]
    first, _, more = told
    assert "GP602" in first
    assert "and 519 more like this in lines" in more
    assert all(key in more for key in odd[1:7])
    assert odd[7] not in more
    report = json.loads(checked(capsys, *words, "--format", "json"))
    assert sum(f["code"] == "GP602" for f in report["findings"]) == 520
    (group,) = (one for one in report["groups"] if one["code"] == "GP602")
    assert group["times"] == 520
    assert "... and" not in checked(capsys, *words)


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        # A cycle that does not begin: its holes are not three mistakes more.
        ("G81 X10 Y10 Z5 R20\nX20\nX30\nX40\nM30\n", {("GP204", 2)}),
        # What a line that could not be read was to give is not missing behind it.
        ("G1 X100 F300 QQ5\nX50\nG1 X40\nG2 X50 Y10 I5 J5\nM30\n", {("GP108", 2)}),
        # It may have been anything: where the next one goes is not known.
        ("G1 X100 F300 QQ5\nG0 X40 Y-5\nM30\n", {("GP108", 2)}),
        (
            "G1 X100 F300 QQ5\nG21 G90 G54 G49 G40 G69 G50 M90\nM27 G92.1\nG0 X40 Y-5\nM30\n",
            {("GP108", 2), ("GP301", 5)},
        ),
        # Nothing is known of what a refused assignment was to write: no errors of the value that was there before.
        ("#1=[1/0]\nG1 X#1 F300\nG2 X#1 Y10 I5 J0\nM30\n", {("GP228", 2)}),
    ],
)
def test_one_cause_is_one_error(
    text: str, codes: set[tuple[str, int]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "job.cnc").write_text(HEAD + text)
    words = tmp_path / "job.cnc", "--machine", tmp_path / "machine.toml", "--setup", "zero", "--format", "json"
    report = json.loads(checked(capsys, *words))
    assert {(f["code"], f["line"]) for f in report["findings"] if f["severity"] == "error"} == codes
    assert report["verdict"] == "UNSAFE"


def trace(capsys: pytest.CaptureFixture[str], folder: Path, text: str) -> tuple[int, list[dict[str, object]]]:
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "job.cnc").write_text(HEAD + text)
    words = [str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--setup", "zero"]
    code = main(["dump", *words, "--stage", "trace", "--format", "jsonl"])
    return code, [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_an_arc_that_no_controller_takes_ends_the_trace(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, rows = trace(capsys, tmp_path, "G0 X20 Y20\nG2 X40 Y20 I7 J0 F100\nG0 X0\nM30\n")
    assert code == 1
    assert [(row["op"], row["line"]) for row in rows[-2:]] == [("traverse", 2), ("error", 3)]
    assert rows[-1]["code"] == "GP401"


def test_what_the_language_does_not_have_ends_the_trace(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A setup with a statement of another controller is a line of the trace (GP630): it was an internal error."""
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "job.src").write_text("G00 X1\nM30\n")
    (tmp_path / "turned.toml").write_text(
        'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\n[transform]\nangle = 30\nx = 0\ny = 0\n'
    )
    stated = ["--machine", str(tmp_path / "machine.toml"), "--setup", str(tmp_path / "turned.toml")]
    code = main(["dump", str(tmp_path / "job.src"), *stated, "--stage", "trace", "--format", "jsonl"])
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert (code, [row["op"] for row in rows], rows[-1]["code"]) == (2, ["branch", "error"], "GP630")


JOBS_TO_DUMP = {
    "all is well": "G0 X20\nM30\n",
    "arc": "G0 X20 Y20\nG2 X40 Y20 I7 J0 F100\nG0 X0\nM30\n",
    "arc after a stop": "G0 X20 Y20\nM0\nG2 X40 Y20 I7 J0 F100\nG0 X0\nM30\n",
    "arc and another error": "X5\nG0 X20 Y20\nG2 X40 Y20 I7 J0 F100\nM30\n",
    "word": "G0 X20 H3\nG0 X0\nM30\n",
    "motion": "X5\nM30\n",
    "unread": "G0 X20 )\nM30\n",
    "unknown": "G0 X20\nGetToolInfo num 3\nG0 X0\nM30\n",
}


@pytest.mark.parametrize("text", JOBS_TO_DUMP.values(), ids=JOBS_TO_DUMP)
def test_both_forms_of_the_trace_exit_alike(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines, rows = trace(capsys, tmp_path, text)
    words = [str(tmp_path / "job.cnc"), "--machine", str(tmp_path / "machine.toml"), "--setup", "zero"]
    assert main(["dump", *words, "--stage", "trace"]) == lines
    done = capsys.readouterr()
    if rows[-1]["op"] == "error":
        assert str(rows[-1]["code"]) in done.err
    assert ("GP401" in done.err) == ("G2" in text)
    # Of an arc that no controller takes there is no plan.
    if "G2" in text:
        assert main(["dump", *words, "--stage", "plan"]) == 1
        assert not capsys.readouterr().out


def test_sections_and_branches_are_marked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, rows = trace(capsys, tmp_path, "G0 X20\nM0\nG0 X40\nM30\n")
    assert code == 0
    marks = [row for row in rows if row["op"] in ("section", "branch")]
    assert [row["op"] for row in marks] == ["branch", "section"]
    assert (marks[0]["line"], marks[0]["section"], marks[0]["wait"], marks[0]["target"]) == (3, 0, "operator", 1)
    assert (marks[1]["section"], marks[1]["to"]) == (1, {"x": 20.0, "y": 0.0, "z": 0.0})
    assert [row["op"] for row in rows][-2:] == ["traverse", "end"]
    assert not [row for row in trace(capsys, tmp_path, "G0 X20\nM30\n")[1] if row["op"] in ("section", "branch")]
