"""Calls that each call the next ones several times end in seconds, with a finding that names them: in every dialect."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from support.campaigns import share
from support.command import in_this_process

from gproof.passes.interpret.core.loop_widening import CALL_BLOCKS, call_blocks

Files = dict[str, str]
BLOCKS = 30_000
LETTERS = "abcdefghijklmnopqrstuvwxyz"


def eding(levels: int, width: int) -> Files:
    subs = "".join(f"sub s{n}\n" + f"gosub s{n + 1}\n" * width + "endsub\n" for n in range(levels))
    return {"job.cnc": f"{subs}sub s{levels}\ng1 x1\ng1 x0\nendsub\ng21 g90 f100\ngosub s0\nm30\n"}


def files(levels: int, width: int) -> Files:
    """WinCNC: subprogram files."""
    made = {f"A{n}.TAP": f"M98 A{n + 1}.TAP\n" * width for n in range(levels)}
    return made | {f"A{levels}.TAP": "G1 X1\nG1 X0\n", "job.tap": "G20 G90\nF100\nM98 A0.TAP\nM30\n"}


def with_letters(levels: int, width: int) -> Files:
    """WinCNC: subprogram files that hand a letter on."""
    made = {f"A{n}.TAP": f"M98 A{n + 1}.TAP X{{X}}\n" * width for n in range(levels)}
    return made | {f"A{levels}.TAP": "G1 X{X}\nG1 X0\n", "job.tap": "G20 G90\nF100\nM98 A0.TAP X1\nM30\n"}


def macros(levels: int, width: int) -> Files:
    """WinCNC: definitions of CNC.MAC, whose files use the next one."""
    made = {f"m{n}.mac": f"MM{n + 1}\n" * width for n in range(levels)}
    table = "".join(f"MM{n}=M98 m{n}.mac\n" for n in range(levels + 1))
    ini = "axischar=xyz\n"
    job = "G20 G90\nF100\nMM0\nM30\n"
    return made | {f"m{levels}.mac": "G1X1\nG1X0\n", "CNC.MAC": table, "WINCNC.INI": ini, "job.tap": job}


def modules(levels: int, width: int) -> Files:
    """McuWIN: subprograms of the DIN language."""
    made = "".join(f"%{1000 + n}\n" + f"M98 L{1001 + n}\n" * width + "M17\n" for n in range(levels))
    return {"job.src": f"%1\nG90\nF10\nM98 L1000\nM30\n{made}%{1000 + levels}\nG01 X1\nG01 X0\nM17\n%\n"}


def repeats(levels: int, width: int) -> Files:
    """McuWIN: calls with a number of cycles."""
    made = "".join(f"%{1000 + n}\nM98 L{1001 + n} O{width}\nM17\n" for n in range(levels))
    return {"job.src": f"%1\nG90\nF10\nM98 L1000\nM30\n{made}%{1000 + levels}\nG01 X1\nG01 X0\nM17\n%\n"}


def procedures(levels: int, width: int) -> Files:
    """McuWIN: procedures of rw_SymPas."""

    def name(n: int) -> str:
        return f"p{LETTERS[n // 26]}{LETTERS[n % 26]}"

    made = "".join(
        f"procedure {name(n)};\nbegin\n" + f"{name(n + 1)};\n" * width + "end;\n" for n in reversed(range(levels))
    )
    last = f"procedure {name(levels)};\nbegin\nv := v + 1;\nend;\n"
    start = f"{{$DINSTART}}\n%1\nG90\nF10\nv := 0\n${name(0)};\nG01 X(v)\nM30\n%\n"
    return {"job.src": f"N1 $DINEND\nvar v : double;\n{last}{made}{start}"}


WAYS: tuple[Callable[[int, int], Files], ...] = (
    eding, files, with_letters, macros, modules, repeats, procedures,
)  # fmt: skip


@pytest.mark.parametrize(
    ("way", "levels", "width"),
    share([(way, *size) for way in WAYS for size in [(18, 2), (6, 10), (5, 100), (3, 1000)]], 5),
)
def test_they_end_with_a_finding_that_names_them(
    way: Callable[[int, int], Files], levels: int, width: int, tmp_path: Path
) -> None:
    made = way(levels, width)
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    job = next(name for name in made if name.startswith("job."))
    on = ("--machine", "WINCNC.INI") if "WINCNC.INI" in made else ()
    words = ("check", job, *on, "--setup", "zero", "--format", "json", "--max-blocks", str(BLOCKS))
    done = in_this_process(words, tmp_path)
    assert done.exit in (1, 2), done
    found = [one for one in json.loads(done.out)["findings"] if one["code"] == "GP233"]
    assert len(found) == 1, done.out[:2000]
    assert "check the nested calls: " in found[0]["hint"]
    assert found[0]["hint"].count(" > ") >= min(levels, 3) - 1


@pytest.mark.parametrize("levels", [21, 40, 60])
@pytest.mark.parametrize("way", [eding, files, with_letters, macros])
def test_calls_that_go_too_deep_are_named(way: Callable[[int, int], Files], levels: int, tmp_path: Path) -> None:
    made = way(levels, 2)
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    job = next(name for name in made if name.startswith("job."))
    on = ("--machine", "WINCNC.INI") if "WINCNC.INI" in made else ()
    done = in_this_process(("check", job, *on, "--setup", "zero", "--max-blocks", str(BLOCKS)), tmp_path)
    assert done.exit in (1, 2)
    assert "GP117" in done.out or "GP233" in done.out


def test_what_a_call_counts_as() -> None:
    """One of the job itself counts as its line; those within others as much as they take."""
    assert [call_blocks(depth) for depth in range(6)] == [*CALL_BLOCKS, CALL_BLOCKS[-1]]
    assert call_blocks(0) == 0
    assert list(CALL_BLOCKS) == sorted(CALL_BLOCKS)
    assert call_blocks(50) == 200


@pytest.mark.parametrize("way", [eding, files, modules])
def test_many_calls_of_the_job_itself_are_followed(way: Callable[[int, int], Files], tmp_path: Path) -> None:
    made = way(0, 0)
    name = next(name for name in made if name.startswith("job."))
    lines = made[name].split("\n")
    at = next(n for n, line in enumerate(lines) if line.startswith(("gosub", "M98")))
    made[name] = "\n".join([*lines[:at], *[lines[at]] * 3000, *lines[at + 1 :]])
    for one, text in made.items():
        (tmp_path / one).write_text(text)
    done = in_this_process(("check", name, "--setup", "zero", "--max-blocks", str(BLOCKS)), tmp_path)
    assert "GP233" not in done.out, done
