"""`gproof verify PACKAGE --against SOURCE`: whatever of a package is not what its source gives is named."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from cli.packages import MACHINE, Shop, resigned
from cli.test_trust import refused

JOB = "G21 G90\nG0 X1\nG1 X4 F300\nM3 S1000\nG1 X2\nM0\nG0 X0\nM30\n"
AGAINST = ("--against", "job.cnc", "--machine", "machine.toml", "--setup", "zero")


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    shop = Shop(tmp_path, monkeypatch.setenv)
    (tmp_path / "job.cnc").write_text(JOB)
    return shop


def test_all_parts_are_the_same_wherever_the_source_lies(shop: Shop) -> None:
    shop.compile()
    done = shop("verify", "made.gpx", *AGAINST)
    assert done.exit == 0, done
    assert "source compiled again" in done.out
    (shop.folder / "elsewhere").mkdir()
    shutil.move(shop.folder / "job.cnc", shop.folder / "elsewhere" / "renamed.cnc")
    shutil.copy(shop.folder / "machine.toml", shop.folder / "elsewhere" / "machine.toml")
    words = ("--against", "elsewhere/renamed.cnc", "--machine", "elsewhere/machine.toml", "--setup", "zero")
    assert shop("verify", "made.gpx", *words).exit == 0
    assert sorted(p.name for p in shop.folder.iterdir()) == [
        "elsewhere",
        "machine.toml",
        "made.gpx",
        "me",
        "setup.toml",
    ]


PROGRAMS = {
    "another place": (("X4", "X5"), r"trace\.bin differs in section 0, row \d+ \(line 3\): to "),
    "another feed": (
        ("F300", "F301"),
        r"trace\.bin differs in section 0, row \d+ \(line 3\): feed 300\.0, now 301\.0",
    ),
    "another speed": (
        ("S1000", "S1001"),
        r"trace\.ir differs in line \d+: .*|trace\.bin differs in section 0, row \d+ \(line 4\)",
    ),
    "a line more": (
        ("G1 X2\n", "G1 X2\nG1 X3\n"),
        r"trace\.bin (differs in section 0, row \d+ \(line \d+\)|has \d+ rows in section 0)",
    ),
    "no stop": (("M0\n", ""), r"trace\.bin (differs in section 0, row \d+ \(line \d+\)|has \d+ rows in section 0)"),
    "a comment": (("M3 S1000", "(note) M3 S1000"), "the source files have other SHA-256s"),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_another_program_is_named_by_its_first_part(name: str, shop: Shop) -> None:
    (before, after), said = PROGRAMS[name]
    shop.compile()
    (shop.folder / "job.cnc").write_text(JOB.replace(before, after))
    done = shop("verify", "made.gpx", *AGAINST)
    assert (done.exit, "GP851" in done.out) == (1, True), done
    assert re.search(said, done.out), done.out


def test_another_machine_or_setup_is_named(shop: Shop) -> None:
    shop.compile()
    (shop.folder / "sister").mkdir()
    (shop.folder / "sister" / "machine.toml").write_text(
        MACHINE.replace("steps_per_unit = 100", "steps_per_unit = 200")
    )
    done = shop("verify", "made.gpx", "--against", "job.cnc", "--machine", "sister/machine.toml", "--setup", "zero")
    assert done.exit == 1
    assert "GP823" in done.out
    assert re.search(r"GP851.*machine\.ir differs in line \d+: .*100.*, now .*200", done.out)
    (shop.folder / "other.toml").write_text('schema = "gproof-setup/1"\nhomed = ["x"]\ntool = 1\n[start]\nx = 0.0\n')
    done = shop("verify", "made.gpx", "--against", "job.cnc", "--machine", "machine.toml", "--setup", "other.toml")
    assert done.exit in (1, 2)
    assert re.search("setup.ir differs in line|does not compile now", done.out)


BODIES: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "an assumption dropped": (lambda b: b["assumptions"].pop(), "assumptions of the body differs"),
    "judged what was not": (lambda b: b["not_judged"].pop(), "not_judged of the body differs"),
    "a source of another name and content": (
        lambda b: b["inputs"].append({"name": "x", "sha256": "0" * 64, "role": "source"}),
        "other SHA-256s",
    ),
    "a condition dreamt up": (
        lambda b: b["properties"][1]["conditions"].append({"terms": [["g92.x", 1]], "low": "-1.0", "high": "1.0"}),
        "properties of the body differs",
    ),
}


@pytest.mark.parametrize("name", BODIES)
def test_a_body_that_says_more_than_the_source_gives(name: str, shop: Shop) -> None:
    change, said = BODIES[name]
    private, public = shop.key("other")
    shop.compile("--key", str(private))
    resigned(shop.folder / "made.gpx", private, change)
    assert shop("verify", "made.gpx", "--trust", public.name, "--setup", "zero").exit == 0, "nothing else shows it"
    done = shop("verify", "made.gpx", "--trust", public.name, *AGAINST)
    assert (done.exit, said in done.out) == (1, True), done


def test_another_runs_interval_is_named(shop: Shop) -> None:
    """A step some ticks later is within the bounds of the checker, and not what the source gives."""
    from gproof.verify.certificate.keys import load_key
    from gproof.verify.certificate.package import read_package
    from gproof.verify.certificate.write import write_package
    from gproof.verify.stream import validate

    private, public = shop.key("other")
    package = read_package(shop.compile("--key", str(private)))
    runs = package.stream.sections[0].runs[0]
    runs["interval"][2] += 1
    runs["interval"][3] -= 1
    body = package.body
    from gproof.ir.verdict import DEFAULT_POLICY, PropertyResult, Verdict

    report = validate(package.stream, package.trace, package.machine, package.setup)
    write_package(
        shop.folder / "late.gpx", job="job.cnc", version=body["gproof"],
        inputs=[(i["name"], i["sha256"], i["role"]) for i in body["inputs"]],
        properties=[PropertyResult(name=name, verdict=Verdict.SAFE) for name in DEFAULT_POLICY],
        not_judged=body["not_judged"], assumptions=body["assumptions"], machine=package.machine, setup=package.setup,
        trace=package.trace, stream=package.stream, report=report, key=load_key(private),
    )  # fmt: skip
    done = shop("verify", "late.gpx", "--trust", public.name, *AGAINST)
    assert done.exit == 1
    assert re.search(r"stream/0\.bin differs in section 0, run 2: interval \d+, now \d+", done.out), done.out


def test_another_version_is_unknown_and_said(shop: Shop) -> None:
    private, public = shop.key("other")
    shop.compile("--key", str(private))

    def older(body):
        was = body["gproof"]
        body["gproof"] = "0.0.1"
        for one in body["properties"]:
            one.update(version="0.0.1" if one["version"] == was else one["version"])
        body["assumptions"].pop()

    resigned(shop.folder / "made.gpx", private, older)
    done = shop("verify", "made.gpx", "--trust", public.name, *AGAINST)
    assert (done.exit, "GP852" in done.out, "instead of 0.0.1" in done.out) == (2, True, True), done


def test_a_source_that_does_not_compile(shop: Shop) -> None:
    shop.compile()
    (shop.folder / "job.cnc").write_text("G21 G90\nG0 X900\nM30\n")
    done = shop("verify", "made.gpx", *AGAINST)
    assert (done.exit, "does not compile now (UNSAFE)" in done.out, "GP301" in done.out) == (1, True, True)
    done = shop("verify", "made.gpx", *AGAINST, "--format", "json")
    assert (done.exit, json.loads(done.out)["verdict"]) == (1, "UNSAFE")


def test_words_that_do_not_fit(shop: Shop) -> None:
    shop.compile()
    assert shop("run", "made.gpx", "--board", "virtual", "--record", "r.json").exit == 0
    for words, said in (
        (("--against", "job.cnc"), "--machine"),
        (("--against", "nothere.cnc", "--machine", "machine.toml"), "no such file"),
        (("--against", ".", "--machine", "machine.toml"), "is a folder"),
        (("--against", "machine.toml", "--machine", "machine.toml"), "is not a program"),
        (("--dialect", "eding"), "--against"),
        ((*AGAINST, "--dialect", "basic"), "basic"),
        ((*AGAINST, "--against", "other.cnc"), "given twice, as"),
    ):
        refused(shop("verify", "made.gpx", *words), said)
    refused(shop("verify", "r.json", *AGAINST[:2]), "for packages")


def test_what_compile_was_told_is_told_again(shop: Shop) -> None:
    """--call, --max-blocks and --max-branches of compile; without --call another program is compiled."""
    machine = MACHINE + '[controller]\ndialect = "eding"\nmax_step_frequency = 100000\n'
    (shop.folder / "machine.toml").write_text(machine)
    program = "sub user_1\n  G0 X7\n  #1 = 0\n  while [#1 < 3]\n    G0 X[#1]\n    #1 = [#1 + 1]\n  endwhile\nendsub\n"
    (shop.folder / "job.cnc").write_text(program + "G21 G90\nG0 X1\nM30\n")
    told = ("--call", "user_1", "--max-blocks", "1000", "--max-branches", "7")
    shop.compile("--dialect", "eding", *told)
    against = (*AGAINST, "--dialect", "eding")
    done = shop("verify", "made.gpx", *against, *told)
    assert done.exit == 0, done
    done = shop("verify", "made.gpx", *against)
    assert (done.exit, "GP851" in done.out) == (1, True), done
    done = shop("verify", "made.gpx", *against, "--call", "user_1", "--max-blocks", "2")
    assert done.exit == 2, done
    assert "does not compile now (UNKNOWN)" in done.out


@pytest.mark.parametrize("option", [("--call", "user_1"), ("--max-blocks", "9"), ("--max-branches", "9")])
def test_what_compile_was_told_belongs_to_a_source(option: tuple[str, str], shop: Shop) -> None:
    shop.compile()
    done = shop("verify", "made.gpx", *option)
    assert done.exit == 3
    assert "--against" in done.err
