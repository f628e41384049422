"""What others wrote reaches a terminal as text: no name, message, comment or setting acts on it, in any command."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest
from cli.packages import BOARD, COMPILE, MACHINE, Shop, resigned
from support.command import Done
from support.each import each

from gproof.driver.escape import LONGEST, escaped, shown

HOSTILE = (
    "x\x1b[2J\x1b]0;title\x07\r\n\tgproof: SAFE\x00\x7f\x9b31m"
    "\u202e\u2066\u200b\ufeff\u2028\u2029\u00ad\ue000\U000e0041"
)
"""Clears the screen, sets the title, begins a line of its own, turns the order round, hides letters."""


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    return Shop(tmp_path, monkeypatch.setenv)


def harmless(done: Done, *, seen: bool = True) -> None:
    """Each stream is made of lines of printable text; the hostile text is in it, visibly."""
    for stream in (done.out, done.err):
        for line in stream.split("\n"):
            assert line.isprintable(), line
            assert not line.startswith("\tgproof"), line
            assert not line.startswith("gproof: SAFE"), line
    assert "Traceback" not in done.err
    if seen:
        assert "\\x1b[2J" in done.out + done.err, done


@each("number", [*range(0x20), 0x7F, *range(0x80, 0xA0)])
def test_control_characters_are_numbers(number: int) -> None:
    assert shown(chr(number)) == f"\\x{number:02x}"


@each(
    "number",
    [0x61C, *range(0x200B, 0x2010), *range(0x2028, 0x202F), *range(0x2060, 0x2070), 0xFEFF, 0xE000, 0xFFFF, 0xDC80],
)
def test_what_can_not_be_seen_is_a_number(number: int) -> None:
    assert shown(chr(number)) == f"\\u{number:04x}"


def test_every_character_of_unicode_is_printable_afterwards() -> None:
    for number in itertools.chain(range(0x3000), range(0xD7F0, 0x10000), range(0x10000, 0x110000, 0x101)):
        assert escaped(chr(number)).isprintable()
    assert shown("Fräse 3, ±0.1 mm, 主轴") == "Fräse 3, ±0.1 mm, 主轴"
    assert shown("a\u00a0b\u3000c") == "a b c"
    long = shown("x" * 10_000)
    assert len(long) < LONGEST + 30
    assert long.endswith("... (10000 characters)")


# -- packages


def claims(body):
    body["job"] = HOSTILE
    body["assumptions"] = [HOSTILE]
    body["not_judged"] = [HOSTILE]
    for one in body["properties"]:
        one["assumptions"] = [HOSTILE]
        one["conditions"] = [{"terms": [[HOSTILE, 1]], "low": "0.0", "high": "1.0"}]
    body["properties"].append(
        dict(body["properties"][0], name=HOSTILE, verdict=HOSTILE, checker=HOSTILE, bound=HOSTILE)
    )
    body["inputs"] = [{"name": HOSTILE, "sha256": HOSTILE, "role": "source"}]
    body["gproof"] = HOSTILE


@pytest.mark.parametrize("hostile", ["label", "body", "job", "format", "members"])
def test_packages_of_others(hostile: str, shop: Shop) -> None:
    private, public = shop.key("other")
    shop.compile("--key", str(private))
    change = {
        "label": lambda body: None,
        "body": claims,
        "job": lambda body: body.update(job=HOSTILE),
        "format": lambda body: body.update(format=HOSTILE),
        "members": lambda body: body["members"].update({HOSTILE: HOSTILE}),
    }[hostile]
    label = {"created": HOSTILE, "comment": HOSTILE} if hostile == "label" else {}
    resigned(shop.folder / "made.gpx", private, change, **label)
    trust = ("--trust", public.name)
    harmless(shop("verify", "made.gpx", *trust))
    harmless(shop("verify", "made.gpx", "--source", "job.cnc"), seen=hostile != "label")
    done = shop("verify", "made.gpx", *trust, "--format", "json")
    assert done.out.isascii()
    json.loads(done.out)
    harmless(shop("run", "made.gpx", *BOARD, *trust), seen=hostile not in ("label", "job"))
    if hostile == "job":
        assert shop("run", "made.gpx", *BOARD, *trust, "--record", "record.json").exit == 0
        harmless(shop("verify", "record.json"))
        harmless(shop("verify", "record.json", "--package", "made.gpx"))


@pytest.mark.parametrize("field", ["job", "reason", "accepted", "board"])
def test_records_of_others(field: str, shop: Shop) -> None:
    shop.compile()
    assert shop("run", "made.gpx", *BOARD, "--record", "record.json").exit == 0
    path = shop.folder / "record.json"
    value = json.loads(path.read_text())
    if field == "board":
        value["board"]["name"] = HOSTILE
    else:
        value[field] = HOSTILE
    path.write_text(json.dumps(value, sort_keys=True, separators=(",", ":")) + "\n")
    harmless(shop("verify", "record.json"), seen=False)


# -- machine files, setups, programs


def toml(text: str) -> str:
    return '"' + "".join(c if c.isalnum() else f"\\U{ord(c):08X}" for c in text) + '"'


@pytest.fixture
def hostile_shop(shop: Shop) -> Shop:
    name = toml(HOSTILE)
    (shop.folder / "machine.toml").write_text(
        MACHINE.replace("units =", f"name = {name}\nunits =")
        + f"[[keep_out]]\nname = {name}\nx = [50.0, 60.0]\ny = [0.0, 1.0]\nz = [0.0, 1.0]\n"
    )
    (shop.folder / "setup.toml").write_text(f'schema = "gproof-setup/1"\nname = {name}\nhomed = ["x"]\n')
    return shop


COMMANDS = [
    ("check", "job.cnc", "--machine", "machine.toml", "--setup", "zero"),
    ("check", "job.cnc", "job.cnc", "--machine", "machine.toml", "--setup", "zero"),
    ("check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml"),
    ("fit", "job.cnc", "--machine", "machine.toml"),
    ("fit", "job.cnc", "--machine", "machine.toml", "--machine", "other.toml"),
    (*COMPILE, "-o", "made.gpx"),
]


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_machines_setups_and_zones_of_others(words: tuple[str, ...], hostile_shop: Shop) -> None:
    (hostile_shop.folder / "other.toml").write_text((hostile_shop.folder / "machine.toml").read_text())
    done = hostile_shop(*words)
    assert "cannot be used" not in done.err, done
    harmless(done, seen=False)
    (hostile_shop.folder / "job.cnc").write_text("G21 G90\nG0 X900\nG0 X55\nM30\n")
    harmless(hostile_shop(*words), seen=False)


def test_a_machine_that_was_certified_under_a_hostile_name(hostile_shop: Shop) -> None:
    (hostile_shop.folder / "machine.toml").write_text(MACHINE.replace("units =", f"name = {toml(HOSTILE)}\nunits ="))
    (hostile_shop.folder / "plain.toml").write_text(MACHINE)
    hostile_shop.compile()
    harmless(hostile_shop("verify", "made.gpx"))
    harmless(hostile_shop("verify", "made.gpx", "--machine", "plain.toml"))
    harmless(hostile_shop("run", "made.gpx", *BOARD, "--machine", "plain.toml"))


@pytest.mark.parametrize("words", [*COMMANDS, ("fmt", "--check", "job.cnc")], ids=" ".join)
def test_programs_of_others(words: tuple[str, ...], shop: Shop) -> None:
    (shop.folder / "other.toml").write_text(MACHINE)
    for text in (f"G21 G90 ({HOSTILE})\nG0 X1\nM30\n", f"G21\n(MSG,{HOSTILE})\nG0 X1 {HOSTILE}\nM30\n", HOSTILE):
        (shop.folder / "job.cnc").write_text(text)
        harmless(shop(*words), seen=False)


def test_messages_of_a_job_at_its_stops(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    # Control characters are no program; those that turn the order of letters round are.
    hostile = "put in tool \u202e9 loot\u2066 \u200b"
    (shop.folder / "job.cnc").write_text(f"G21 G90\nG0 X1\n(MSG,{hostile})\nM0\nG0 X2\nM30\n")
    done = shop(*COMPILE, "-o", "made.gpx")
    harmless(done, seen=False)
    assert done.exit == 0, done
    asked: list[str] = []
    monkeypatch.setattr("builtins.input", lambda prompt: asked.append(prompt) or "")
    harmless(shop("run", "made.gpx", *BOARD, "--ask"), seen=False)
    assert asked
    assert all(prompt.isprintable() for prompt in asked)


def test_names_of_files(shop: Shop) -> None:
    name = HOSTILE.replace("\x00", "").replace("/", "")[:60] + ".cnc"
    (shop.folder / name).write_text("G21 G90\nG0 X900\nM30\n")
    on = ("--machine", "machine.toml", "--setup", "zero")
    for words in (
        ("check", name, *on),
        ("fit", name, "--machine", "machine.toml"),
        ("compile", name, *on, "-o", "x.gpx"),
        ("fmt", name),
        ("verify", name),
        ("run", name, *BOARD),
        ("verify", "nothere" + name),
        ("keys", "trust", name),
        ("keys", "show", name),
        ("keys", "revoke", name),
        ("keys", "trust", "job.cnc", "--name", name),
        ("explain", name),
        (name,),
        ("check", name, f"--{name}"),
    ):
        harmless(shop(*words), seen=False)
