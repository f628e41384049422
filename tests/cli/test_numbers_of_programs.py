"""Numbers that no machine has, wherever a number may stand in a program: a finding with a place, no crash."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.campaigns import sizes
from support.command import in_this_process

NUMBERS = {
    "300 digits": "9" * 300,
    "minus 300 digits": "-" + "9" * 300,
    "5000 digits": "9" * 5000,
    "an exponent": "1e400",
    "a small exponent": "1E-400",
    "minus zero": "-0",
    "a small one": "0." + "0" * 300 + "1",
    "300 decimals": "3." + "3" * 300,
    "hexadecimal": "0x1F",
    "a point": ".",
    "a plus": "+5",
    "an underscore": "1_0",
    "wide digits": "\uff11\uff12",
}
EDING = """
g1 x# f100|n# g0 x1|t# m6|g4 p#|g#|m#|s# m3|f# g1 x1|g2 x1 y1 i# j0|g2 x1 y1 r#|@#=1|@1=#|@1=[#+1]|@1=[1/#]|@1=[#*#]
|@1=[#**#]|@1=[sin[#]]|@1=[sqrt[#]]|@1=[round[#]];g1 x[@1]|if [# > 1];g0 x1;endif|while [@1 < #];@1=[@1+1];g0x1;endwhile
|g83 x1 y1 z-1 r1 q#|g83 x1 y1 z-1 r1 q1 l#|g10 l2 p# x1|g10 l2 p1 x#|g43 h#|g41 d#|g92 x#|g54.#|g68 x0 y0 r#
|g76 p# z-1 i-1 j1 r1 k2 q1|gosub #|repeat #;g0x1;endrepeat|m60 p#|dlgmsg "a" "b" #|@[#]=1|@1=@#|g64 p#|g28.#|msg #
|g0 x[# mod 3]|g0 x[bitand[#,1]]|g0 x[asin[#]]|g0 x[#]|a#|log #|g96 d# s#|g33 z-1 k#|m54 p#|m56 p# l# q#|/# g0x1
"""
WINCNC = """
g1 x# f100|n# g0 x1|t# m6|g4 x#|g#|m#|s# m3|f# g1 x1|g2 x1 y1 i# j0|g2 x1 y1 r#|l1n1v#|l1n#v1|x[#+1]|x[#]
|g83 x1 y1 z-1 r1 q#|g92 x#|g68 x0y0 r#|l10r#c1x1y1;g0x1|l10r1c#x1y1;g0x1|l10r2c1x#y1;g0x1|g43 h#|g41 d#|l22x#|l6x#
|l7p#|l40p#|l30.1z#|m98 #|m11c#|m12c#|g10 l#|l#|g54.#|g53 x#|l3 x#|g17.#|g81x1y1z#r1|g4.#|p#|w#|g28 x#|m1.#|l13x#
"""
MCUWIN = """
G01 X# F10|N# G00 X1|T# M6|G04 #|G04 X#|G#|M#|S# M3|F#|G02 X1 Y1 I# J0|M98 L#|M98 L5 O#|CD600 := #|CD# := 1|CI600 := #
|CI# := 1|CD600 := # * #|CD600 := sin(#)|CD600 := 1 / #|CI600 := 1 shl #|CI600 := # mod 3|CI600 := round(#)
|$if (CD600 > #) then begin;G00 X1;$end|M96 L#|G54 X#|G92 X#|D#|G41 D#|X(#)|$for CI600 := 1 to # do begin;G00 X1;$end
|$wt(#)|L#|%#|M26 #|WRITE(#)|G51 X#|G39 X#|G200 #|A#|$while (CI600 < #) do begin;CI600 := CI600 + 1;$end
"""
NAMES = ("msg", "log", "dlgmsg", "/#", "N#", "L#", "%#")
"""Texts, lines that are left out, and names that nothing calls: they may be of as many digits as somebody likes."""
PLACES = {
    "job.cnc": ("g21 g90\n{}\ng0 x1\nm30\n", EDING),
    "job.tap": ("g20g90\n{}\ng0x1\nm30\n", WINCNC),
    "job.src": ("%1\nG90\n{}\nG00 X1\nM30\n%\n", MCUWIN),
}
PORTAL = str(Path(__file__).resolve().parents[2] / "corpus" / "mcuwin" / "portal" / "machine.toml")


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("name", PLACES)
@pytest.mark.parametrize("one_in", sizes(5, 1))
def test_every_place_of_a_number(name: str, number: str, one_in: int, tmp_path: Path) -> None:
    """Each place and each number in every run, each of both only in a soak."""
    frame, places = PLACES[name]
    on = ("--machine", PORTAL) if name == "job.src" else ()
    first = list(NUMBERS).index(number) % one_in
    for place in places.replace("\n", "").split("|")[first::one_in]:
        line = place.replace(";", "\n").replace("#", NUMBERS[number]).replace("@", "#")
        text = frame.format(line)
        (tmp_path / name).write_text(text, encoding="utf-8")
        words = ("check", name, *on, "--setup", "zero", "--format", "json", "--max-blocks", "5000")
        done = in_this_process(words, tmp_path)
        assert done.exit in (0, 1, 2), (text[:200], done.err[:400])
        report = json.loads(done.out)
        assert {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}[report["verdict"]] == done.exit
        for one in report["findings"]:
            assert one["line"] > 0, one
            assert "inf " not in one["message"].replace("9" * 20, ""), one
            assert "nan" not in one["message"].split(), one
        told = [one for one in report["findings"] if one["severity"] in ("error", "unknown")]
        assert done.exit == 0 or told, text[:200]
        if "digits" in number and number != "wide digits" and not place.startswith(NAMES):
            assert done.exit != 0, text[:200]
