"""Every message of WinCNC that a checker can decide: a program, or a machine file, that gives its finding and no other.

Source: the manual's "Messages and Error Codes". The shop is that of ``docs/codes/wincnc``.
"""

from __future__ import annotations

import contextlib
import io
import json
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from corpus.expectations import shown

from gproof.cli.main import main
from gproof.ir.dialects.wincnc.messages import MESSAGES

SHOP = Path(__file__).resolve().parents[3] / "docs" / "codes" / "wincnc"


@dataclass(frozen=True)
class Case:
    """A job behind ``PLACED`` and what is changed of the shop. code: of the finding, at the job's last line.

    ini: (text, its replacement) pairs; files: by name, None takes one away; at_file: the finding is not the job's;
    controls: lines of gproof's own file; after: what an error leaves unknown.
    """

    code: str
    text: str
    ini: tuple[tuple[str, str], ...] = ()
    files: dict[str, str | None] = field(default_factory=dict)
    at_file: bool = False
    controls: str = ""
    after: frozenset[str] = frozenset({"GP304", "GP405", "GP225"})


NOT_RUN = 3
"""Exit code of a check that could not begin."""
PLACED = "G90\nG92\nG0 X100 Y60 Z-10\n"


CASES = {
    "Line Too Long": Case("GP106", "G1 X110 [" + 260 * "="),
    "Unsupported G Code": Case("GP112", "G17"),
    "Unsupported L Code": Case("GP112", "L999"),
    "Unsupported M Code": Case("GP112", "M6"),
    "Multiple Commands": Case("GP127", "G0 X110 M11C1"),
    "Syntax - Command or File Not Found": Case("GP101", "?"),
    "Arc Radius": Case("GP401", "G2 X120 Y60 I11 J0 F600"),
    "Soft Limit Exceeded": Case("GP301", "G0 Z5"),
    "Boundary Exceeded": Case("GP330", "G0 Y2"),
    "Acceleration Out of Bounds": Case("GP606", "", (("r80 a30000 t1", "r800 a30000 t1"),), at_file=True),
    "Illegal Value": Case("GP129", "G2 X120 R-12 F600"),
    "Unknown Position Specified": Case("GP286", "P21"),
    "Subprogram Nesting Too Deep": Case("GP117", "M98 A.TAP", files={"A.TAP": "M98 A.TAP\n"}, at_file=True),
    "L10 in Subprogram": Case("GP131", "M98 A.TAP", files={"A.TAP": "L10 R1 C2 X9 Y0\n"}, at_file=True),
    "File Not Found": Case("GP130", "M98 NONE.TAP"),
    "Parameter Not Specified": Case("GP275", "M11"),
    "Invalid L10 Command": Case("GP132", "L10 R1 C2.5 X9 Y0"),
    "Invalid P1 Command": Case("GP287", "P1.5"),
    "Tool Changer Not Enabled": Case("GP285", "L101 T2"),
    "Parameter Out of Range": Case("GP128", "L60 C65"),
    "D/A Not Enabled": Case("GP285", "L51 V5"),
    "Arc Too Small": Case("GP402", "G2 X100 Y60 I0 J0 F600"),
    "Device Not Enabled": Case("GP285", "L36"),
    "Pump Control Not Enabled": Case("GP285", "L55"),
    "Soft Limits Not Enabled": Case("GP285", "L20", (("softlim=T1", "softlim=T0"),)),
    "Tangential Knife Not Enabled": Case("GP285", "L30"),
    "Forced Limit Exceeded": Case("GP331", "G0 X20", (("softlim=T1", "forcelim=X30 Y30\nsoftlim=T1"),)),
    "Digitizer Probe Not Enabled": Case("GP285", "L801"),
    "Arcs Disabled When X or Y Scaled": Case("GP415", "G51 X2 Y2 I100 J60\nG2 X110 I5 J0 F600"),
    "Rotating Saw Not Enabled": Case("GP285", "L32"),
    "Macro Expansion Error": Case("GP133", "M40 X" + 240 * "1", files={"CNC.MAC": "M40=M98 A_LONG_NAME.TAP\n"}),
    "Errors Reading WINCNC.INI": Case("GP603", "", (("nmode=90", "nmode=92"),), at_file=True),
    "CNC.MAC Not Found": Case("GP607", "", files={"CNC.MAC": None}, at_file=True),
    "Helical Interpolation Not Supported": Case("GP416", "G2 X120 I10 J0 Z-12 F600", controls="helical_arcs = false"),
    "Vector Laser Not Enabled": Case("GP285", "L251 P50"),
    "Auto-AuxOut Not Enabled": Case("GP285", "L34"),
    "Depth Must Be Lower Than Retract": Case("GP217", "G81 X120 Y60 Z-10 R-15 F300"),
}


def check(case: Case, folder: Path, controls: str = "") -> list[tuple[str, int, str]]:
    """Codes, lines and files of the errors and unknowns of a case."""
    ini = (SHOP / "WINCNC.INI").read_text("utf-8")
    for old, new in case.ini:
        assert old in ini
        ini = ini.replace(old, new, 1)
    (folder / "WINCNC.INI").write_text(ini, "utf-8")
    kept = {"CNC.MAC": (SHOP / "CNC.MAC").read_text("utf-8"), **case.files}
    for name, text in kept.items():
        if text is not None:
            (folder / name).write_text(text, "utf-8")
    machine = folder / "WINCNC.INI"
    controls = case.controls or controls
    if controls:
        machine = folder / "machine.toml"
        said = f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n\n[controls]\n{controls}\n'
        machine.write_text(said, "utf-8")
    job = folder / "job.tap"
    job.write_text(PLACED + case.text + "\n", "utf-8")
    words = ["check", str(job), "--machine", str(machine), "--setup", str(SHOP / "setup.toml")]
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        judged = main([*words, "--dialect", "wincnc", "--format", "json"]) < NOT_RUN
    if not judged:
        return [(one.code, one.line or 0, one.file) for one in shown(err.getvalue())]
    found = json.loads(out.getvalue())["findings"]
    # The one of an acceleration is a warning: the manual does not say what its number counts.
    weighty = [f for f in found if f["severity"] in ("error", "unknown") or f["code"] == case.code == "GP606"]
    return [(f["code"], f["line"], Path(f["file"]).name) for f in weighty]


@pytest.mark.parametrize("message", CASES)
def test_a_message_has_a_program_that_gives_it_and_nothing_else(message: str, tmp_path: Path) -> None:
    case = CASES[message]
    found = check(case, tmp_path)
    assert {code for code, _, _ in found} - case.after == {case.code}, found
    line, file = next((line, file) for code, line, file in found if code == case.code)
    if not case.at_file:
        assert (line, file) == (len((PLACED + case.text).splitlines()), "job.tap")


def test_every_message_that_can_be_decided_has_a_program() -> None:
    decided = {m.text: {code.label for code in m.codes} for m in MESSAGES if m.codes}
    assert set(CASES) == set(decided)
    assert all(case.code in decided[text] for text, case in CASES.items())


@pytest.mark.parametrize(("nesting", "codes"), [(2, []), (1, ["GP117"])])
def test_how_deep_calls_may_go_is_a_setting(nesting: int, codes: list[str], tmp_path: Path) -> None:
    case = Case("GP117", "M98 A.TAP", files={"A.TAP": "M98 B.TAP\n", "B.TAP": "G0 X110\n"})
    found = check(case, tmp_path, controls=f"nesting = {nesting}")
    assert [code for code, _, _ in found if code not in case.after] == codes
