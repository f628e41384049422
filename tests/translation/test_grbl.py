"""Jobs for grbl 1.1: proven or refused by name; only words of grbl, in lines that fit; LinuxCNC's interpreter, which
knows these words, makes the same moves of them."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import pytest
from support.campaigns import share
from support.translations import CorpusJob, safe_jobs, translated

from gproof.driver.session import open_session
from gproof.ir.verdict import Verdict

from .test_linuxcnc import REFUSED, peer_moves, same_moves, source_moves, without_rests

JOBS = safe_jobs()

GRBL_REFUSED = REFUSED | {
    "choice", "output", "mist coolant", "optional stop", "axis A", "axis C", "work offset whose number",
    "feed per revolution", "input",
    "exact stop", "local offset restored", "local offset suspended", "the length of a tool", "variable", "wait",
}  # fmt: skip
"""Besides those: what LinuxCNC has and grbl has not ("Supported G-Codes")."""

G = (
    "0 1 2 3 4 10 17 18 19 20 21 28 28.1 30 30.1 38.2 38.3 38.4 38.5 40 43.1 49 53 54 55 56 57 58 59 61 80 90 91 91.1 "
    "92 92.1 93 94"
)
M = "0 2 3 4 5 8 9 30"
WORDS = {*(f"G{code}" for code in G.split()), *(f"M{code}" for code in M.split())}
"""By hand from grbl's list, page "Supported G-Codes" (v1.1): M7 is only in builds that switch it on."""
LETTERS = "XYZIJKRPLFST"
"""Letters of other words: "Supported G-Codes", value words; no N, which a translation does not print."""
LONGEST = 70
"""Characters of a line with its comments: grbl's buffer has room for 80 with its end."""
REAL_TIME = set("?!~")


@pytest.mark.parametrize("job", share(JOBS, 10), ids=str)
def test_a_job_is_proven_or_refused_by_name(job: CorpusJob) -> None:
    done = translated(job, "grbl")
    said = [f"{finding.code.label} {finding.message}" for finding in done.findings.kept]
    if done.verdict is Verdict.SAFE:
        only_words_of_grbl(done.files[""])
        return
    assert done.verdict is Verdict.UNKNOWN, said
    assert any(one.startswith("GP703") and any(name in one for name in GRBL_REFUSED) for one in said), said


def only_words_of_grbl(text: bytes) -> None:
    """Every word is on grbl's list, every line fits, no character is a command."""
    assert text.isascii()
    for line in text.decode().splitlines():
        assert len(line) <= LONGEST
        assert not REAL_TIME & set(line)
        plain = re.sub(r"\([^()]*\)", " ", line)
        assert "(" not in plain and ")" not in plain and ";" not in plain
        for word in plain.split():
            found = re.fullmatch(r"([A-Z])(-?\d+(?:\.\d+)?)", word)
            assert found, word
            assert word in WORDS if found[1] in "GM" else found[1] in LETTERS, word


SMALL = """\
(a comment that is longer than the line may be, so that it goes on several lines: is it? yes!)
G21 G17 G90 G94
G0 X0 Y0 Z5 (at the end of a line that has room)
S1000 M3
M8
#1 = 0
while [#1 < 3]
  G0 X[#1 * 10] Y0
  G1 Z-1 F100
  G3 X[#1 * 10] Y0 I2 J0
  G0 Z5
  #1 = [#1 + 1]
endwhile
sub hole
  G99 G83 X5 Y5 Z-3 R1 Q1
  G80
endsub
gosub hole
G93 G1 X1 F2
G94
G4 P0.5
G10 L2 P2 X1 Y2
G55
G0 X1
G92 X0
G0 X2
G92.1
M30
"""


def test_what_grbl_does_not_have_becomes_moves(tmp_path: Path) -> None:
    job = tmp_path / "job.cnc"
    job.write_text(SMALL)
    machine = Path(__file__).parents[1] / "differential" / "machine.toml"
    done = translated(CorpusJob("small", "eding", job, machine, "zero"), "grbl")
    assert done.verdict is Verdict.SAFE, done.findings.kept
    text = done.files[""].decode()
    only_words_of_grbl(done.files[""])
    assert text.count("G3 X") == 3
    assert "(a comment that is longer" in text


@pytest.mark.parametrize("job", share([job for job in JOBS if job.dialect == "eding"], 12), ids=str)
def test_linuxcnc_makes_the_same_moves(job: CorpusJob, peer: None) -> None:
    done = translated(job, "grbl", exact=True)
    if done.verdict is not Verdict.SAFE:
        # Which constructs those are, another test says; what is written and not proven has no place here.
        assert {one.code.label for one in done.findings.kept} <= {"GP703"}
        return
    session = open_session(job.job, machine=job.machine, setup=job.setup, dialect=job.dialect)
    # LinuxCNC has no G43.1 with a place alone, and an optional M7: these are not in the texts that are compared.
    if b"G43.1" in done.files[""]:
        return  # rs274 has no G43.1 of grbl
    with tempfile.TemporaryDirectory() as folder:
        theirs = without_rests(peer_moves(done.files[""], session, Path(folder)))
    same_moves(source_moves(session), theirs)
