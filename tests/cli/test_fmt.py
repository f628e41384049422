"""``gproof fmt`` from the command line: what is written, what is left alone, exit codes."""

from __future__ import annotations

import io
import os
import random
import stat
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from support import wild
from support.campaigns import seeds

from gproof.cli.main import main

UGLY = "g0x1\n#1=[1+2]\nif[#1==3]then\ng1x2.50       ; cut\nendif\nm30\n"
NICE = "G0 X1\n#1 = [1 + 2]\nif [#1 == 3]\n  G1 X2.5     ; cut\nendif\nM30\n"
WRONG = "G0 X\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ugly.cnc").write_text(UGLY)
    (tmp_path / "nice.cnc").write_text(NICE)
    (tmp_path / "wrong.cnc").write_text(WRONG)
    return tmp_path


@pytest.fixture
def gproof(folder: Path, capsys: pytest.CaptureFixture[str]) -> object:
    def run(*words: str) -> tuple[int, str, str]:
        before = files(folder)
        capsys.readouterr()
        code = main(["fmt", *words])
        captured = capsys.readouterr()
        assert "Traceback" not in captured.out + captured.err
        assert "internal error" not in captured.err
        assert files(folder).keys() == before.keys(), "files were left behind"
        if code == 3 or {"--check", "--diff", "--stdout", "-"} & set(words):
            assert files(folder) == before
        return code, captured.out, captured.err

    return run


def files(folder: Path) -> dict[str, bytes]:
    return {str(p): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_files_are_formatted_in_place(folder: Path, gproof) -> None:
    assert gproof("ugly.cnc", "nice.cnc") == (0, "ugly.cnc: formatted\nnice.cnc: unchanged\n", "")
    assert (folder / "ugly.cnc").read_text() == NICE
    assert gproof("ugly.cnc") == (0, "ugly.cnc: unchanged\n", "")


def test_a_file_with_mistakes_is_left_alone(folder: Path, gproof) -> None:
    code, out, err = gproof("wrong.cnc", "ugly.cnc")
    assert (code, out) == (1, "ugly.cnc: formatted\n")
    assert err.startswith("wrong.cnc:1:4: error GP108 [missing-value] X has no value\n")
    assert err.endswith("wrong.cnc: not formatted\n")
    assert (folder / "wrong.cnc").read_text() == WRONG


def test_check_writes_nothing(gproof) -> None:
    assert gproof("--check", "nice.cnc") == (0, "nice.cnc: unchanged\n", "")
    assert gproof("--check", "nice.cnc", "ugly.cnc")[:2] == (
        1,
        "nice.cnc: unchanged\nugly.cnc: would be formatted\n",
    )
    assert gproof("--check", "wrong.cnc")[0] == 1


def test_diff_is_a_patch(folder: Path, gproof) -> None:
    code, out, err = gproof("--diff", "ugly.cnc", "nice.cnc")
    assert (code, err) == (0, "ugly.cnc: would be formatted\nnice.cnc: unchanged\n")
    assert out.startswith("--- ugly.cnc\n+++ ugly.cnc (formatted)\n@@ -1,6 +1,6 @@\n-g0x1\n")
    assert gproof("--diff", "--check", "ugly.cnc")[:2] == (1, out)


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_a_patched_file_is_the_formatted_one(folder: Path, gproof, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(seed)
    monkeypatch.setattr("gproof.cli.fmt.LONGEST_RUN", 3)
    lines = [rng.choice(["G0 X1", "g0x1", "G1 X2 Y3", ""] if rng.random() < 0.3 else ["G0 X1"]) for _ in range(200)]
    (folder / "long.cnc").write_text("\n".join(lines) + rng.choice(["", "\n"]))
    _, patch, _ = gproof("--diff", "long.cnc")
    (folder / "patched.cnc").write_bytes((folder / "long.cnc").read_bytes())
    if patch:
        subprocess.run(["patch", "-s", "patched.cnc"], input=patch.encode(), check=True)
    gproof("long.cnc")
    assert (folder / "patched.cnc").read_bytes() == (folder / "long.cnc").read_bytes()


def test_stdout_and_standard_input(gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    assert gproof("--stdout", "ugly.cnc") == (0, NICE, "")
    for text, expected in ((UGLY, NICE), ("", "")):
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(text.encode())))
        assert gproof("-") == (0, expected, "")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(WRONG.encode())))
    code, out, err = gproof("-")
    assert (code, out) == (1, "")
    assert err.startswith("-:1:4: error GP108")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(UGLY.encode())))
    assert gproof("--check", "-") == (1, "-: would be formatted\n", "")


@pytest.mark.parametrize(
    ("words", "what"),
    [
        ([], "Missing argument"),
        (["missing.cnc"], "missing.cnc: no such file"),
        (["ugly.cnc", "missing.cnc"], "missing.cnc: no such file"),
        (["empty"], "no programs in it; folders inside it are not searched"),
        (["--stdout", "ugly.cnc", "nice.cnc"], "one file"),
        (["--stdout", "--check", "ugly.cnc"], "--check"),
        (["--stdout", "--diff", "ugly.cnc"], "--diff"),
        (["-", "ugly.cnc"], "cannot be combined"),
        (["--dialect", "heidenhain", "ugly.cnc"], "heidenhain"),
        (["--indent", "8", "ugly.cnc"], "--indent"),
    ],
    ids=" ".join,
)
def test_arguments_that_make_no_sense(words: list[str], what: str, folder: Path, gproof) -> None:
    (folder / "empty").mkdir()
    code, out, err = gproof(*words)
    assert (code, out) == (3, "")
    assert err.count("\n") == 1
    assert what in err


def test_a_folder_that_can_not_be_written(folder: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root may write everywhere, so the system's refusal is played."""
    before = (folder / "ugly.cnc").read_bytes()

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(folder))

    monkeypatch.setattr("gproof.cli.fmt.tempfile.mkstemp", refuse)
    code, out, err = gproof("ugly.cnc")
    assert (code, out) == (3, "")
    assert "Permission denied" in err and "Traceback" not in err
    assert (folder / "ugly.cnc").read_bytes() == before


def test_bytes_that_are_no_text(folder: Path, gproof) -> None:
    (folder / "picture.cnc").write_bytes(b"\x89PNG\0\0")
    code, out, err = gproof("picture.cnc")
    assert (code, out) == (1, "")
    assert "GP119" in err


def test_permissions_and_links_are_kept(folder: Path, gproof) -> None:
    (folder / "ugly.cnc").chmod(0o640)
    (folder / "link.cnc").symlink_to("ugly.cnc")
    assert gproof("link.cnc")[0] == 0
    assert (folder / "link.cnc").is_symlink()
    assert (folder / "ugly.cnc").read_text() == NICE
    assert stat.S_IMODE((folder / "ugly.cnc").stat().st_mode) == 0o640


def test_an_unchanged_file_is_not_touched(folder: Path, gproof) -> None:
    os.utime(folder / "nice.cnc", (1, 1))
    gproof("nice.cnc")
    assert (folder / "nice.cnc").stat().st_mtime == 1


def test_a_macro_file_and_a_job_that_calls_it(folder: Path, gproof) -> None:
    (folder / "macro.cnc").write_text("sub Part\ngosub other_file\nendsub\n")
    (folder / "job.cnc").write_text("GoSub Part\n")
    assert gproof("macro.cnc", "job.cnc")[0] == 0
    assert (folder / "macro.cnc").read_text() == "sub part\n  gosub other_file\nendsub\n"
    assert (folder / "job.cnc").read_text() == "gosub part\n"


@pytest.mark.parametrize(
    ("broken", "what"),
    [
        (b"G0 X2\n", "1.0) and ('X', 2.0) (line 1)"),
        (b"G0 Y\n", "Y has no value (line 1)"),
        (b"", "line count: 6 and 0"),
    ],
)
def test_a_text_that_differs_is_never_written(
    folder: Path, gproof, monkeypatch: pytest.MonkeyPatch, broken: bytes, what: str
) -> None:
    """A printer with a defect: the comparison finds it, and the file stays."""
    text = broken + NICE.encode().split(b"\n", 1)[1] if broken else b""
    monkeypatch.setattr("gproof.backend.emit.eding.program.emit", lambda program: [text])
    code, out, err = gproof("ugly.cnc")
    assert (code, out) == (1, "")
    assert "error GP701 [format-differs]" in err
    assert what in err
    assert (folder / "ugly.cnc").read_text() == UGLY


def test_what_has_no_text_is_refused(folder: Path, gproof) -> None:
    (folder / "deep.cnc").write_text("if [1]\n" * 110 + "endif\n" * 110)
    code, out, err = gproof("deep.cnc")
    assert (code, out) == (1, "")
    assert "error GP702 [not-printable]" in err


@pytest.mark.parametrize("seed", range(3))
def test_any_file_is_formatted_or_refused(folder: Path, gproof, seed: int) -> None:
    rng = random.Random(seed)
    jobs = wild.corpus_jobs()
    makers = (wild.wild_program, wild.random_bytes, lambda rng: wild.mutated(rng, jobs))
    for _ in range(40):
        data = rng.choice(makers)(rng)
        (folder / "wild.cnc").write_bytes(data)
        code, _, err = gproof("--dialect", "eding", "wild.cnc")
        after = (folder / "wild.cnc").read_bytes()
        assert "GP701" not in err, data
        if code == 1:
            assert after == data
            assert " error GP" in err
        else:
            assert code == 0, data
            assert gproof("--dialect", "eding", "--check", "wild.cnc")[0] == 0, data


def test_a_disk_that_is_full(folder: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("gproof.backend.emit.eding.program.emit", full)
    assert gproof("ugly.cnc")[0] == 3


SHOP_INI = """axischar=XYZ
axisspec=p0s0d0r1000a400t1
axisvel=r600f150s50m200h450
axisspec=p0s1d1r1000a400t2
axisvel=r600f150s50m200h450
axisspec=p0s2d2r2000a200t3
axisvel=r200f60s20m50h100
comchars=;'
commatodec=1
"""


@pytest.fixture
def shop(folder: Path) -> Path:
    """A folder of a WinCNC machine whose jobs lie beside it."""
    (folder / "shop").mkdir()
    (folder / "shop" / "WinCNC.ini").write_text(SHOP_INI)
    (folder / "shop" / "Cnc.mac").write_text("M3=M98 SPIN.MAC\nPARK=G53 Z0\n")
    (folder / "shop" / "job.tap").write_text("g0x1,5 ; a\npark\nm3x1\n")
    (folder / "shop" / "SPIN.MAC").write_text("m11c2[on\n")
    return folder / "shop"


def test_a_folder_of_a_machine_says_how_its_files_are_read(shop: Path, gproof) -> None:
    assert gproof("shop/job.tap")[:2] == (0, "shop/job.tap: formatted\n")
    assert (shop / "job.tap").read_text() == "G0 X1.5 ; a\npark\nm3 X1\n"


def test_a_machine_elsewhere(folder: Path, shop: Path, gproof) -> None:
    (folder / "far").mkdir()
    (shop / "job.tap").rename(folder / "far" / "job.tap")
    assert gproof("--dialect", "wincnc", "far/job.tap")[0] == 1  # ; is no comment without the machine's file
    assert gproof("--machine", "shop/WinCNC.ini", "far/job.tap")[:2] == (0, "far/job.tap: formatted\n")
    assert (folder / "far" / "job.tap").read_text() == "G0 X1.5 ; a\npark\nm3 X1\n"


def test_a_folder(shop: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    code, out, _ = gproof("shop")
    files = "shop/Cnc.mac: unchanged\nshop/SPIN.MAC: formatted\nshop/job.tap: formatted\n"
    assert (code, out) == (0, files)
    assert gproof("--check", "shop")[0] == 0
    assert (shop / "SPIN.MAC").read_text() == "M11 C2 [on\n"


def test_a_machine_file_with_mistakes(shop: Path, gproof) -> None:
    (shop / "WinCNC.ini").write_text("axischar=XYZ\ncommatodec=yes\n")
    code, out, err = gproof("shop/job.tap")
    assert (code, out) == (3, "")
    assert "cannot be used" in err
    assert gproof("--machine", "none.ini", "nice.cnc")[0] == 3


def test_a_macro_file_of_wincnc(shop: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    ugly = "m3 = m98  SPIN.MAC x,5 ; on\r\nPark=g53z0   'up\r\nM2= [\r\n\r\nG17=[plane\r\nM9=m12c2[off]\r\n"
    nice = "m3=M98 SPIN.MAC X0.5 ; on\r\nPark=G53 Z0  'up\r\nM2=[\r\n\r\nG17=[plane\r\nM9=M12 C2 [off]\r\n"
    place = shop / "Cnc.mac"
    place.write_bytes(ugly.encode())
    assert gproof("--check", "shop/Cnc.mac")[:2] == (1, "shop/Cnc.mac: would be formatted\n")
    code, patch, _ = gproof("--diff", "shop/Cnc.mac")
    assert code == 0
    assert "\n-M2= [\r\n" in patch
    assert "\n+M2=[\r\n" in patch
    assert gproof("--stdout", "shop/Cnc.mac")[:2] == (0, nice)
    for name in ("shop/Cnc.mac", "shop/CNC.MAC"):
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(ugly.encode())))
        assert gproof("-", "--stdin-name", name)[:2] == (0, nice)
    assert gproof("shop/Cnc.mac")[:2] == (0, "shop/Cnc.mac: formatted\n")
    assert place.read_bytes() == nice.encode()
    assert gproof("--check", "shop/Cnc.mac")[:2] == (0, "shop/Cnc.mac: unchanged\n")


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ("M3=M11C1\nspindle on\n", "GP101"), ("M1=", "GP603"), ("M1=M11C1\nM01=M11C2\n", "GP603"),
        ("M1=M11\x01C1", "GP101"), ("M1=M11C1\rM2=[", "GP702"), ("M1=\0", "GP119"),
    ],
)  # fmt: skip
def test_a_macro_file_with_mistakes_is_left_alone(shop: Path, gproof, text: str, label: str) -> None:
    (shop / "Cnc.mac").write_bytes(text.encode())
    code, out, err = gproof("shop/Cnc.mac")
    assert (code, out) == (1, "")
    assert f"error {label} " in err
    assert (shop / "Cnc.mac").read_bytes() == text.encode()


def test_a_macro_file_that_would_make_a_line_of_a_job_too_long(shop: Path, gproof) -> None:
    """M7 X1 X1 ... has 256 characters when it is replaced by M11C2, and one more by M11 C2."""
    (shop / "Cnc.mac").write_text("M7 = M11C2[on]\nM8=m11 c3\n")
    (shop / "job.tap").write_text("M7 " + "X" * 250 + "\n")
    assert gproof("shop/Cnc.mac")[0] == 0
    assert (shop / "Cnc.mac").read_text() == "M7=M11C2 [on]\nM8=M11 C3\n"
    assert gproof("--check", "shop/Cnc.mac")[0] == 0
    (shop / "job.tap").write_text("M7 " + "X" * 249 + "\n")
    assert gproof("shop/Cnc.mac")[0] == 0
    assert (shop / "Cnc.mac").read_text() == "M7=M11 C2 [on]\nM8=M11 C3\n"


def test_a_macro_file_that_makes_other_programs_is_refused(shop: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    before = "m7 = m11c2\n"
    (shop / "Cnc.mac").write_text(before)
    (shop / "job.tap").write_text("m7 x1\n")
    monkeypatch.setattr("gproof.frontend.wincnc.alone.difference", lambda *_, **__: "1 and 2 (line 1)")
    code, _, err = gproof("shop")
    assert code == 1
    assert "GP702" in err
    assert "shop/SPIN.MAC would be another program (1 and 2 (line 1))" in err
    assert err.endswith("shop/Cnc.mac: not formatted\n")
    assert (shop / "Cnc.mac").read_text() == before


def test_a_line_of_a_job_that_would_be_too_long_when_it_is_replaced_stays(shop: Path, gproof) -> None:
    """117 characters of M7's command, a blank, 135 behind M7: 253, and 23 more in fmt's form; the controller takes 256.

    M8 stands for M7, which then has the longest line.
    """
    (shop / "Cnc.mac").write_text("M7=G1 " + "Z{TH1}" * 19 + "\nM8=M7\n")
    for name in ("m7", "m8"):
        line = name + "y{tp1}" * 22 + "x1x"
        (shop / "job.tap").write_text(f"{line}\n{name} y1z1\n")
        assert gproof("shop/job.tap")[0] == 0
        assert (shop / "job.tap").read_text() == f"{line}\n{name} Y1 Z1\n"


@pytest.mark.parametrize("words", [["--dialect", "eding", "shop/Cnc.mac"], ["nice.cnc", "--stdin-name", "a.tap"],
                                   ["-", "--stdin-name", "nowhere/a.tap"]], ids=" ".join)  # fmt: skip
def test_macro_files_and_options_at_odds(shop: Path, gproof, words: list[str]) -> None:
    code, out, err = gproof(*words)
    assert (code, out) == (3, "")
    assert err.count("\n") == 1


def test_a_wincnc_text_that_differs_is_never_written(shop: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    before = (shop / "job.tap").read_text()
    for text in (b"G0 X1.5\nPARK\nm3 X1\n", b"G0 X1.5 ; a\npark\nm3 X2\n", b"G0 X1.5 ; b\npark\nm3 X1\n"):
        monkeypatch.setattr("gproof.backend.emit.wincnc.program.emit", lambda program, lexical, text=text: [text])
        code, out, err = gproof("shop/job.tap")
        assert (code, out) == (1, "")
        assert "GP701" in err
        assert (shop / "job.tap").read_text() == before
