"""What others wrote, at each place where a file or a command line may hold text, in each format that prints it.

On a terminal it is text; of GitHub's commands it is the message; Markdown shows it as words; XML and JSON are read back
as they were. ``test_escape.py`` has packages, records and the messages at stops.
"""

from __future__ import annotations

import io
import json
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from cli.packages import MACHINE, Shop
from markdown_it import MarkdownIt
from support.campaigns import share
from support.command import Done
from support.each import each

from gproof.cli.main import main
from gproof.cli.progress import Progress
from gproof.driver.escape import in_one_line
from gproof.report.escape import json_text, program_line, xml_text

MARK = "evil7"
"""Stands in every hostile text: where it is printed, the text was."""
PARTS = {
    "sequences": "\x1b[31m\x1b[2J\x1b]0;title\x07\x1b]8;;http://e.test\x07l\x1b]8;;\x07\x1b]52;c;YQ==\x07",
    "controls": "\x9b2J\x08\x7f\x85\x1f\x0b",
    "directions": "\u202e\u2066\u2069\u200b\u200f\ufeff\u2028\u2029\u00ad\U000e0041",
    "commands": "::error::q ::stop-commands::x %0A::error::%25 ##[error]w ##[add-mask]",
    "markdown": "|`a`|``b` <script>alert(1)</script> [l](http://e.test) ![i](http://e.test/i) https://e.test "
    "www.e.test <http://e.test> &lt;b&gt; *b* __u__ ~~s~~ # h $x$ {0} \\",
    "xml": "]]> &amp; </text><script>x</script> <!-- --> \ufffe \ufdd0 <?php ?>",
    "lines": "\r\n::error file=a::b\n\n# heading\n\tgproof: SAFE\n",
    "nothing": "\x00",
}
"""By what they act on."""
ONE_LINE = " ".join(text for name, text in PARTS.items() if name not in ("lines", "nothing"))
IN_TOML = f"{MARK} {' '.join(PARTS.values())}"
IN_A_LINE = f"{MARK} {ONE_LINE}".replace("\x0b", "").replace("\x85", "").replace("\u2028", "").replace("\u2029", "")
VISIBLE = f"{MARK} \u202e\u2066 {PARTS['commands']} {PARTS['markdown']}"
"""No control characters, which are no program."""
IN_A_NAME = f"::error::{MARK} {ONE_LINE}{PARTS['lines']}".replace("/", "_").encode()[:230].decode("utf-8", "ignore")
UNDECODABLE = os.fsdecode(b"\xff\xfe") + IN_A_NAME


def toml(text: str) -> str:
    return '"' + "".join(c if c.isalnum() else f"\\U{ord(c):08X}" for c in text) + '"'


# -- what each format owes


def of_a_terminal(text: str) -> None:
    """Nothing acts on it, on GitHub's runner neither."""
    for line in text.split("\n"):
        assert line.isprintable(), line
        assert not line.lstrip().startswith("::"), line
        assert not re.search(r"##\[[a-z]", line), line


def of_github(text: str) -> None:
    for line in text.split("\n"):
        assert line.isprintable(), line
        if line.lstrip().startswith("::"):
            assert re.match(r"::(error|warning|notice) (file=[^:,]+(,\w+=[^:,]+)*|title=gproof)::", line), line
        else:
            assert not re.search(r"##\[[a-z]", line), line


def of_json(text: str) -> object:
    of_a_terminal(text)
    return json.loads(text)


def of_xml(text: str) -> ET.Element:
    for line in text.split("\n"):
        assert line.replace("\t", "").isprintable(), line
        assert not line.lstrip().startswith("::"), line
        assert not re.search(r"##\[[a-z]", line), line
    return ET.fromstring(text)


MARKUP = {
    "heading_open", "heading_close", "paragraph_open", "paragraph_close", "inline", "table_open", "table_close",
    "thead_open", "thead_close", "tbody_open", "tbody_close", "tr_open", "tr_close", "th_open", "th_close", "td_open",
    "td_close", "bullet_list_open", "bullet_list_close", "list_item_open", "list_item_close", "text", "text_special",
    "code_inline", "strong_open", "strong_close", "em_open", "em_close",
}  # fmt: skip
"""Whatever a report is made of: no link, picture, HTML, code block or line of its own."""


def of_markdown(text: str) -> None:
    of_a_terminal(text)
    tokens = MarkdownIt("commonmark", {"linkify": False}).enable("table").parse(text)
    for token in tokens:
        assert token.type in MARKUP, token
        for child in token.children or ():
            assert child.type in MARKUP, child
            assert not re.search(r"https?://", child.content) or "\\://" in text or child.type == "code_inline", child
    rows = text.split("\n| ")[1:]
    assert len({len(re.findall(r"(?<!\\)\|", row.split("\n")[0])) for row in rows}) <= 1, rows
    assert not re.search(r"(?i)(?<!`)https?://", re.sub(r"`[^`]*`", "", text).replace("\\://", "")), text


FORMATS: dict[str, tuple[tuple[str, ...], Callable[[str], object]]] = {
    "text": (("check", "{job}"), of_a_terminal),
    "quiet": (("check", "{job}", "--quiet"), of_a_terminal),
    "every": (("check", "{job}", "--all", "--also", "all"), of_a_terminal),
    "several": (("check", "{job}", "plain.cnc"), of_a_terminal),
    "json": (("check", "{job}", "--format", "json"), of_json),
    "sarif": (("check", "{job}", "--format", "sarif"), of_json),
    "junit": (("check", "{job}", "--format", "junit"), of_xml),
    "github": (("check", "{job}", "--format", "github"), of_github),
    "markdown": (("check", "{job}", "--format", "markdown"), of_markdown),
    "fit": (("fit", "{job}"), of_a_terminal),
    "fit json": (("fit", "{job}", "--format", "json"), of_json),
    "program": (("dump", "{job}", "--stage", "program"), of_a_terminal),
    "trace": (("dump", "{job}", "--stage", "trace"), of_a_terminal),
    "stream": (("dump", "{job}", "--stage", "stream"), of_a_terminal),
    "lines": (("dump", "{job}", "--stage", "trace", "--format", "jsonl"), of_a_terminal),
    "compile": (("compile", "{job}", "-o", "out.gpx", "--unsigned"), of_a_terminal),
    "picture": (("check", "{job}", "--picture", "out.svg"), of_a_terminal),
    "fit picture": (("fit", "{job}", "--picture", "out.svg"), of_a_terminal),
}

# -- places: the files of a shop with the hostile text in one of them, and the command line that reads them

ON = ("--machine", "machine.toml", "--setup", "setup.toml")
ZONE = "[[keep_out]]\nname = {}\nx = [50.0, 60.0]\ny = [0.0, 1.0]\nz = [0.0, 1.0]\n"
CLAMP = "[[fixtures]]\nname = {}\nbox = [[50.0, 0.0, 0.0], [60.0, 1.0, 1.0]]\n"
SETUP = 'schema = "gproof-setup/1"\nhomed = ["x"]\nstart = {x = 0.0}\n'
JOB = "G21 G90\nG0 X1\nG0 X55\nG0 X900\nM30\n"
Place = tuple[dict[str, str], tuple[str, ...]]


def places() -> dict[str, Place]:
    name, key = toml(IN_TOML), toml(IN_TOML)
    out: dict[str, Place] = {
        "machine's name": ({"machine.toml": MACHINE.replace("units =", f"name = {name}\nunits =")}, ON),
        "zone's name": ({"machine.toml": MACHINE + ZONE.format(name)}, ON),
        "setup's name": ({"setup.toml": SETUP + f"name = {name}\n"}, ON),
        "clamp's name": ({"setup.toml": SETUP + CLAMP.format(name)}, ON),
        "zone of the setup": ({"setup.toml": SETUP + ZONE.format(name)}, ON),
        "key of the machine": ({"machine.toml": f"{key} = 1\n" + MACHINE}, ON),
        "table of the machine": ({"machine.toml": MACHINE + f"[{key}]\nx = 1\n"}, ON),
        "axis": ({"machine.toml": MACHINE + f"[axes.{key}]\nmin = 0\n"}, ON),
        "tool": ({"machine.toml": MACHINE + f"[tools.{key}]\nlength = 1.0\n"}, ON),
        "value of the machine": ({"machine.toml": MACHINE.replace('"mm"', name)}, ON),
        "schema of the machine": ({"machine.toml": MACHINE.replace('"gproof-machine/1"', name)}, ON),
        "base of the machine": ({"machine.toml": MACHINE.replace("units =", f"base = {name}\nunits =")}, ON),
        "key of the setup": ({"setup.toml": SETUP + f"{key} = 1\n"}, ON),
        "value of the setup": ({"setup.toml": SETUP.replace('"x"', name)}, ON),
        "file of the setup": ({"setup.toml": SETUP + f"[height_map]\nfile = {name}\n"}, ON),
        "drawing of the setup": ({"setup.toml": SETUP + f"[stock]\ndxf = {name}\nbottom = -1\ntop = 0\n"}, ON),
        "mesh of the setup": ({"setup.toml": SETUP + f"[[fixtures]]\nstl = {name}\n"}, ON),
        "no TOML": ({"setup.toml": "\x1b[2J" + IN_A_LINE}, ON),
        "program": ({"job.cnc": f"{IN_A_LINE}\n"}, ON),
        "word": ({"job.cnc": f"G21 G90\nG0 X1 {IN_A_LINE}\nM30\n"}, ON),
        "comment": ({"job.cnc": f"G21 G90 ({IN_A_LINE})\nG0 X1 Q5 ; {IN_A_LINE}\nM30\n"}, ON),
        "message": ({"job.cnc": f'G21 G90\nmsg "{IN_A_LINE}"\n(MSG, {IN_A_LINE})\nM0 {IN_A_LINE}\nG0 X900\nM30\n'}, ON),
        "visible message": (
            {"job.cnc": f"G21 G90\n(MSG, {VISIBLE})\nM0\nG0 X9\nM30\n"},
            ON,
        ),
        "subprogram": ({"job.cnc": f"G21 G90\ngosub {IN_A_LINE}\nG0 X1\nM30\n"}, ON),
        "reason": (
            {"job.cnc": f"G21 G90\nM22 (gproof: allow GP113: {VISIBLE.replace(')', ' ')})\nG0 X1\n(gproof: allow "
             f"{VISIBLE}: why)\nM30\n"},
            ON,
        ),
        "policy's key": ({"policy.toml": f'schema = "gproof-policy/1"\n{key} = 1\n'}, (*ON, "--policy", "policy.toml")),
        "policy's value": (
            {"policy.toml": f'schema = "gproof-policy/1"\nfail_on = {name}\n'}, (*ON, "--policy", "policy.toml"),
        ),
        "baseline": (
            {"known.json": json.dumps({"schema": IN_TOML, "files": {IN_TOML: IN_TOML}})},
            (*ON, "--baseline", "known.json"),
        ),
        "Eding's section": ({"cnc.ini": f"[{IN_A_LINE}]\n{IN_A_LINE} = 1\n"}, ("--machine", "cnc.ini")),
        "Eding's value": (
            {"cnc.ini": f"[JOINT_0]\nname = {IN_A_LINE}\nmaxVel = {IN_A_LINE}\n"}, ("--machine", "cnc.ini"),
        ),
        "WinCNC's key": (
            {"WINCNC.INI": f"Version=2.5.08\n{IN_A_LINE}=1\nAxis1={IN_A_LINE}\naxisspec={IN_A_LINE}\n"},
            ("--machine", "WINCNC.INI"),
        ),
        "McuWIN's key": (
            {"McuWIN.ini": f"[{IN_A_LINE}]\n{IN_A_LINE}=1\n[General]\n{IN_A_LINE}\n"}, ("--machine", "McuWIN.ini"),
        ),
        "McuWIN's tools": (
            {"ToolComp.INI": f"[{IN_A_LINE}]\n{IN_A_LINE}=1\nT1={IN_A_LINE}\n",
             "machine.toml": 'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "mcuwin"\n'
             '[din]\ntool_file = "ToolComp.INI"\n'},
            ("--machine", "machine.toml"),
        ),
        "name of the machine file": ({f"{IN_A_NAME[:60]}.toml": "x = 1\n"}, ("--machine", f"{IN_A_NAME[:60]}.toml")),
        "no machine file": ({}, ("--machine", UNDECODABLE)),
        "no setup": ({}, ("--machine", "machine.toml", "--setup", UNDECODABLE)),
        "call": ({}, (*ON, "--call", IN_A_LINE)),
        "option": ({}, (*ON, f"--{IN_A_LINE}")),
        "dialect": ({}, (*ON, "--dialect", IN_A_LINE)),
    }  # fmt: skip
    return out


PLACES = places()
JOBS = {
    "name of the job": f"{IN_A_NAME[:100]}.cnc",
    "undecodable name": f"{UNDECODABLE[:90]}.cnc",
    "folder": f"{IN_A_NAME[:90]}/a.cnc",
    "no such job": f"nothere {UNDECODABLE[:90]}.cnc",
    "tap": f"{IN_A_NAME[:60]}.tap",
    "src": f"{IN_A_NAME[:60]}.src",
}
QUIET_PLACES = {"no TOML"}


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    made = Shop(tmp_path, monkeypatch.setenv)
    (tmp_path / "setup.toml").write_text(SETUP)
    (tmp_path / "plain.cnc").write_text(JOB)
    (tmp_path / "job.cnc").write_text(JOB)
    return made


def told(shop: Shop, form: str, job: str, on: tuple[str, ...]) -> Done:
    """One format of one place; both streams are as they should be."""
    words, judge = FORMATS[form]
    done = shop(*(word.replace("{job}", job) for word in words), *on)
    assert done.exit in (0, 1, 2, 3), done
    assert "internal error" not in done.err, done
    of_a_terminal(done.err)
    if done.out:
        judge(done.out.removesuffix("\n"))
    picture = shop.folder / "out.svg"
    if picture.exists():
        text = picture.read_text()
        assert text.replace("\n", "").isprintable()
        drawn = ET.fromstring(text)
        assert {element.tag.rpartition("}")[2] for element in drawn.iter()} <= {
            "svg", "g", "path", "rect", "text", "circle", "clipPath", "line",
        }  # fmt: skip
        for element in drawn.iter():
            assert all(character.isprintable() for character in (element.text or "").strip()), element.text
    return done


@pytest.mark.parametrize("place", share(list(PLACES), 2))
def test_every_format_of_every_place(place: str, shop: Shop) -> None:
    files, on = PLACES[place]
    for name, text in files.items():
        (shop.folder / name).write_text(text, encoding="utf-8", errors="surrogateescape")
    seen = ""
    for form in FORMATS:
        if form == "quiet" or (form.startswith("fit") and "--policy" in on):
            continue
        seen += "".join((done := told(shop, form, "job.cnc", on)).out + done.err)
    assert MARK in seen, place


@pytest.mark.parametrize("place", JOBS)
def test_every_format_of_every_name(place: str, shop: Shop) -> None:
    path = shop.folder / JOBS[place]
    if place != "no such job":
        path.parent.mkdir(exist_ok=True)
        path.write_text(JOB)
    for form in FORMATS:
        done = told(shop, form, f"./{JOBS[place]}", ON)
        assert MARK in done.out + done.err or form in ("lines", "stream", "picture"), (form, done)


def test_values_are_kept_where_programs_read_them(shop: Shop) -> None:
    name = toml(IN_TOML)
    (shop.folder / "machine.toml").write_text(MACHINE.replace("units =", f"name = {name}\nunits ="))
    report = json.loads(shop("check", "job.cnc", *ON, "--format", "json").out)
    assert report["machine"] == IN_TOML
    job = JOBS["name of the job"]
    (shop.folder / job).write_text(JOB)
    assert json.loads(shop("check", job, *ON, "--format", "json").out)["job"] == job
    sarif = json.loads(shop("check", job, *ON, "--format", "sarif").out)
    assert job in sarif["runs"][0]["properties"]["verdicts"]
    suite = ET.fromstring(shop("check", job, *ON, "--format", "junit").out).find("testsuite")
    assert suite is not None
    assert suite.get("name") == re.sub("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe]", "\ufffd", job)


@pytest.mark.parametrize("words", [("explain", IN_A_LINE), (IN_A_LINE,), ("keys", "show", IN_A_LINE),
                                   ("keys", "trust", UNDECODABLE), ("keys", "revoke", IN_A_LINE),
                                   ("keys", "trust", "job.cnc", "--name", IN_A_LINE), ("verify", UNDECODABLE),
                                   ("run", UNDECODABLE, "--board", "virtual"), ("run", "x", "--board", IN_A_LINE),
                                   ("fmt", UNDECODABLE), ("check", "job.cnc", "--report", f"junit={UNDECODABLE}/x"),
                                   ("check", "job.cnc", "--report", IN_A_LINE), ("check", f"*{IN_A_LINE}"),
                                   ("check", "job.cnc", "--also", IN_A_LINE), ("check", "job.cnc", "--jobs", IN_A_LINE),
                                   ("check", "job.cnc", "--output", f"{UNDECODABLE}/x"), ("fmt", "--stdin-name",
                                    UNDECODABLE + "/x", "-"), ("keys", "trust", "job.cnc", "--expires", IN_A_LINE),
                                   ("run", "x", "--board", "virtual", "--override", IN_A_LINE)],
                         ids=lambda words: " ".join(words)[:20].encode("ascii", "replace").decode())  # fmt: skip
def test_arguments(words: tuple[str, ...], shop: Shop) -> None:
    done = shop(*words)
    assert done.exit == 3, done
    assert done.out == ""
    assert done.err.count("\n") == 1, done
    of_a_terminal(done.err)


def test_job_files_of_others(shop: Shop) -> None:
    for key in ("job", "machine", "setup", "policy", "dialect", "also", toml(IN_TOML)):
        text = {"job": '"job.cnc"', key: toml(IN_TOML)}
        lines = "\n".join(f"{name} = {value}" for name, value in text.items())
        (shop.folder / "list.toml").write_text(f'schema = "gproof-job/1"\n{lines}\n')
        for form in ("text", "json", "sarif", "junit", "github", "markdown"):
            done = told(shop, form, "list.toml", ())
            assert done.exit == 3, done
            assert MARK in done.err, done


# -- the text of a program itself


class Screen(io.TextIOWrapper):
    """Standard output that is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("words", [("fmt", "--stdout"), ("fmt", "--diff")], ids=" ".join)
def test_lines_of_a_program(words: tuple[str, ...], shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    """As they are for a file or a pipe; as text where somebody looks at them."""
    line = f"g0   x1 ; {MARK} \u202e\u2066 {PARTS['markdown']}"
    (shop.folder / "job.cnc").write_bytes(b"g21 g90\ng0  x2 ; \xb0\xe9\n" + line.encode() + b"\nm30")
    assert f"{MARK} \u202e\u2066" in shop(*words, "job.cnc").out
    screen = Screen(io.BytesIO(), encoding="utf-8")
    monkeypatch.setattr(sys, "stdout", screen)
    monkeypatch.chdir(shop.folder)
    main([*words, "job.cnc"])
    screen.flush()
    seen = screen.buffer.getvalue().decode()  # type: ignore[attr-defined]
    assert MARK + r" \u202e\u2066" in seen
    assert "\u202e" not in seen


def test_a_line_on_a_terminal() -> None:
    assert program_line("G0\tX1 ; \x1b[2J\u202e\r\n") == "G0\tX1 ; \\x1b[2J\\u202e\n"
    assert program_line("G0 X1") == "G0 X1"


def test_what_a_bar_shows() -> None:
    bar = Progress("reading", wanted=False)
    bar.done(1, f"checking {IN_A_NAME} [red]x[/red]")
    assert bar._state["description"] == in_one_line(f"checking {IN_A_NAME} [red]x[/red]")
    assert bar._state["description"].isprintable()


@each("character", [*map(chr, range(0x100)), *"\u200b\u202e\u2028\ud800\udcff\ue000\U000e0041"], ids=ascii)
def test_every_character_is_read_back(character: str) -> None:
    text = json_text({"a": f"x{character}##[b]"})
    assert text.isprintable()
    assert "##[" not in text
    assert json.loads(text) == {"a": f"x{character}##[b]"}
    if character >= " " and not "\ud800" <= character <= "\udfff":
        root = ET.Element("a", b=character)
        root.text = f"::{character}##[b]"
        document = xml_text(ET.tostring(root, encoding="unicode"))
        assert document.isprintable()
        again = ET.fromstring(document)
        assert (again.get("b"), again.text) == (character, f"::{character}##[b]")
