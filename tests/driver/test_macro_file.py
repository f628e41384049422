"""The macro file that the controller's file names is loaded with the job; one that is missing leaves it UNKNOWN."""

from __future__ import annotations

from pathlib import Path

from gproof.driver.session import open_session

INI = '[JOINT_0]\nvisible = 1\n[INTERPRETER]\nmacroFileName = "C:\\CNC4.01\\mine.cnc"\n'
JOB = "gosub park\nM30\n"
SUB = "sub park\n  G53 G0 X0\nendsub\n"


def test_the_macro_file_beside_the_machine_file(tmp_path: Path) -> None:
    (tmp_path / "machine").mkdir()
    (tmp_path / "machine" / "cnc.ini").write_text(INI)
    (tmp_path / "machine" / "mine.cnc").write_text(SUB)
    (tmp_path / "job.cnc").write_text(JOB)
    (tmp_path / "macro.cnc").write_text("sub other\nendsub\n")
    session = open_session(tmp_path / "job.cnc", machine=tmp_path / "machine" / "cnc.ini", setup=None, dialect=None)
    assert session.program is not None
    assert list(session.program.subprograms) == ["park"]
    assert session.machine.not_modelled == ()
    assert [Path(name).name for name, _, role in session.inputs if role == "source"] == ["job.cnc", "mine.cnc"]


def test_a_macro_file_that_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "cnc.ini").write_text(INI)
    (tmp_path / "job.cnc").write_text("G0 X1\nM30\n")
    session = open_session(tmp_path / "job.cnc", machine=tmp_path / "cnc.ini", setup=None, dialect=None)
    assert [s.text for s in session.machine.not_modelled] == ["macroFileName = mine.cnc (there is no such file)"]
    (tmp_path / "mine.cnc").write_text(JOB + SUB)
    alone = open_session(tmp_path / "mine.cnc", machine=tmp_path / "cnc.ini", setup=None, dialect=None)
    assert alone.program is not None and list(alone.program.subprograms) == ["park"]
    (tmp_path / "cnc.ini").write_text(INI.replace("mine.cnc", "macro.cnc"))
    usual = open_session(tmp_path / "job.cnc", machine=tmp_path / "cnc.ini", setup=None, dialect=None)
    assert usual.machine.not_modelled == ()
