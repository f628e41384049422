"""Programs of WinCNC as neutral jobs: each line as the manual has it, worked out by hand."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from support.bundles import sections
from support.job_lines import job_lines

from gproof.driver.session import open_session
from gproof.frontend.wincnc import FRONTEND
from gproof.ir.job import Job
from gproof.ir.text import parse_ir, print_ir

PAGE = Path(__file__).with_name("raising.md")
CORPUS = Path(__file__).resolve().parents[3] / "corpus" / "wincnc"


def raised(job: Path, machine: Path, setup: str | None = None) -> Job:
    session = open_session(job, machine=machine, setup=setup, dialect="wincnc")
    assert session.program is not None
    return FRONTEND.raise_program(session.program, session.machine, session.setup)


SECTIONS = {section.heading: section for section in sections(PAGE.read_text("utf-8"))}


def folder_of(name: str, folder: Path) -> Path:
    """The files of a section, with those of the machine that it does not have itself."""
    files = SECTIONS["machine"].files | SECTIONS[name].files
    files["WINCNC.INI"] = SECTIONS["machine"].files["WINCNC.INI"] + files.pop("more.ini", b"")
    for file, content in files.items():
        (folder / file).write_bytes(content)
    if "more.toml" not in files:
        return folder / "WINCNC.INI"
    own = files["more.toml"].decode()
    text = f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\n{own}'
    (folder / "machine.toml").write_text(text, "utf-8")
    return folder / "machine.toml"


@pytest.mark.parametrize("name", [name for name in SECTIONS if name not in ("", "machine")])
def test_operations_that_the_manual_has(name: str, tmp_path: Path) -> None:
    job = raised(tmp_path / "job.tap", folder_of(name, tmp_path))
    job.verify()
    expected = SECTIONS[name].files["job.txt"].decode().splitlines()
    assert job_lines(job) == expected


PLACES = """\
schema = "gproof-setup/1"
units = "mm"
[positions.P3]
x = 50.8
y = 25.0
lift = false
[positions.P4]
x = 1.0
lift = true
"""


def test_stored_positions_are_where_the_setup_has_them(tmp_path: Path) -> None:
    """A place in machine coordinates; next to axes only theirs count, a number is a distance from it (P, H)."""
    machine = folder_of("machine-coordinates", tmp_path)
    (tmp_path / "places.toml").write_text(PLACES)
    job = tmp_path / "job.tap"
    job.write_text("G22\nG53 P3\nG20\nG53 P3 X\nG22\nG53 P3 Y-2\nG0 P3\nG53 P4\nG53 P5\nG53 P3 Z\n")
    assert job_lines(raised(job, machine, str(tmp_path / "places.toml"))) == [
        "machine rapid x=50.8mm y=25mm", "machine rapid x=2inch", "machine rapid y=23mm",
        "machine rapid x=50.8mm y=25mm", "NotRaised P4 as a stored position", "NotRaised P5 as a stored position",
        "NotRaised P3 as a stored position",
    ]  # fmt: skip


def corpus_jobs() -> list[tuple[Path, Path, str | None]]:
    found = []
    for shop in sorted(CORPUS.iterdir()):
        table = tomllib.loads((shop / "expect.toml").read_text("utf-8"))
        for name, row in table.items():
            if not isinstance(row, dict) or row["verdict"] != "SAFE":
                continue
            job = next(path for path in (shop / "jobs").iterdir() if name in (path.stem, path.name))
            setup = row.get("setup", table.get("setup"))
            where = str(shop / setup) if setup not in (None, "zero") else setup
            found.append((job, shop / row.get("machine", table.get("machine")), where))
    return found


@pytest.mark.parametrize("job,machine,setup", [pytest.param(*row, id=row[0].stem) for row in corpus_jobs()])
def test_every_safe_job_of_the_corpus_is_raised_and_its_text_says_all(
    job: Path, machine: Path, setup: str | None
) -> None:
    neutral = raised(job, machine, setup)
    neutral.verify()
    text = print_ir(neutral)
    assert print_ir(parse_ir(text)) == text
