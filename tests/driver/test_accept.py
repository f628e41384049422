"""Accepted findings and policies: what they change, and that they never make anything SAFE."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.passes.checks.registry import CHECKS

CODES = ROOT / "docs" / "codes"
HEAD = "G21 G90 G17 G40 G49 G80 G94\nG0 Z-5\n"
STOP = "M0"
OPEN = "M22"
FAR = "G1 X100000 F100"
TAIL = "G0 X0\nM30\n"


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Any:
    """Writes a program and judges it: exit code and JSON report, or what stands on standard error."""
    monkeypatch.chdir(tmp_path)

    def run(text: str | None, *words: str, name: str = "job.cnc", machine: Path = CODES / "machine.toml") -> Any:
        if text is not None:
            Path(name).write_text(text, encoding="utf-8")
        code = main(["check", name, "--machine", str(machine), "--setup", "zero", "--format", "json", *words])
        printed = capsys.readouterr()
        return code, json.loads(printed.out) if printed.out else printed.err

    return run


def of(report: dict[str, Any], code: str) -> list[dict[str, Any]]:
    return [finding for finding in report["findings"] if finding["code"] == code]


@pytest.mark.parametrize(
    "comment",
    ["{line} (gproof: allow GP113: it is a lamp)", "{line} ; gproof: allow GP113 -- it is a lamp",
     "(gproof: allow GP113: it is a lamp)\n{line}", "; gproof: allow GP113: it is a lamp\n{line}",
     "N10 {line} (GPROOF: Allow unsupported-code it is a lamp)", "{line} (gproof: allow GP243, GP113: it is a lamp)",
     "{line} ; gproof: allow-file GP113: it is a lamp", "G4 P0 ; gproof: allow-file GP113: it is a lamp\n{line}"],
)  # fmt: skip
def test_a_comment_accepts_an_unknown(check: Any, comment: str) -> None:
    code, report = check(HEAD + comment.format(line=OPEN) + "\n" + TAIL)
    (found,) = of(report, "GP113")
    assert found["suppressed"] == {"kind": "inSource", "reason": "it is a lamp"}
    assert (report["verdict"], report["exit_code"], code) == ("UNKNOWN", 0, 0)
    assert not of(report, "GP608")
    assert not of(report, "GP609")


@pytest.mark.parametrize(
    ("text", "extra"),
    [
        (f"{OPEN} (gproof: allow GP113)", "GP608"),
        (f"{OPEN} (gproof: allow GP113:  )", "GP608"),
        (f"{OPEN} (gproof: allow)", "GP608"),
        (f"{OPEN} (gproof: accept GP113: why)", "GP608"),
        (f"{OPEN} (gproof: allow GP999: why)", "GP608"),
        (f"{OPEN}\n(gproof: allow GP113: on the line behind it)", "GP609"),
        (f"(gproof: allow GP113: two lines above)\n\n{OPEN}", "GP609"),
        (f"G4 P0 (gproof: allow GP113: beside a block)\n{OPEN}", "GP609"),
        (f"{OPEN} (gproof: allow GP243: another code)", "GP609"),
        (f'msg "gproof: allow-file GP113: a message"\n{OPEN}', ""),
        (f"{OPEN} (see gproof: nothing)", "GP608"),
    ],
)
def test_what_is_no_acceptance_says_so(check: Any, text: str, extra: str) -> None:
    code, report = check(HEAD + text + "\n" + TAIL)
    assert "suppressed" not in of(report, "GP113")[0]
    assert (report["verdict"], code) == ("UNKNOWN", 2)
    found = {finding["code"] for finding in report["findings"]}
    assert found & {"GP608", "GP609", "GP610"} == ({extra} if extra else set())


@pytest.mark.parametrize("asked", [False, True])
def test_a_comment_on_what_is_not_judged_is_left_alone(check: Any, asked: bool) -> None:
    """GP541 is one of ``cutting``: the same job is run with that property and without."""
    text = HEAD + "(gproof: allow-file GP541: the operator ends it)\nM30\n"
    code, report = check(text, *(("--also", "cutting") if asked else ()))
    assert [finding["code"] for finding in report["findings"]] == (["GP609"] if asked else [])
    assert code == 0


def test_a_comment_accepts_no_error(check: Any) -> None:
    code, report = check(HEAD + f"{FAR} (gproof: allow GP301: it is fine)\n" + TAIL)
    assert (report["verdict"], code) == ("UNSAFE", 1)
    assert "suppressed" not in of(report, "GP301")[0]
    assert of(report, "GP610")


@pytest.mark.parametrize("dialect", ["wincnc", "mcuwin"])
def test_comments_of_the_other_languages(check: Any, dialect: str) -> None:
    """Whatever a dialect's comment looks like, what it says is the same."""
    texts = {
        "wincnc": ("job.tap", "G20\nG90\n[gproof: allow GP113: the lamp]\nL9999\nG1 X1 F50\n"),
        "mcuwin": ("job.src", "%A\nG90\n' gproof: allow GP113: the lamp\nG93\nG01 X1 F50\nM30\n"),
    }
    name, text = texts[dialect]
    machine = CODES / dialect / ("WINCNC.INI" if dialect == "wincnc" else "machine.toml")
    _, report = check(text, "--dialect", dialect, name=name, machine=machine)
    comment = text.splitlines().index(next(line for line in text.splitlines() if "gproof" in line)) + 1
    told = {finding["line"] for finding in report["findings"] if finding["code"] in ("GP608", "GP609")}
    accepted = [finding for finding in report["findings"] if "suppressed" in finding]
    assert [finding["line"] for finding in accepted] == [comment + 1] * len(accepted)
    assert bool(accepted) != (comment in told)


def test_a_baseline_knows_what_was_found_and_nothing_else(check: Any) -> None:
    program = HEAD + f"{OPEN}\n{FAR}\n{FAR}\n" + TAIL
    before, report = check(program)
    assert (before, report["verdict"]) == (1, "UNSAFE")
    assert check(None, "--write-baseline", "known.json")[0] == 0
    code, report = check(None, "--baseline", "known.json")
    assert (code, report["verdict"], report["exit_code"]) == (0, "UNSAFE", 0)
    assert all(finding["suppressed"]["kind"] == "external" for finding in report["findings"])
    moved = "(a new head)\n\n" + program.replace("G0 Z-5", "N7 G0  Z-5")
    assert check(moved, "--baseline", "known.json")[0] == 0
    code, report = check(program.replace(TAIL, f"{FAR}\n" + TAIL), "--baseline", "known.json")
    assert code == 1
    assert [finding["line"] for finding in report["findings"] if "suppressed" not in finding] == [6]
    code, report = check(program.replace(OPEN, "M23"), "--baseline", "known.json")
    assert report["verdict"] == "UNSAFE"


def test_a_known_error_that_gets_worse_is_new(check: Any) -> None:
    program = HEAD + "#1=900\nG1 X[#1] F100\n" + TAIL
    assert check(program, "--write-baseline", "known.json")[0] == 0
    assert check(None, "--baseline", "known.json")[0] == 0
    code, report = check(program.replace("#1=900", "#1=950"), "--baseline", "known.json")
    assert (code, report["verdict"]) == (1, "UNSAFE")
    assert "suppressed" not in of(report, "GP301")[0]


def test_many_findings_of_a_code_are_all_known(check: Any) -> None:
    program = HEAD + "".join(f"G1 X{100000 + n} F100\nG1 X0\n" for n in range(50)) + TAIL
    assert check(program, "--write-baseline", "known.json")[0] == 0
    assert check(None, "--baseline", "known.json")[0] == 0
    code, report = check(program.replace("X100049", "X200000"), "--baseline", "known.json")
    assert code == 1
    assert len([finding for finding in report["findings"] if "suppressed" not in finding]) == 1


ENDS = {
    ".cnc": (HEAD, TAIL, "G1 X{x} F100", "G2 X0 Y{y} I5 J0"),
    ".tap": ("G20\nG90\nG92 X0 Y0 Z0\nF50\n", "G0 X0\n", "G1 X{x}", "G2 X0 Y{y} I5 J0"),
}


@pytest.mark.parametrize(("name", "which"), [("job.cnc", 2), ("job.tap", 3)])
def test_each_of_hundreds_of_findings_is_known(check: Any, name: str, which: int) -> None:
    head, tail, *lines = ENDS[Path(name).suffix]
    body = "".join(f"{lines[which - 2].format(x=100000 + n, y=1 + n / 64)}\nG1 X0 Y0\n" for n in range(130))
    machine = CODES / ("machine.toml" if name.endswith("cnc") else "wincnc/WINCNC.INI")
    assert check(head + body + tail, "--write-baseline", "known.json", name=name, machine=machine)[0] == 0
    code, report = check(None, "--baseline", "known.json", name=name, machine=machine)
    if which == 3:
        # Where an arc that is refused ends is not known: what rests on that is accepted by itself.
        assert code == 2
        again = ("--baseline", "known.json", "--write-baseline", "known.json")
        assert check(None, *again, name=name, machine=machine)[0] == 0
        code, report = check(None, "--baseline", "known.json", name=name, machine=machine)
    assert (code, report["verdict"]) == (0, "UNSAFE")
    assert max(report["counts"].values()) >= 130


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"schema": "gproof-baseline/1", "files": 3}', "\udc80"])
def test_a_bad_baseline_is_one_line(check: Any, content: str) -> None:
    Path("known.json").write_bytes(content.encode("utf-8", "surrogateescape"))
    code, said = check(HEAD + TAIL, "--baseline", "known.json")
    assert (code, said) == (3, "gproof: error: baseline known.json: not a baseline; --write-baseline writes one\n")


LEVELS = ["off", "note", "warning", "unknown", "error"]
WEIGHT = {"GP243": "note", "GP609": "warning", "GP113": "unknown", "GP301": "error"}
LINES = {"GP243": STOP, "GP609": "(gproof: allow GP106: nothing)", "GP113": OPEN, "GP301": FAR}


@pytest.mark.parametrize(("code", "level"), list(product(WEIGHT, LEVELS)))
def test_a_policy_adds_weight_and_takes_none_from_what_decides(check: Any, code: str, level: str) -> None:
    Path("shop.toml").write_text(f'schema = "gproof-policy/1"\n[severity]\n{code} = "{level}"\n', encoding="utf-8")
    _, plain = check(HEAD + LINES[code] + "\n" + TAIL)
    status, report = check(None, "--policy", "shop.toml")
    lowered = LEVELS.index(level) < LEVELS.index(WEIGHT[code])
    if lowered and WEIGHT[code] in ("unknown", "error"):
        assert status == 3
        assert "cannot count less" in report
        return
    found = of(report, code)
    assert [f["severity"] for f in found] == ([] if level == "off" else [level])
    rank = ["SAFE", "UNKNOWN", "UNSAFE"]
    assert rank.index(report["verdict"]) >= rank.index(plain["verdict"])
    assert status == (1 if level == "error" else 2 if level == "unknown" else plain["exit_code"]) or code == "GP609"
    assert (status == 0) == (level in ("off", "note", "warning"))


@pytest.mark.parametrize(
    ("words", "codes"),
    [
        ([], {STOP: 0, "": 0, OPEN: 2, FAR: 1}),
        (["--fail-on", "note"], {STOP: 1, "": 0, OPEN: 2, FAR: 1}),
        (["--fail-on", "warning"], {STOP: 0, "": 0, OPEN: 2, FAR: 1, "(gproof: x)": 1}),
        (["--warnings-as-errors"], {STOP: 0, "": 0, OPEN: 2, FAR: 1, "(gproof: x)": 1}),
        (["--fail-on", "note"], {STOP + " (gproof: allow GP243: the plate is turned)": 0}),
    ],
)
def test_what_fails_a_check(check: Any, words: list[str], codes: dict[str, int]) -> None:
    for line, expected in codes.items():
        assert check(HEAD + line + "\n" + TAIL, *words)[0] == expected, line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('properties = ["language", "limits", "gouges"]', "gouges, which this version does not check"),
        ('properties = ["limits"]', "language is missing"),
        ('properties = ["language", "speed"]', "'speed' is not one of"),
        ("properties = []", "must be a list of names"),
        ('fail_on = "error"', "'error' is not one of unknown, warning, note"),
        ('[severity]\nGP999 = "error"', "there is no finding 'GP999'"),
        ('[severity]\nsoft-limit = "loud"', "'loud' is not one of"),
    ],
)
def test_policies_with_mistakes(check: Any, text: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CHECKS, "gouges", ())
    Path("shop.toml").write_text(f'schema = "gproof-policy/1"\n{text}\n', encoding="utf-8")
    code, report = check(HEAD + TAIL, "--policy", "shop.toml")
    if "gouges" in text:
        assert (code, report["verdict"], report["properties"]["gouges"]["verdict"]) == (2, "UNKNOWN", "UNKNOWN")
        report = json.dumps(report)
    else:
        assert code == 3
    assert said in report


def test_less_properties_judge_less(check: Any) -> None:
    Path("shop.toml").write_text('schema = "gproof-policy/1"\nproperties = ["language", "arcs"]\n', encoding="utf-8")
    code, report = check(HEAD + FAR + "\n" + TAIL, "--policy", "shop.toml")
    assert (report["verdict"], report["properties"]["limits"]["verdict"]) == ("SAFE", "UNSAFE")
    assert code == 0
    assert report["left_out"] == ["limits", "areas"]


def test_a_verdict_names_what_the_policy_leaves_out(check: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """A SAFE that says nothing of the limits is not to be read as one that does."""
    Path("shop.toml").write_text('schema = "gproof-policy/1"\nproperties = ["language", "arcs"]\n', encoding="utf-8")
    check(HEAD + FAR + "\n" + TAIL)
    words = ["job.cnc", "--machine", str(CODES / "machine.toml"), "--setup", "zero", "--policy", "shop.toml"]
    assert main(["check", *words]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "job.cnc: SAFE, limits left out by the policy" in said
    assert "  limits      UNSAFE   left out by the policy" in said
    assert main(["check", *words, "--quiet"]) == 0
    assert capsys.readouterr().out.splitlines() == ["job.cnc: SAFE, limits left out by the policy"]
    check(HEAD + TAIL)
    assert main(["check", *words, "--quiet"]) == 0
    assert capsys.readouterr().out.splitlines() == ["job.cnc: SAFE"]


def test_a_comment_far_down_a_long_file_is_read(check: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Long files are mapped and searched in pieces: the sign may stand across the border of two of them."""
    from gproof.driver import suppressions as accept

    monkeypatch.setattr("gproof.frontend.common.source.MAP_FROM", 100)
    body = "(plain: text)\n" + "G1 X1 F100\nX2\n" * 40
    text = HEAD + body + f"{OPEN} (GProof: allow GP113: it is a lamp)\n" + TAIL
    for piece in (7, 64, text.lower().index("gproof:") + 3, 1 << 20):
        monkeypatch.setattr(accept, "_PIECE", piece)
        _, report = check(text)
        (found,) = of(report, "GP113")
        assert found["suppressed"]["reason"] == "it is a lamp", piece
        assert found["line"] == text.count("\n", 0, text.index(OPEN)) + 1


REFUSED = {
    "job.cnc": (HEAD, "G0 Y1\n", "M30\n", ("G1 X10 F-1", "G1 X10 ~", "G2 X10 Y0", "G1 X10 D5", "#1 = [2", "G1 G2 X5")),
    "job.tap": (
        "G20\nG90\nG92 X0 Y0 Z0\nF50\nG0 X1 Y1\n", "G0 Y2\n", "",
        ("G1 X2 F-1", "G1 X2 ~", "G2 X2", "G1 X1 X2", "G7777 X2"),
    ),
    "job.src": ("%A\nG90\nG00 X0 Y0\n", "G00 Y1\n", "M30\n", ("G01 X10 F-1", "G01 X10 ~", "G01 X10 X11", "$I no.inc")),
}  # fmt: skip
"""By job: what comes before a line that is an error, a move after it, the end, and such lines."""


@pytest.mark.parametrize(
    ("name", "line"), [(name, line) for name, told in REFUSED.items() for line in told[3]], ids=str
)
def test_what_follows_an_accepted_error_is_unknown(check: Any, name: str, line: str) -> None:
    """A line that was refused loses what it may have changed, whoever accepts it: exit 2 then."""
    head, move, tail, _ = REFUSED[name]
    machine = {"job.cnc": "machine.toml", "job.tap": "wincnc/WINCNC.INI", "job.src": "mcuwin/machine.toml"}[name]
    at, program = {"name": name, "machine": CODES / machine}, f"{head}{line}\n{move}{tail}"
    code, report = check(program, **at)
    place = head.count("\n") + 1
    assert (code, report["verdict"]) == (1, "UNSAFE")
    assert [f["line"] for f in report["findings"] if f["severity"] == "error"] == [place]
    assert check(None, "--write-baseline", "known.json", **at)[0] == 0
    code, report = check(None, "--baseline", "known.json", **at)
    assert (code, report["exit_code"], report["verdict"]) == (2, 2, "UNSAFE"), program
    answers = {name: answer["verdict"] for name, answer in report["properties"].items()}
    assert (answers["limits"], answers["areas"]) == ("UNKNOWN", "UNKNOWN")
    assert answers["arcs"] != "SAFE"
    (left,) = [f for f in report["findings"] if "suppressed" not in f and f["severity"] in ("error", "unknown")]
    assert (left["code"], left["line"]) == ("GP304", place + 1)
    # Who accepts that too says so; and behind which nothing moves, that leaves nothing open.
    assert check(None, "--baseline", "known.json", "--write-baseline", "all.json", **at)[0] == 0
    assert check(None, "--baseline", "all.json", **at)[0] == 0
    assert check(f"{head}{line}\n{tail}", "--baseline", "known.json", **at)[0] == 0


def test_a_new_error_is_before_what_an_accepted_one_leaves_open(check: Any) -> None:
    program = HEAD + "G1 X10 F-1\nG0 X0 Y0 Z0\n" + TAIL
    assert check(program, "--write-baseline", "known.json")[0] == 0
    assert check(program.replace(TAIL, f"{FAR}\n" + TAIL), "--baseline", "known.json")[0] == 1


def test_nothing_of_a_run_that_an_accepted_error_ends_is_known(check: Any) -> None:
    program = HEAD + "while [1 / 0]\nG1 X1 F100\nendwhile\n" + TAIL
    assert check(program, "--write-baseline", "known.json")[0] == 0
    assert check(None, "--baseline", "known.json")[0] == 2
