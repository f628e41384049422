"""Numbers that no machine has, in each key of each kind of settings file: a finding with a place, no crash.

Our own files are made from the table of their keys; those of controllers from the files that the project has, a number
or value of one line in place of what stands there. A run makes a sample of them, whose seed is printed with the file.
"""

from __future__ import annotations

import functools
import random
import re
from pathlib import Path

import pytest
from corpus.expectations import ROOT
from frontend.common.test_own_keys import HEADS, header, tables
from support.bundles import unpacked
from support.campaigns import seeds
from support.command import in_this_process

from gproof.driver.dialects import load_machine, load_setup
from gproof.frontend.common.own_keys import KEYS
from gproof.frontend.wincnc.ini_keys import KEYS as WINCNC
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine

DIGITS = "9" * 300
IN_TOML = (
    DIGITS, f"-{DIGITS}", "9" * 4000, "1e400", "1e308", "-1e308", "1e-400", "1e-300", "-0.0", "0x1F", "1_0", "nan",
    "inf", "-inf", f"0.{'0' * 300}1", f"3.{'3' * 300}", f'"{DIGITS}"', '"\uff11\uff12"', '"nan"', '"1e400"',
    "[nan, 1e308]", f"[{DIGITS}, {DIGITS}]", "[[-1e308, 1e308], [nan, inf], [1, 2]]", "[1e-300, 1e-300]", "[]",
    "9223372036854775808",
)  # fmt: skip
IN_INI = (
    DIGITS, f"-{DIGITS}", "9" * 5000, "1e400", "1e308", "1E-400", "-0", f"0.{'0' * 300}1", f"3.{'3' * 300}", "0x1F",
    ".", "+5", "1_0", "\uff11\uff12", "nan", "inf", "-inf", "1,5", "", "9223372036854775808", "-1", "1/0",
)  # fmt: skip
CASES = 60
"""Of a seed."""
JOBS = {
    "job.cnc": "G21 G90 F100\nG0 X1 Y1\nG1 Z-1 A5\nG2 X3 Y1 I1 J0\nM6 T1\nG43 H1\nM3 S100\nG4 P1\nM30\n",
    "job.tap": "G20G90\nF100\nT1\nG0X1Y1\nG1Z-1\nG2X3Y1I1J0\nL21\nG4X1\nM3\n",
    "job.src": "%1\nG90\nF100\nT1\nG00 X1 Y1\nG01 Z-1\nG02 X3 Y1 I1 J0\nM6\nG04 1\nM30\n%\n",
}
OF_OURS = {
    "gproof-machine/1": ("check", "job.cnc", "--machine", "file.toml", "--setup", "zero", "--also", "all"),
    "gproof-setup/1": ("check", "job.cnc", "--setup", "file.toml", "--also", "all"),
    "gproof-policy/1": ("check", "job.cnc", "--policy", "file.toml"),
    "gproof-job/1": ("check", "file.toml"),
}
TABLES = [(schema, path, keys) for schema in HEADS for path, keys in tables(KEYS[schema]) if keys.own]
SINGLE = [(schema, path, key) for schema, path, keys in TABLES for key in sorted(keys.own - {"schema"})]


def answered(folder: Path, words: tuple[str, ...], said: str) -> None:
    """With an exit code of a verdict, or 3 behind a finding with a place; said: how to do it again."""
    for name, text in JOBS.items():
        (folder / name).write_text(text)
    done = in_this_process((*words, "--max-blocks", "1000"), folder)
    assert done.exit in (0, 1, 2, 3), (said, done.err)
    assert "internal error" not in done.err, (said, done.err)
    if done.exit == 3:
        assert re.search(r"(?m)^[^ :]+\.\w+:\d+:\d+: error GP|^gproof: error: ", done.err), (said, done.err)
    for line in (done.out + done.err).splitlines():
        assert len(line) < 1_000, (said, line)


# -- our own files

LOADERS = {"gproof-machine/1": load_machine, "gproof-setup/1": load_setup}


@pytest.mark.parametrize(
    ("schema", "path"),
    [table[:2] for table in TABLES if table[0] in LOADERS],
    ids=lambda value: value if isinstance(value, str) else ".".join(value),
)
def test_all_keys_of_a_table_at_once(schema: str, path: tuple[str, ...], tmp_path: Path) -> None:
    begin = HEADS[schema] + (header(path) if path else "")
    load = LOADERS[schema]
    own = [one for where, place, one in SINGLE if (where, place) == (schema, path) and one not in ("base", "file")]
    for number in IN_TOML:
        written = [key for key in own if f"\n{key} = " not in "\n" + begin]
        (tmp_path / "file.toml").write_text(begin + "".join(f"{key} = {number}\n" for key in written))
        findings = Findings()
        read, _ = load(tmp_path / "file.toml", findings)
        assert read is not None or findings.kept
        if isinstance(read, Machine):
            read.verify()
        for finding in findings.kept:
            assert finding.span.line > 0, finding


@pytest.mark.parametrize("seed", seeds(2, 100))
def test_a_key_alone(seed: int, tmp_path: Path) -> None:
    """In a command that uses it."""
    rng = random.Random(f"a key alone {seed}")
    for _ in range(CASES):
        schema, path, key = rng.choice(SINGLE)
        begin = HEADS[schema] + (header(path) if path else "")
        begin = "".join(line for line in begin.splitlines(True) if not line.startswith(f"{key} = "))
        text = begin + f"{key} = {rng.choice(IN_TOML)}\n"
        (tmp_path / "file.toml").write_text(text)
        answered(tmp_path, OF_OURS[schema], text[:600])


# -- files of controllers, and our own as shops have them


@functools.cache
def lines_of(name: str) -> dict[str, tuple[str, int]]:
    """By key, a file of this name that has it, and the line."""
    out: dict[str, tuple[str, int]] = {}
    for folder in (ROOT / "corpus", unpacked("docs/codes"), unpacked("tests/hand")):
        for path in sorted(folder.rglob("*")):
            if path.name.lower() != name.lower() or path.stat().st_size > 20_000:
                continue
            text = path.read_text("utf-8", "replace")
            for number, line in enumerate(text.split("\n")):
                key = re.split("[=(;]", line)[0].strip().lower()
                if re.search(r"\d", line) and key not in out:
                    out[key] = text, number
    return out


FILES = {
    "cnc.ini": ("check", "job.cnc", "--machine", "cnc.ini", "--setup", "zero"),
    "WINCNC.INI": ("check", "job.tap", "--machine", "WINCNC.INI", "--setup", "zero"),
    "McuWIN.ini": ("check", "job.src", "--machine", "McuWIN.ini"),
    "ToolComp.INI": ("check", "job.src", "--machine", "machine.toml"),
    "CNC.MAC": ("check", "CNC.MAC", "--dialect", "wincnc"),
    "machine.toml": ("check", "job.cnc", "--machine", "machine.toml", "--setup", "zero", "--also", "all"),
    "setup.toml": ("check", "job.cnc", "--setup", "setup.toml", "--also", "all"),
}
AROUND = {
    "ToolComp.INI": {
        "machine.toml": 'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "mcuwin"\n[din]\n'
        'tool_file = "ToolComp.INI"\n'
    }
}
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)")


def other(rng: random.Random, line: str, numbers: tuple[str, ...]) -> str:
    """The line with another number in place of one of its, or of all behind its sign."""
    number = rng.choice(numbers)
    if "=" in line and rng.random() < 0.3:
        return line.partition("=")[0] + "= " + number
    found = rng.choice([*_NUMBER.finditer(line)])
    return line[: found.start()] + number + line[found.end() :]


@pytest.mark.parametrize("seed", seeds(1, 100))
@pytest.mark.parametrize("name", FILES)
def test_a_line_with_another_number(name: str, seed: int, tmp_path: Path) -> None:
    rng = random.Random(f"{name} {seed}")
    places = lines_of(name)
    assert places
    for file, text in AROUND.get(name, {}).items():
        (tmp_path / file).write_text(text)
    for _ in range(CASES // 2):
        text, at = places[rng.choice(sorted(places))]
        lines = text.split("\n")
        lines[at] = other(rng, lines[at], IN_TOML if name.endswith("toml") else IN_INI)
        (tmp_path / name).write_text("\n".join(lines))
        answered(tmp_path, FILES[name], f"{name} line {at + 1} of {lines[0][:60]!r}: {lines[at][:400]}")


AXES = "axischar=XYZ\n" + "".join(f"axisspec={n} s1000 l-10 h50 v100 a10 p1 t0\n" for n in range(3))


@pytest.mark.parametrize("seed", seeds(1, 100))
def test_a_key_of_wincnc(seed: int, tmp_path: Path) -> None:
    """Each that the manual names, bare and with each of its letters."""
    rng = random.Random(f"WinCNC {seed}")
    for _ in range(CASES // 2):
        rule = WINCNC[rng.choice(sorted(WINCNC))]
        letters = sorted(rule.letters) or [""]
        words = " ".join(rng.choice(letters) + rng.choice(IN_INI) for _ in range(rng.randrange(1, 3)))
        (tmp_path / "WINCNC.INI").write_text(f"{AXES}{rule.key}={words}\n")
        answered(tmp_path, FILES["WINCNC.INI"], f"{rule.key}={words[:400]}")


@pytest.mark.parametrize(
    ("text", "line"),
    [("[cylinder]\nradius = 1e-300\n", 4), ("name = 'a'\n[workpiece]\ncell = 1e-300\n", 5)],
)
def test_a_number_out_of_its_range_has_its_line(text: str, line: int, tmp_path: Path) -> None:
    (tmp_path / "file.toml").write_text(f"# a setup\n{HEADS['gproof-setup/1']}{text}")
    findings = Findings()
    assert load_setup(tmp_path / "file.toml", findings)[0] is None
    assert [one.span.line for one in findings.kept] == [line]
