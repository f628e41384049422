"""Lines of McuWIN, mostly right, in some spelling, for the printers of its programs."""

from __future__ import annotations

import random

HEAD = """$DINEND
var step, Depth: double; N: integer; flag: boolean;
label again;
procedure bore(a: double; var k: integer);
begin
 again: k:=round(a) ;
end;
{$DINSTART}
%MAIN
"""
"""What declares the names of the lines."""


def random_line(rng: random.Random) -> str:
    """A line of McuWIN, mostly right, in some spelling."""

    def number() -> str:
        texts = ["0", "1", "12.5", ".25", "-3", "-.5", "+4", "007", "5.", "-0", "100000.000100", "0.1234567890123"]
        return rng.choice(["", " "]) + rng.choice(texts)

    def value() -> str:
        if rng.random() < 0.7:
            return number()
        texts = ["2*CD620", "(CD601 - y.rp)", "-cd600", " step", "( 1.50+SIN (Step/2) )", "(5)", "-(ci600 div 2)"]
        return rng.choice([*texts, " CD600", "((.5))", "- 5", "1e3", "(2)*(3)", "round( CD600)"])

    def words(letters: str) -> list[str]:
        return [letter + value() for letter in rng.sample(letters, rng.randint(0, min(4, len(letters))))]

    def condition() -> str:
        texts = ["CI600<1", "(flag)", "( X.DIGIB.5 )AND not Flag", "BOOLEAN (ci600)", "(CD600>=1.50)or(step<>-2)"]
        return rng.choice(texts)

    def block(depth: int = 2) -> str:
        """A whole block of ``$`` lines on lines of their own."""
        head, tail = rng.choice([
            (f"$if {condition()} then begin", "$end"), (f"$WHILE {condition()} do Begin", "$end ;"),
            ("$repeat begin", f"$end until {condition()};"), ("$ repeat", f"$until({condition()})"),
            ("$for CI601:=1 to  10 do begin", "$end;"), ("$for ci602 := N downto -1 do begin // down", "$END"),
        ])  # fmt: skip
        inner = [random_line(rng) if depth else "x1" for _ in range(rng.randint(0, 3))]
        if head.startswith("$if") and rng.random() < 0.6:
            inner += [rng.choice(["$end else begin", f"$end else if {condition()} begin", "$END\n$else Begin"]), "y.5"]
        return "\n".join([head, *inner, tail])

    kinds = [
        lambda: words("XYZABCIJKF"),
        lambda: [rng.choice(["G0", "G01", "G 2", "g3", "G000"]), *words("XYZIJKF")],
        lambda: [rng.choice(["G90", "G91 ", "G17", "g60 x y z", "G92", "G39", "G53", "G161"]), *words("XYZ")],
        lambda: [rng.choice(["G04", "G4 ", "M26", "M201 ", "G210"]), value()],
        lambda: [rng.choice(["M3", "M05", "m00", "M08 M03", "M100", "T1 M6", "S1000 M3", "D 2", "f step", "TCI600"])],
        lambda: [rng.choice(["m98 L7 O5", "M98 l007", "M98 Sub O (ci600+1)", "M96 L7", "M17", "m30", "M02"])],
        lambda: [rng.choice(["step := ", "CD600:=", "Step:=step+"]), value()],
        lambda: ["WRITE ", rng.choice(['"a (b"', '"" step', "CD600, CI600", '"x", -1', ""])],
        lambda: ["writeln", rng.choice([' "it\'s"', '"a"CD600"b"', " X.RP"])],
        lambda: [rng.choice(["$ wt( 500 );", "$CD600:=SQRT(step)*2.50 ;", "$halt;", "$sta( x,1.50 );", "$", "$;"])],
        lambda: [rng.choice(["$bore(1.,ci600);", "$ goto again;", "$if flag then begin ci600:=1 end;"])],
        lambda: [rng.choice(["$I lib.inc", "$i  missing.SRC", "%", "% Sub", "{$DINSTART}", "L7", "X.zeroOffset := 5"])],
        lambda: [block()],
        lambda: ["$DINEND\n  ci600 := 1 ;{ a\n  b }step:=.5\n { $DINSTART }"],
        list,
    ]  # fmt: skip
    parts = [part for part in rng.choice(kinds)() if part]
    line = "".join(parts) if rng.random() < 0.5 else "  ".join(parts)
    line = rng.choice([line, line, line, "  " + line, line + "\t "])
    if not line.lstrip().startswith(("%", "{")) and rng.random() < 0.3:
        line = f"N{rng.randint(1, 99):03d}" + rng.choice(["", " ", "  "]) + line
    pascal = line.rpartition("\n")[2].lstrip("N0123456789 \t").startswith("$") and "$I" not in line.upper()
    signs = (
        ["// rest ", "{ a }", "{b}{c}//d", "{\u00e4}"]
        if pascal
        else ["(a)", "(b c)(d)", "' rest ", "(\u00e4)", "'x(y", "()"]
    )
    if rng.random() < 0.3:
        line += rng.choice(["", " ", "     ", "\t"]) + rng.choice(signs)
    return line
