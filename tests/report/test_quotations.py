"""A finding names what somebody wrote, and does not repeat twenty thousand characters of it, in any report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import Done, in_this_process

from gproof.ir.codes import BAD_NUMBER, SYNTAX
from gproof.ir.finding import LONGEST, QUOTED, UNBROKEN, Outcome, Related, Span, brief
from gproof.report.text import format_finding

HERE = Span("job.cnc", 1)
LONG = "Q" * 20_000
BLANKS = "word 'and' \"so\" " * 1500


@pytest.mark.parametrize("text", ["", "a", "x" * QUOTED, "word " * 20, "'" + "a b " * 24 + "' is none"])
def test_what_is_short_stays(text: str) -> None:
    assert brief(text) == text


@pytest.mark.parametrize("mark", ["'", '"', ""])
@pytest.mark.parametrize("inner", [LONG, "b" * (2 * UNBROKEN), "b'" * 3000, 'b"' * 3000])
def test_quotations_are_cut_and_the_words_around_them_stay(mark: str, inner: str) -> None:
    inner = inner.replace(mark, "_") if mark else inner
    said = brief(f"key {mark}{inner}{mark} of the machine's own file is none, and nothing else comes from that")
    most = QUOTED if mark else UNBROKEN
    assert said.startswith(f"key {mark}{inner[:most]}...{mark} ({len(inner)} characters) of the machine's own file")
    assert said.endswith("nothing else comes from that")
    assert brief(said) == said


@pytest.mark.parametrize(
    "text", [BLANKS, "'" * 100_000, "a'" * 100_000, "'a' " * 100_000, "' " * 100_000, LONG + " x" * 400]
)
def test_no_message_is_long(text: str) -> None:
    assert len(brief(text)) < LONGEST + 60
    assert "characters)" in brief(text)
    for finding in (BAD_NUMBER.at(HERE, text=text), SYNTAX.at(HERE, what=text, hint=text)):
        assert len(finding.message) < LONGEST + 60
        assert len(finding.hint) < LONGEST + 60
    assert len(Outcome(HERE, text, "is true").text("")) < LONGEST + 90
    finding = SYNTAX.at(HERE, what="", related=(Related(HERE, text),))
    assert max(map(len, format_finding(finding, text, False))) < LONGEST + 90


PROGRAMS = {
    "word.cnc": f"g21 g90\n{LONG}\nm30\n",
    "call.cnc": f"g21 g90\ngosub {LONG}\nm30\n",
    "comment.cnc": f"g21 g90 ({BLANKS}\nm30\n",
    "message.cnc": f"g21 g90\n(msg {BLANKS})\nm0\n(log {LONG})\nx\nm30\n",
    "expression.cnc": f"g21 g90\n#1=[{'1+' * 10_000}]\n#<{LONG}>=1\nif [#<{LONG}> > 1\nm30\n",
    "number.cnc": f"g21 g90\ng1x{'9' * 20_000}y1f100\nn{'1' * 20_000}g0x1\nm{'7' * 20_000}\nm30\n",
    "unknown.cnc": f"g21 g90\nif [{'+'.join(['#4000'] * 2000)} > 1]\ng1 x900\nendif\nm30\n",
    "word.tap": f"g20g90\n{LONG}\nm98 {LONG}\nm98 {LONG[:200]}.tap\nm1{BLANKS}\nm30\n",
    "number.tap": f"g20g90\ng1x{'9' * 20_000}y1f100\n{{{LONG}}}\nl1n1v{'8' * 20_000}\nm30\n",
    "word.src": f"%1\nG90\n{LONG}\n$abc{LONG}\n{LONG.lower()} := 3\nM98 L{'9' * 20_000}\nM30\n%\n",
    "number.src": f"%1\n$if ({LONG.lower()} > 0) then begin\nG01 X({'9' * 20_000})\n$end\nG{'4' * 20_000}\nM30\n%\n",
    "include.src": f"%1\n$I {LONG}\nwriteln '{LONG}'\nCD{'6' * 20_000} := 1\nM30\n%\n",
}  # fmt: skip
MACHINES = {
    "machine.toml": f'schema = "gproof-machine/1"\n{LONG} = 3\nname = "{LONG}"\n[axes.x]\n{LONG} = "{LONG}"\n',
    "WINCNC.INI": f"[{LONG}]\n{LONG}={LONG}\naxischar=xyz{LONG}\naxisspec={LONG}\nvel={'9' * 20_000}\n",
    "cnc.ini": f"[{LONG}]\n{LONG}={LONG}\n[JOINT_0]\n{LONG}={LONG}\nnoSuch={'9' * 20_000}\n",
}
FORMATS = ("text", "json", "sarif", "github", "markdown", "junit")
SETUP = f'schema = "gproof-setup/1"\nname = "{LONG}"\nhomed = ["{LONG}"]\n{LONG} = 1\n'


def held(done: Done) -> None:
    assert "internal error" not in done.err
    for line in (done.out + done.err).split("\n"):
        assert len(line) < 4000, line[:300]
        assert "Q" * (LONGEST + 1) not in line
        assert "9" * 400 not in line


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("name", PROGRAMS)
def test_programs(name: str, form: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(PROGRAMS[name])
    done = in_this_process(("check", name, "--format", form), tmp_path)
    assert done.exit in (1, 2, 3)
    held(done)
    if form == "json":
        assert all(len(one["message"]) < LONGEST + 60 for one in json.loads(done.out)["findings"])


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("name", [*MACHINES, "setup"])
def test_machines_and_setups(name: str, form: str, tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text("g21 g90\ng0 x1\nm30\n")
    (tmp_path / name).write_text(MACHINES.get(name, SETUP))
    option = "--setup" if name == "setup" else "--machine"
    held(in_this_process(("check", "job.cnc", option, name, "--format", form), tmp_path))
