"""Numbers of outputs and inputs: what a map proposes for them, and which a controller has."""

from __future__ import annotations

from pathlib import Path

from support.each import each
from support.jobs_by_hand import PLACE, cut, job, number
from support.traps import machine_files

from gproof.driver.targets import TARGETS
from gproof.driver.translation import Translation, Wanted, translate
from gproof.driver.translation_map import proposed, toml_of
from gproof.ir.job import Job, SwitchOutput, WaitFor
from gproof.ir.translation_map import TranslationMap
from gproof.ir.verdict import Verdict


def switches(source: str, *channels: int) -> Job:
    """A job that switches these outputs, and waits for an input of the last number."""
    nodes = [SwitchOutput(channel=number(one), value=number(1), moving=False, span=PLACE) for one in channels]
    return job(*nodes, WaitFor(channel=number(channels[-1]), on=True, span=PLACE), cut(x=1), source=source)


@each(
    "source,target,channels,wanted,inputs",
    [
        ("wincnc", "eding", (4, 5), {4: 4, 5: 5}, {5: 5}),
        ("eding", "linuxcnc", (4, 5), {4: 4, 5: 5}, {5: 5}),
        # McuWIN counts them by axis: 104 is the fourth of the first axis (4.11, 7).
        ("wincnc", "mcuwin", (4, 5), {4: 104, 5: 105}, {5: 105}),
        ("mcuwin", "linuxcnc", (104, 203), {104: 4, 203: 3}, {203: 3}),
        ("mcuwin", "linuxcnc", (104, 204), {104: 1, 204: 2}, {204: 4}),
        ("mcuwin", "wincnc", (104, 204), {104: 104, 204: 204}, {204: 4}),
        ("mcuwin", "mcuwin", (104, 203), {104: 104, 203: 203}, {203: 203}),
    ],
)
def test_what_is_proposed(
    source: str, target: str, channels: tuple[int, ...], wanted: dict[int, int], inputs: dict[int, int]
) -> None:
    found = proposed(switches(source, *channels), TARGETS[target].target())
    assert found.outputs == wanted and found.inputs == inputs
    same = all(old == new for old, new in (*wanted.items(), *inputs.items()))
    assert ("as itself" in toml_of(found, source, target)) == same


def linuxcnc(folder: Path, line: str, given: TranslationMap) -> Translation:
    """A program of Eding CNC for LinuxCNC."""
    machine = folder / "machine.toml"
    machine.write_bytes(machine_files("eding")["machine.toml"])
    program = folder / "job.cnc"
    program.write_text(f"G17 G21 G90 G94 G40 G49 G54\nG0 X0 Y0 Z5\n{line}\nG1 X1 F100\nM30\n")
    to = folder / "to.toml"
    to.write_text(machine.read_text().partition("[controller]")[0])
    return translate(Wanted(job=program, to="linuxcnc", machine=machine, machine_to=to, dialect="eding", given=given))


def test_linuxcnc_has_64_outputs_and_inputs(tmp_path: Path) -> None:
    """P of M62 to M66 is at most 63."""
    for most, verdict in ((63, Verdict.SAFE), (64, Verdict.UNKNOWN)):
        for line, given in (
            ("M54 P1", TranslationMap(outputs={1: most}, given=True)),
            ("M56 P1 L1 Q5", TranslationMap(inputs={1: most}, given=True)),
        ):
            done = linuxcnc(tmp_path, line, given)
            said = [one.message for one in done.findings.kept]
            assert done.verdict is verdict, said
            assert verdict is Verdict.SAFE or "numbers from 0 to 63" in said[0]
