"""The reader of LinuxCNC and grbl programs: what it reads is what the interpreter of Eding CNC makes of the same text,
where both languages mean the same; a word that it does not know ends the Trace.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from support.bundles import ROOT
from support.campaigns import seeds

from gproof.driver.running import execute
from gproof.driver.session import open_session
from gproof.driver.translation_traces import any_zero
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.trace import Op, Trace, Wait
from gproof.ir.translation_terms import TranslationTerms
from gproof.ir.verdict import Verdict
from gproof.verify.translation import rs274_reader
from gproof.verify.translation.compare import compare
from gproof.verify.translation.rs274 import plain_lines
from gproof.verify.translation.rs274_reader import GRBL, LINUXCNC, Language, ReadBack, read_back

MACHINE = ROOT / "tests" / "differential" / "machine.toml"
START = "G21 G17 G90 G94 G40 G80 G54 G61 G49"
MODES = "G91.1\n"
"""A first line that Eding CNC does not have: arc centres count from the start."""


def eding(text: str, folder: Path) -> tuple[Trace, Machine]:
    """What the interpreter of Eding CNC makes of a text, for any work zero."""
    job = folder / "job.cnc"
    job.write_text(f"\n{text}")
    session = open_session(job, machine=MACHINE, setup=None, dialect="eding")
    assert session.program is not None
    setup = any_zero(session.setup, session.program)
    return execute(session.program, setup, session.machine, Findings()), session.machine


def read(text: str, machine: Machine, language: Language = LINUXCNC) -> ReadBack:
    """The same, by the reader."""
    return read_back({"": f"{MODES}{text}".encode()}, "job.ngc", language, machine)


def same(text: str, folder: Path, language: Language = LINUXCNC) -> None:
    """Both make the same of a text."""
    left_out = frozenset() if language is LINUXCNC else frozenset({"path_mode"})
    source, machine = eding(text, folder)
    back = read(text, machine, language)
    assert not back.unread, f"{back.unread}\n{text}"
    back.trace.verify()
    terms = TranslationTerms(
        tolerance_mm=1e-9, tolerance_deg=1e-9, source_straight=True, target_straight=True, left_out=left_out
    )
    found = compare(source, back.trace, terms)
    assert found.verdict is Verdict.SAFE, f"{found.differences or found.unknown}\n{text}"


WRITTEN = {
    "places": "G0 X1 Y2 Z3\nX4 A10\nG91 X1\nG90 G1 X0 F100\nA20\n",
    "arcs": "G0 X10 Y0 Z0\nF200\nG2 X0 Y10 I-10 J0\nG3 X10 Y0 R10 Z-1\nG3 X0 Y10 R-10\nG2 X0 Y10 I5\n",
    "planes": "G0 X0 Y0 Z0\nG18 G2 X10 Z10 I10 F100\nG19 G3 Y5 Z15 R5\nG17 G3 X10 Y5 I3 J1\n",
    "inches": "G20\nG0 X1 Y1\nG1 X2 F10\nA5 F20\nG21\nG1 X5 F100\n",
    "inverse time": "G0 X0 Y0 Z0\nG93\nG1 X10 F2\nG2 X20 Y0 I5 J0 F3\nG94 G1 X5 F50\n",
    "revolutions": "S500 M3\nG0 X0\nG95\nG1 X10 F0.1\nM5\n",
    "offsets": "G0 X0 Y0 Z0\nG10 L2 P2 X5 Y6\nG55 G0 X1 Y1\nG10 L20 P1 X3\nG54 G0 X0\nG92 X7\nG0 X1\nG92.1\nG0 X1\n",
    "suspended": "G0 X1 Y1\nG92 X0 Y0\nG0 X2\nG92.2\nG0 X2\nG92.3\nG0 X2\nG92.1\n",
    "machine places": "G53 G0 Z0\nG0 X1\nG53 G1 X5 F10\nG1 X6\n",
    "lengths": "T1 M6\nG43 H1\nG0 Z5\nT2 M6\nG43 H2\nG0 Z5\nG49\nG0 Z5\n",
    "devices": "M8\nS1000 M3\nG4 P0.5\nS2000\nM4\nM5\nM9\n",
    "stops": "G0 X1\nM0\nG0 X2\nM1\nG0 X3\n",
    "probe": "G0 X0 Y0 Z5\nG38.2 Z-10 F50\nG92 Z0\nG0 Z5\n",
    "drilling": "G0 X0 Y0 Z10\nG98 G81 X1 Y1 Z-5 R2 F100\nX2\nX3 Y3\nG80\nG99 G82 X5 Z-6 R1 P0.3\nY7\nG80\nG0 Z10\n",
    "path modes": "G0 X1\nG61.1\nG0 X2\nG64\nG0 X3\n",
    "overrides": "M49\nG0 X1\nM48\nG0 X2\n",
    "inch drilling": "G20 G0 X0 Y0 Z1\nG99 G81 X1 Z-0.5 R0.1 F5\nX2\nG80\nG21\n",
}


@pytest.mark.parametrize("name", WRITTEN)
def test_both_readers_agree(name: str, tmp_path: Path) -> None:
    same(f"{START}\n{WRITTEN[name]}M30\n", tmp_path)


def test_an_end_without_m30_leaves_everything_on(tmp_path: Path) -> None:
    same(f"{START}\nM3 S100\nG0 X1\n", tmp_path, GRBL)


@pytest.mark.parametrize("text, is_read", [("G0 X1\n", False), ("G0 X1\nM2\n", True), ("%\nG0 X1\n%\n", True)])
def test_a_file_of_linuxcnc_has_an_end(text: str, is_read: bool) -> None:
    """M2, M30 or %: rs274 says "File ended with no percent sign or program end"."""
    whole = text.replace("G0", f"{START}\nG0")
    assert bool(read_back({"": whole.encode()}, "job.ngc", LINUXCNC, NO_MACHINE).unread) != is_read


@pytest.mark.parametrize("seed", seeds(12, 600))
def test_random_programs_agree(seed: int, tmp_path: Path) -> None:
    same(random_program(seed), tmp_path)


@pytest.mark.parametrize("seed", seeds(6, 300))
def test_random_programs_of_grbl_agree(seed: int, tmp_path: Path) -> None:
    same(random_program(seed, "xyz"), tmp_path, GRBL)


def random_program(seed: int, axes: str = "xyzabc") -> str:
    """A program whose words mean the same to all controllers of this family."""
    made = random.Random(f"{seed} {axes}")

    def number(size: float = 50.0) -> str:
        return f"{made.uniform(-size, size):.{made.randint(0, 4)}f}"

    def places(least: int = 1) -> str:
        chosen = made.sample(axes, made.randint(least, len(axes)))
        return " ".join(f"{axis.upper()}{number()}" for axis in sorted(chosen, key=axes.index))

    def circle() -> str:
        radius = float(number(20)) or 5.0
        x, y = float(number()), float(number())
        code = made.choice(("G2", "G3"))
        half = f"{code} X{x + 2 * radius:.4f} Y{y} I{radius} J0"
        by_radius = f"{code} X{x + 1:.4f} Y{y + 1:.4f} R{made.choice((-1, 1)) * (abs(radius) + 1)}"
        return f"G90 G0 X{x} Y{y}\n{made.choice((half, by_radius, f'{half} Z{number()}'))}"

    lines = [
        START,
        f"G0 {' '.join(f'{axis.upper()}{number()}' for axis in axes)}",
        "S1000",
        f"F{made.randint(10, 900)}",
    ]
    structured = "a" in axes
    choices = [
        lambda: f"G0 {places()}", lambda: f"G1 {places()}", lambda: f"G1 {places()} F{made.randint(10, 900)}",
        places, circle, lambda: made.choice(("G90", "G91")), lambda: f"G4 P{made.randint(0, 30) / 10}",
        lambda: f"G10 L2 P{made.randint(1, 6)} {places()}",
        lambda: f"G{made.randint(54, 59)}", lambda: f"G92 {places()}", lambda: "G92.1",
        lambda: f"G90 G53 G0 {places()}",
        lambda: made.choice(("M3", "M4", "M5", f"S{made.randint(1, 9)}00")), lambda: made.choice(("M8", "M9")),
        lambda: "M0",
    ]  # fmt: skip
    if structured:
        choices += [
            lambda: made.choice(("G49", "G43 H1", "G43 H2")), lambda: f"T{made.randint(1, 4)} M6", lambda: "M7",
            lambda: f"G90 G0 Z50\nG98 G81 X{number()} Z-{made.randint(1, 9)} R2\nY{number()}\nG80\nG0 X0",
        ]  # fmt: skip
    motion = "G0"
    for _ in range(made.randint(5, 40)):
        line = made.choice(choices)()
        # The motion in force is said again after lines that may have ended it.
        lines.append(f"{motion} {line}" if line[0] in "XYZABC" else line)
    return "\n".join([*lines, "M30"]) + "\n"


UNREAD = {
    "G5 X1", "G33 Z1 K1", "G76", "G41 D1", "G52 X1", "G68 R10", "G73 Z-1 R1 Q1", "G83 Z-1 R1 Q1", "G84 Z-1 R1",
    "G96 S10", "G93 F6\nG1 X10", "G93 G1 X5 F6\nX10", "M62 P64", "M66 P64 L3 Q1",
    "M19", "M61 Q1", "M67 E1 Q1", "M98 P1", "M100", "N10 G0 X1", "/G0 X1", "G0 X", "G0 X1 X2", "G0 U1", "G0 X1 G1 Y1",
    "G0 X#40", "#1 = 5", "#5420 = 1", "G0 X[1 +", "o1 repeat [3]", "o1 if [1 LT 2]", "o<a> call", "o<a> call [1]",
    "(LOGOPEN,file)", "(PROBEOPEN file)", ";py,print", "G0 X1 (open", "#<a> = 1", "G10 L1 P1 Z5", "G10 L2 P0 X1",
    "G92.3", "G10 L2 P1 X1 R30", "M66 P0 L0", "M66 P0 L3", "M62 P1\nM2", "G43", "G53 X", "G2 X5", "G2 X5 I1 R2",
    "G38.2",
    "X1 Q1", "G0 X1\n%\nG0 X2", "M2\nG0 X1", "G0 X1e2", "G0 X--1", "T1.5 M6", "M6", "G61.2", "G95 G1 X1", "%",
}  # fmt: skip


@pytest.mark.parametrize("line", sorted(UNREAD))
def test_what_it_does_not_know_ends_the_trace(line: str, tmp_path: Path) -> None:
    _, machine = eding("G0 X1\n", tmp_path)
    back = read(f"{START}\nG0 X0 Y0 Z0 A0 B0 C0\n{line}\n", machine)
    assert back.unread
    assert back.trace.sections[-1].edges[0].wait is Wait.UNKNOWN


NOT_GRBL = [
    "T1 M6", "G81 Z-1 R1", "#100 = 5", "G0 X[1]", "G0 A1", "M7", "M1", "G59.1", "G92.2", "G64", "o1 if [1]", "G43 H1",
    "G2 I5", "(stop?)", f"({'long ' * 20})", "M48", "G4 P1 ; ~",
]  # fmt: skip


@pytest.mark.parametrize("line", NOT_GRBL)
def test_grbl_does_not_have_it(line: str, tmp_path: Path) -> None:
    _, machine = eding("G0 X1\n", tmp_path)
    assert read(f"{START}\nG0 X0 Y0 Z0 F10\n{line}\n", machine, GRBL).unread


@pytest.mark.parametrize(
    "text", ["G0 X1", "G21 G0 X1", "G90 G0 X1", "G21 G90 G1 X1 F5", "G21 G90 G94 G40 X1", "G21 G90 G94 G40 G2 X1 I5 F5"]
)
def test_modes_are_unknown_until_the_program_says_them(text: str, tmp_path: Path) -> None:
    _, machine = eding("G0 X1\n", tmp_path)
    assert read_back({"": f"{text}\n".encode()}, "job.ngc", LINUXCNC, machine).unread


def moves(text: str, folder: Path) -> list[tuple[float, ...]]:
    """Where the moves of a program end in X and Y."""
    _, machine = eding("G0 X1\n", folder)
    back = read(f"{START}\n{text}M2\n", machine)
    assert not back.unread
    return [
        tuple(to[:2]) for section in back.trace.sections
        for op, to in zip(section.rows["op"], section.rows["to"].tolist(), strict=True) if op < Op.DWELL
    ]  # fmt: skip


def test_structure_and_expressions(tmp_path: Path) -> None:
    """By hand: 2 ** 3 = 8; -7 MOD 3 = 2; FIX[-2.5] = -3; ATAN[1]/[1] = 45; 1.00005 EQ 1."""
    text = """\
o<row> sub
  #101 = 0
  o1 while [#101 LT 3]
    G0 X[#101 * 2] Y#102
    o2 if [#101 EQ 1]
      o<row> return
    o2 else
      #101 = [#101 + 1]
    o2 endif
  o1 endwhile
o<row> endsub
#102 = 5
o<row> call
o3 do
  #102 = [#102 - 1]
  G0 X[2 ** 3 + #102 / 2] Y[[0 - 7] MOD 3]
o3 while [#102 GT 3]
G0 X[FIX[-2.5]] Y[ATAN[1]/[1]]
o4 if [1.00005 EQ 1]
G0 X[1 + 2 * 3] Y[2 + 3 GT 4 AND 1]
o4 endif
"""
    wanted = [(0, 5), (2, 5), (10, 2), (9.5, 2), (-3, 45), (7, 1)]
    found = moves(text, tmp_path)
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted, strict=True):
        assert one == pytest.approx(other)


def test_a_wait_without_a_limit_is_a_loop(tmp_path: Path) -> None:
    _, machine = eding("G0 X1\n", tmp_path)
    loop = "o1 do\n  M66 P3 L4 Q3600\no1 while [#5399 EQ -1]\n"
    back = read(f"{START}\n{loop}M2\n", machine)
    assert not back.unread
    first = back.trace.sections[0]
    assert first.edges[0].wait is Wait.INPUT and first.edges[0].outcome == "come"
    assert first.rows["arg"][-1].tolist() == [3.0, 0.0]
    # With anything else in the loop, what it does depends on how often it runs.
    assert read(f"{START}\n{loop.replace('Q3600', 'Q3600 G4 P1')}M2\n", machine).unread


def test_a_number_is_read_to_the_last_digit(tmp_path: Path) -> None:
    numbers = ["0.1", "-12.3456", ".5", "7.", "123456.789012", "0.000001", "99999999.9999999"]
    text = "".join(f"G0 X{a} Y{b}\n" for a, b in zip(numbers, reversed(numbers), strict=True))
    pairs = zip(map(float, numbers), map(float, reversed(numbers)), strict=True)
    assert moves(text, tmp_path) == list(pairs)


@pytest.mark.parametrize("piece", [7, 1 << 15])
def test_tables_of_lines_are_read_as_single_lines_are(
    piece: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A long run of plain lines is done at once, whatever its first lines leave open; with comments, one by one."""
    monkeypatch.setattr(rs274_reader, "PIECE_ROWS", piece)
    monkeypatch.setattr(plain_lines, "PIECE", 16 * piece)
    made = random.Random(5)
    lines = ["F500", "X1 Y1 Z1", "G1 X2 F300", "F200", *(f"X{made.uniform(-9, 9):.4f} Y{n}" for n in range(50))]
    lines += [f"G{made.choice((2, 3))} X{made.uniform(0, 9):.4f} Y{n} R60 F{n + 1}" for n in range(50)]
    start = f"{START}\nG0 X0\n"
    at_once = "\n".join(lines) + "\nM30\n"
    _, machine = eding("G0 X1\n", tmp_path)
    one = read(start + at_once, machine).trace
    other = read(start + at_once.replace("\n", " (-)\n"), machine).trace
    assert len(one.sections[0].rows) > 90
    for name in one.sections[0].rows.schema.by_name:
        assert one.sections[0].rows[name] == pytest.approx(other.sections[0].rows[name], nan_ok=True), name


@pytest.mark.parametrize(("language", "unread"), [(LINUXCNC, True), (GRBL, False)], ids=["linuxcnc", "grbl"])
def test_a_mode_of_feed_takes_the_feed_away(language: Language, unread: bool) -> None:
    """LinuxCNC sets it to 0 at each G94 and stops at the next move; grbl only where the mode changes."""
    text = "G21 G17 G90 G40\nG94 F300\nG1 X1\nG94\nG1 X2\nM2\n"
    found = read_back({"": text.encode()}, "job.ngc", language, NO_MACHINE)
    assert [why for _, why in found.unread] == ["a move without a feed"] * unread
    assert not read_back({"": text.replace("G94\n", "G94 F300\n").encode()}, "job.ngc", language, NO_MACHINE).unread
