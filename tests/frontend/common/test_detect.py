"""The dialect of a job by its name and its text."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.each import each

from gproof.driver.dialects import guess_dialect

CORPUS = sorted((Path(__file__).resolve().parents[3] / "corpus" / "eding").glob("*/job.cnc"))


@each("path", CORPUS, ids=lambda path: path.parent.name)
def test_the_corpus_is_eding(path: Path) -> None:
    assert guess_dialect(path)[0] == "eding"


@pytest.mark.parametrize(
    ("name", "text", "dialect", "reason"),
    [
        ("a.cnc", "g0 x1\n", "eding", "extension .cnc"),
        ("a.NGC", "g0 x1\n", "eding", "extension .ngc"),
        ("a.tap", "g0 x1\n", "wincnc", "extension .tap"),
        ("a.gcode", "g0 x1\n", "eding", "extension .gcode"),
        ("a.tap", "g0 x1\n#1=3\n", "eding", "numbered parameter in line 2"),
        ("a", "g0\nEnd Sub\n", "eding", "flow control in line 2"),
        ("a.xyz", "%\ng0 x1\n%\n", "eding", "the default"),
        ("a.tap", "%mx=200\n% DY = 30\ng0 x1\n", "eding", "nesting line in line 1"),
        ("a.mac", "g0 x1\nhome z\n", "eding", "command of this controller in line 2"),
        ("a.mac", "Tanknife on\n", "eding", "command of this controller in line 1"),
        ("a.tap", "[macro call]\ng0 x1\n", "wincnc", "in line 1"),
        ("a.tap", "g0 x1\nL3\n", "wincnc", "L code in line 2"),
        ("a.mac", "g0 x1\n", "wincnc", "extension .mac"),
        ("a.src", "%1000\nN1 G0 X1\n", "mcuwin", "in line 1"),
        ("a.cnc", "G0 X1\n$wt(100);\n", "mcuwin", "in line 2"),
        ("a.cnc", "N350 $if (CI600 < 20) then begin\n", "mcuwin", "in line 1"),
        ("a.cnc", "G0 X1\nL5\nM96 L5\n", "mcuwin", "jump or call of a label in line 3"),
        ("a.cnc", "G0 X1\nM98 L 5 O2\n", "mcuwin", "in line 2"),
        ("a.cnc", "G0 X1 (M98 L5)\n", "eding", "extension .cnc"),
        ("a.cnc", "CD620 := 100\n", "mcuwin", "calculation parameter in line 1"),
        ("a.src", "g0 x1\n", "mcuwin", "extension .src"),
        ("a.DIN", "g0 x1\n", "mcuwin", "extension .din"),
        ("a.din", "G0 X1\nL5\n", "mcuwin", "extension .din"),
        ("a.tap", "% a comment\nL3\n", "wincnc", "L code in line 2"),
        ("missing.tap", None, "wincnc", "extension .tap"),
    ],
)
def test_guesses(tmp_path: Path, name: str, text: str | None, dialect: str, reason: str) -> None:
    path = tmp_path / name
    if text is not None:
        path.write_text(text)
    found, why = guess_dialect(path)
    assert found == dialect
    assert reason in why


MCUWIN = sorted((Path(__file__).resolve().parents[3] / "corpus" / "mcuwin").glob("*/jobs/*.src"))
SHOPS = sorted((Path(__file__).resolve().parents[3] / "corpus" / "wincnc").glob("*/jobs/*.tap"))


@each("path", SHOPS, ids=lambda path: f"{path.parents[1].name}/{path.stem}")
def test_the_shops_are_wincnc(path: Path) -> None:
    assert guess_dialect(path)[0] == "wincnc"


@each("path", MCUWIN, ids=lambda path: f"{path.parents[1].name}/{path.stem}")
def test_jobs_of_mcuwin(path: Path) -> None:
    assert guess_dialect(path)[0] == "mcuwin"


@pytest.mark.parametrize("name", ["WINCNC.INI", "wincnc.ini", "Cnc.Mac"])
@pytest.mark.parametrize("folder", [".", "jobs"])
def test_a_shop_file_beside_the_job_or_one_up(tmp_path: Path, name: str, folder: str) -> None:
    (tmp_path / name).write_text("unit=IN\n")
    job = tmp_path / folder / "part.nc"
    job.parent.mkdir(exist_ok=True)
    job.write_text("g0 x1\n")
    dialect, why = guess_dialect(job)
    assert (dialect, name in why) == ("wincnc", True)
    job.write_text("g0 x1\n#1=2\n")
    assert guess_dialect(job)[0] == "eding"


@pytest.mark.parametrize("name", ["McuWIN.ini", "ToolComp.INI"])
def test_a_file_of_mcuwin_beside_the_job(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("")
    job = tmp_path / "a.cnc"
    job.write_text("G0 X1\n")
    assert guess_dialect(job)[0] == "mcuwin"


def test_a_module_or_a_comment_of_a_shop(tmp_path: Path) -> None:
    job = tmp_path / "a.tap"
    job.write_text("%plate\ng0 x1\n")
    assert guess_dialect(job)[0] == "mcuwin"
    (tmp_path / "WINCNC.INI").write_text("unit=IN\n")
    assert guess_dialect(job)[0] == "wincnc"
