"""The smallest inputs of what the random ones have found, a family each: every one is answered, and in a moment."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command import Done, in_this_process
from support.guarded import alarm

from gproof.backend.emit.mcuwin import parts as mcuwin_parts
from gproof.driver.dialects import load_machine, load_setup
from gproof.frontend.common.exact_numbers import exact_ratio
from gproof.frontend.mcuwin import patterns
from gproof.frontend.wincnc import ini_file
from gproof.frontend.wincnc import line as wincnc_line
from gproof.frontend.wincnc.load import load_program
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.finding import Findings
from gproof.ir.program import If, Unsupported

MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n'
LONG_NAME = "n" * 5000


@pytest.fixture(autouse=True)
def traced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GPROOF_TRACEBACK", "1")


def ran(folder: Path, *words: str) -> Done:
    with alarm(10):
        return in_this_process(words, folder)


# -- conditions one behind the other: each line of them doubles what may run


@pytest.mark.parametrize("line", ["M17.1 C6", "M17.2 C6"])
@pytest.mark.parametrize("count", [2, 5, 9])
def test_some_conditions_in_a_row_are_followed(line: str, count: int, tmp_path: Path) -> None:
    job = tmp_path / "job.tap"
    job.write_text(f"{line}\n" * count + "G0 X1\nG0 X2\n")
    findings = Findings()
    program = load_program(job, findings, NO_SHOP)
    assert program is not None
    assert isinstance(program.body[0], If)
    assert not findings.kept


@pytest.mark.parametrize("count", [10, 11, 20, 100, 3000])
def test_many_conditions_in_a_row_are_not_known(count: int, tmp_path: Path) -> None:
    job = tmp_path / "job.tap"
    job.write_text("M17.1 C6\n" * count + "G0 X1\nG0 X2\n")
    findings = Findings()
    with alarm(10):
        program = load_program(job, findings, NO_SHOP)
    assert program is not None
    assert any(isinstance(node, Unsupported) for node in program.body)
    assert ran(tmp_path, "check", "job.tap", "--dialect", "wincnc").exit in (1, 2)


# -- a number that no double holds, where lines may be of any length


@pytest.mark.parametrize("digits", [300, 301, 302, 308, 309, 310, 400, 5000])
@pytest.mark.parametrize("word", ["M{}", "G{}", "X{}", "X-{}", "X{{{}}}", "X{{{}*2}}", "X{{2*{}}}"])
def test_numbers_beyond_all_in_a_macro(word: str, digits: int, tmp_path: Path) -> None:
    (tmp_path / "CNC.MAC").write_text(f"MYMACRO=G0 {word.format('9' * digits)}\n")
    (tmp_path / "job.tap").write_text("G90\nMYMACRO\n")
    alone = ran(tmp_path, "check", "CNC.MAC", "--dialect", "wincnc")
    assert alone.exit in (1, 2), alone
    done = ran(tmp_path, "check", "job.tap", "--dialect", "wincnc")
    assert done.exit == 1, done


# -- signs one behind the other


@pytest.mark.parametrize(
    "text", ["{}1 (note)", "G0 X{}1 (note)", "#1={}1 (note)", "G0 X-{}[1] ; note", "G0 X{}", "X{}sin[1]"]
)
@pytest.mark.parametrize("signs", ["#" * 1500, "-#" * 1500, "#[" * 1500, "[" * 1500, "-" * 1500, "sin[" * 1500])
def test_many_signs_in_a_row(text: str, signs: str, tmp_path: Path) -> None:
    line = text.format(signs)
    (tmp_path / "macro.cnc").write_text(f"sub user_1\n{line}\nendsub\n")
    (tmp_path / "job.cnc").write_text("G21 G90\ngosub user_1\nM30\n")
    assert ran(tmp_path, "check", "job.cnc", "--dialect", "eding").exit == 1
    assert ran(tmp_path, "fmt", "macro.cnc", "--dialect", "eding").exit in (0, 1, 3)


# -- names that no file can have


@pytest.mark.parametrize("name", [LONG_NAME, "a\\u0000b", "x/" * 3000])
def test_names_that_can_not_be(name: str, tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text("G21 G90\nM30\n")
    (tmp_path / "machine.toml").write_text(f'{MACHINE}base = "{name}"\n')
    findings = Findings()
    assert load_machine(tmp_path / "machine.toml", findings)[0] is None
    assert findings.kept
    for key in ("job", "machine", "setup", "policy"):
        keys = {"job": "job.cnc", key: name}
        text = "\n".join(f'{k} = "{v}"' for k, v in keys.items())
        (tmp_path / "list.toml").write_text(f'schema = "gproof-job/1"\n{text}\n')
        done = ran(tmp_path, "check", "list.toml")
        assert done.exit == 3, done
        assert all(len(line) < 7_000 for line in done.err.splitlines())


@pytest.mark.parametrize("pattern", ["*" * 3000, "[", "**/" * 500, "?" * 300, "[z-a].cnc"])
def test_patterns_that_match_nothing(pattern: str, tmp_path: Path) -> None:
    (tmp_path / "list.toml").write_text(f'schema = "gproof-job/1"\njob = "{pattern}"\n')
    assert ran(tmp_path, "check", "list.toml").exit == 3


# -- long lines of short words: what stands behind a word is looked at once


@pytest.mark.parametrize("text", ["G01" * 8_000, "G" * 90_000, "X1" * 20_000, "G01.X" * 15_000, "a[" * 40_000,
                                  "a.b" * 30_000, "a " * 40_000, "G01a" * 20_000 + ":=1"])  # fmt: skip
def test_long_lines_of_mcuwin(text: str, tmp_path: Path) -> None:
    (tmp_path / "job.src").write_text(f"{text}\nM30\n")
    assert ran(tmp_path, "check", "job.src", "--dialect", "mcuwin", "--max-blocks", "1000").exit in (1, 2)


# -- blocks of a drawing: one that is not there, and copies without end


SETUP = 'schema = "gproof-setup/1"\n[stock]\ndxf = "plate.dxf"\nbottom = -1\ntop = 0\n'
HEAD = "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 BLOCKS"
BLOCK = "0 BLOCK 2 {} 10 0 20 0 {} 0 ENDBLK"
PLACE = "10 0 20 0 44 1 45 1"
DRAWINGS = {
    "no such block": (BLOCK.format("A", ""), f"0 INSERT 8 0 2 B {PLACE}", "Required block"),
    "an array of no such block": (BLOCK.format("A", ""), f"0 INSERT 8 0 2 B {PLACE} 70 2 71 2", "Required block"),
    "an array of a billion": (BLOCK.format("B", ""), f"0 INSERT 8 0 2 B {PLACE} 70 32767 71 32767", "copies"),
    "arrays in arrays": (
        BLOCK.format("A", "") + " " + BLOCK.format("B", f"0 INSERT 8 0 2 A {PLACE} 70 90 71 90"),
        f"0 INSERT 8 0 2 B {PLACE} 70 90 71 90", "copies",
    ),
    "itself": (BLOCK.format("B", f"0 INSERT 8 0 2 B {PLACE} 70 2 71 2"), f"0 INSERT 8 0 2 B {PLACE}", "too deep"),
}  # fmt: skip


@pytest.mark.parametrize("name", DRAWINGS)
def test_blocks_of_drawings(name: str, tmp_path: Path) -> None:
    blocks, entities, told = DRAWINGS[name]
    text = f"{HEAD} {blocks} 0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    (tmp_path / "plate.dxf").write_text("\n".join(text.split()) + "\n")
    (tmp_path / "setup.toml").write_text(SETUP)
    findings = Findings()
    with alarm(10):
        assert load_setup(tmp_path / "setup.toml", findings)[0] is None
    assert any(told in finding.message for finding in findings.kept), findings.kept


# -- nesting deeper than the stack


@pytest.mark.parametrize(
    "text", ["[" * 50_000, '{"a":' * 50_000, '{"schema":"gproof-baseline/1","files":' + "[" * 50_000]
)
def test_deep_baselines(text: str, tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text("G21 G90\nM30\n")
    (tmp_path / "known.json").write_text(text)
    done = ran(tmp_path, "check", "job.cnc", "--baseline", "known.json")
    assert done.exit == 3
    assert "not a baseline" in done.err


# -- digits without end


@pytest.mark.parametrize("letter", "GLM")
def test_a_code_of_many_digits_that_a_missing_macro_file_may_define(letter: str, tmp_path: Path) -> None:
    """Asked of each line that is none while CNC.MAC is not there: whether a macro of that name may be in it.

    A command of the settings file has no longest line.
    """
    (tmp_path / "WINCNC.INI").write_text(f"[WINCNC]\naxischar=XYZ\ncmdabort={letter}{'9' * 400} ]\n")
    (tmp_path / "job.tap").write_text("G20\n")
    done = ran(tmp_path, "check", "job.tap", "--machine", "WINCNC.INI")
    assert done.exit in (1, 2), done
    assert "internal error" not in done.err


@pytest.mark.parametrize("end", ["", "x", ".x", "/5x"])
def test_words_of_many_digits_take_no_longer_than_they_are_long(end: str) -> None:
    for word in ("9" * 200_000 + end, "." + "9" * 200_000 + end):
        with alarm(5):
            assert exact_ratio(word) is None
            for pattern in (wincnc_line._NUMBER, ini_file._NUMBER, patterns._NUMBER, mcuwin_parts._LITERAL):
                assert bool(pattern.fullmatch(word)) == (end == "")
