"""Files of settings that are larger, deeper or longer than any shop has: answered in seconds and within a gigabyte."""

from __future__ import annotations

import itertools
import struct
from collections.abc import Callable
from pathlib import Path

import pytest
from support.campaigns import share
from support.command import in_this_process
from support.guarded import alarm, memory

from gproof.frontend.common.toml_table import LARGEST_FILE
from gproof.frontend.mcuwin.ini_keys import KEPT, kept

GIGABYTE = 1 << 30
SECONDS = 5
MANY = 6_000
"""Keys, tables, sections: what takes the square of their number takes longer with so many."""
LONG = 200_000
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n'
SETUP = 'schema = "gproof-setup/1"\n'
JOBS = {
    "job.cnc": "G21 G90\nG0 X1\nM30\n", "job.tap": "G20G90\nG0X1\nM30\n", "job.src": "%1\nG90\nG00 X1\nM30\n%\n",
}  # fmt: skip
INIS = {"cnc.ini": "job.cnc", "WINCNC.INI": "job.tap", "McuWIN.ini": "job.src", "ToolComp.INI": "job.src"}
TOML = {
    "machine.toml": (MACHINE, ("check", "job.cnc", "--machine", "machine.toml")),
    "setup.toml": (SETUP, ("check", "job.cnc", "--setup", "setup.toml")),
    "policy.toml": ('schema = "gproof-policy/1"\n', ("check", "job.cnc", "--policy", "policy.toml")),
    "list.toml": ('schema = "gproof-job/1"\njob = "job.cnc"\n', ("check", "list.toml")),
}
INI_SHAPES: dict[str, Callable[[], str]] = {
    "keys": lambda: "[A]\n" + "".join(f"key{n}=1\n" for n in range(MANY)),
    "keys of no section": lambda: "".join(f"key{n}=1\n" for n in range(MANY)),
    "sections": lambda: "".join(f"[JOINT_{n}]\na=1\n" for n in range(MANY)),
    "one key again": lambda: "[JOINT_0]\n" + "".join(f"name=X{n}\n" for n in range(MANY)),
    "a long key": lambda: "[A]\n" + "k" * LONG + "=1\n[" + "s" * LONG + "]\n",
    "a long value": lambda: "[A]\na=" + "v" * LONG + "\naxischar=" + "X" * LONG + "\n",
    "a long number": lambda: "[JOINT_0]\nname=X\nmaxVel=" + "9" * LONG + "\naxisspec=1 v" + "9" * LONG + "\n",
    "blanks": lambda: " " * LONG + "x\na" + " " * LONG + "b\na =" + " " * LONG + "b" + " " * LONG + "c\n",
    "brackets": lambda: "[" * LONG + "\n" + "]" * LONG + "\n" + "[ " * LONG + "\n",
    "signs": lambda: "=" * LONG + "\n" + '"' * LONG + "\n" + "a=" * LONG + "\n",
    "empty lines": lambda: "\n" * LONG,
}
TOML_SHAPES: dict[str, Callable[[], str]] = {
    "deep arrays": lambda: "a = " + "[" * 10_000 + "]" * 10_000 + "\n",
    "deep tables": lambda: "a = " + "{a=" * 10_000 + "1" + "}" * 10_000 + "\n",
    "tables": lambda: "".join(f"[t{n}]\na=1\n" for n in range(MANY)),
    "tables of a list": lambda: '[[keep_out]]\nname="a"\n' * MANY,
    "keys": lambda: "".join(f"k{n}=1\n" for n in range(MANY)),
    "tools": lambda: "".join(f"[tools.{n}]\nlength=1.0\n" for n in range(MANY)),
    "a long text": lambda: f'name = "{"n" * LONG}"\nx = "{"n" * LONG}"\n',
    "a long key": lambda: "k" * LONG + " = 1\n[" + "s" * LONG + "]\n",
    "a long number": lambda: "a = " + "9" * LONG + "\n",
    "many digits": lambda: "a = " + "9" * 4000 + "\nb = 1e999\n",
    "blanks": lambda: "a" + " " * LONG + "= 1\n[" + " " * LONG + "b]\n",
    "a large file": lambda: "# so that it is long\n" * (LARGEST_FILE // 20),
}


def answered(folder: Path, *words: str) -> None:
    """Within its time and memory, with no more text than somebody reads."""
    for name, text in JOBS.items():
        (folder / name).write_text(text)
    with alarm(SECONDS), memory(GIGABYTE):
        done = in_this_process((*words, "--max-blocks", "1000"), folder)
    assert done.exit in (0, 1, 2, 3), done
    assert "internal error" not in done.err, done.err[:2000]
    said = done.out + done.err
    assert said
    assert len(said) < 40_000
    assert max(map(len, said.splitlines())) < 1_000


@pytest.mark.parametrize(("name", "shape"), share(list(itertools.product(INIS, INI_SHAPES)), 3))
def test_large_ini_files(name: str, shape: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(INI_SHAPES[shape]())
    machine = name
    if name == "ToolComp.INI":
        machine = "machine.toml"
        text = '[controller]\ndialect = "mcuwin"\n[din]\ntool_file = "ToolComp.INI"\n'
        (tmp_path / machine).write_text(MACHINE + text)
    answered(tmp_path, "check", INIS[name], "--machine", machine)


@pytest.mark.parametrize(("name", "shape"), share(list(itertools.product(TOML, TOML_SHAPES)), 3))
def test_large_toml_files(name: str, shape: str, tmp_path: Path) -> None:
    begin, words = TOML[name]
    (tmp_path / name).write_text(begin + TOML_SHAPES[shape]())
    answered(tmp_path, *words)


@pytest.mark.parametrize("facets", [0, 1, 11, 4_000_000_000, 0xFFFFFFFF])
def test_a_mesh_that_claims_what_it_has_not(facets: int, tmp_path: Path) -> None:
    (tmp_path / "setup.toml").write_text(SETUP + '[[fixtures]]\nstl = "b.stl"\n')
    (tmp_path / "b.stl").write_bytes(bytes(80) + struct.pack("<I", facets) + bytes(50) * 10)
    answered(tmp_path, "check", "job.cnc", "--setup", "setup.toml", "--also", "all")


BASELINES: dict[str, Callable[[], str]] = {
    "deep": lambda: "[" * LONG,
    "a number": lambda: '{"schema":' + "9" * LONG + "}",
    "a text": lambda: '{"schema":"' + "s" * LONG + '"}',
    "findings": lambda: '{"schema":"gproof-baseline/1","files":{"job.cnc":['
    + ",".join(f'{{"fingerprint":"{n:032d}","code":"GP243","message":"m"}}' for n in range(MANY)) + "]}}",
}  # fmt: skip


@pytest.mark.parametrize("shape", BASELINES)
def test_large_baselines(shape: str, tmp_path: Path) -> None:
    (tmp_path / "known.json").write_text(BASELINES[shape]())
    answered(tmp_path, "check", "job.cnc", "--baseline", "known.json")


def test_keys_of_mcuwin_by_their_digits() -> None:
    """``?`` stands for one digit; a key of another section or length is none of these."""
    rows = [row.shown.casefold().rpartition("] ") for row in KEPT]
    for section, _, name in rows:
        inside = section.removeprefix("[") or "anything"
        for digit in "0", "9", "?":
            assert kept(inside, name.replace("?", digit))
        if "?" in name:
            assert not kept(inside, name.replace("?", "a"))
            assert not kept(inside, name.replace("?", "10"))
        if section:
            assert not kept("other", name)
        assert not kept(inside, name + "x")
    assert kept("fehlertexte 2", "1")
    assert not kept("my fehlertexte", "1")
