"""Programs nobody would write: random bytes, lines shaped like the grammar right and wrong, mutated jobs."""

from __future__ import annotations

import random
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

G_CODES = (
    "0 1 2 3 4 10 17 18 19 20 21 28 30 33 38.2 40 41 42 43 43.1 49 50 51 53 54 55 59 59.1 59.3 61 61.1 64 68 69 70 71"
    " 73 74 76 80 81 82 83 84 85 86 87 88 89 90 91 92 92.1 92.2 92.3 93 94 95 96 97 98 99 5 100 1.5 -1 00 01 1000000"
).split()
M_CODES = (
    "0 1 2 3 4 5 6 7 8 9 20 22 23 26 27 30 48 49 50 54 55 56 60 66 80 81 90 99 100 104 106 107 109 140 190 2.5 -3"
).split()
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
PARAMETERS = (
    "1 2 3 9 100 3999 4000 4999 5001 5006 5008 5009 5071 5101 5111 5161 5181 5211 5220 5221 5400 5401 5700 5799 5800"
    " 0 -1"
).split()
UNARY = "abs acos asin cos exp fix fup int ln round sin sqrt tan not -".split()
BINARY = "+ - * / ** mod and or xor band bor bxor << >> < > <= >= == <>".split()
NUMBERS = (
    "0 1 2 -1 +3 0.5 .5 5. -0 -.25 10 25.4 100 1000 1e5 0x1F 1.2.3 . - -- +- 1_0 00012 99999999999 0.0000001"
    " 3.14159265358979323846 1000000000000 1000000000001"
).split()  # fmt: skip
STRANGE = (
    b"\0",
    b"\r",
    b"\t",
    b"\x0c",
    b"\x1b",
    b"\x7f",
    b"\xff",
    b"\xc3\xa4",
    b"\xe2\x80\x9c",
    b"\xef\xbb\xbf",
    b"\x1a",
)


class Wild:
    """One random program; ``lines`` grows by statements that are right more often than not."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.wrong = rng.choice((0.0, 0.0, 0.02, 0.1, 0.4))
        self.names = [f"part_{n}" for n in range(rng.randrange(4))]
        self.lines: list[str] = []

    def oops(self) -> bool:
        return self.rng.random() < self.wrong

    # -- pieces of a line

    def number(self) -> str:
        rng = self.rng
        if self.oops():
            return rng.choice((*NUMBERS, "", "9" * rng.choice((20, 100, 200)), "." + "0" * 60 + "1"))
        if rng.random() < 0.5:
            return str(rng.randrange(-30, 100))
        return f"{rng.uniform(-60, 120):.{rng.randrange(5)}f}"

    def expression(self, depth: int = 0) -> str:
        rng = self.rng
        kind = rng.randrange(7 if depth < 4 else 2)
        if kind <= 1:
            return self.number()
        if kind == 2:
            return self.parameter(depth + 1)
        if kind == 3:
            return f"[{self.expression(depth + 1)}]"
        if kind == 4:
            return f"{rng.choice(UNARY)}[{self.expression(depth + 1)}]"
        if kind == 5 and rng.random() < 0.2:
            return f"atan[{self.expression(depth + 1)}]/[{self.expression(depth + 1)}]"
        return f"{self.expression(depth + 1)} {rng.choice(BINARY)} {self.expression(depth + 1)}"

    def parameter(self, depth: int = 0) -> str:
        if self.rng.random() < 0.1 and depth < 4:
            return f"#[{self.expression(depth + 1)}]"
        return f"#{self.rng.choice(PARAMETERS if self.oops() else PARAMETERS[:4])}"

    def value(self) -> str:
        rng = self.rng
        if rng.random() < 0.85:
            return self.number()
        return self.parameter() if rng.random() < 0.4 else f"[{self.expression()}]"

    def words(self, letters: str, most: int = 4) -> str:
        chosen = self.rng.sample(letters, min(len(letters), self.rng.randrange(1, most + 1)))
        if self.oops():
            chosen.append(self.rng.choice(LETTERS))
        return " ".join(f"{letter}{self.value()}" for letter in chosen)

    def comment(self) -> str:
        texts = ["(a hole)", "(MSG, tool 3)", "(äöü)", "; the rest", "(two) (comments)"]
        if self.oops():
            texts = ["(", ")", "(a (b) c)", "(a", "; ( ;", "(msg,", "(MSG, \u201cx\u201d)"]
        return self.rng.choice(texts)

    def block(self) -> str:
        rng = self.rng
        kind = rng.randrange(12)
        if kind <= 2:
            text = f"G{rng.choice('01')} {self.words('XYZABC')}"
        elif kind == 3:
            text = self.words("XYZF")
        elif kind <= 5:
            if rng.random() < 0.5:
                # A whole circle, or a radius that reaches.
                where = rng.choice(("I{0}", "J{0}", "I{0} J{0}")).format(rng.randrange(1, 30))
                text = f"G91 G{rng.choice('23')} X0 Y0 {where}"
                return rng.choice((text, f"G91 G{rng.choice('23')} X{rng.randrange(1, 20)} R{rng.randrange(20, 40)}"))
            format_words = rng.choice(("I{} J{}", "R{}", "I{} K{}", "J{}", "K{} I{} J{}")).replace("{}", "%s")
            numbers = tuple(self.value() for _ in range(format_words.count("%s")))
            text = f"G{rng.choice('23')} {self.words('XYZ')} {format_words % numbers}"
        elif kind == 6:
            text = f"G{rng.choice('73 81 82 83 85 86 89'.split())} {self.words('XYZRPQL', 7)}"
        elif kind == 7:
            axes = self.words("XYZ")
            code = rng.choice(("G10 L2 P1", "G10 L20 P2", "G92", "G43 H1", "G54", "G59.3", "G43.1", "G28", "G30"))
            text = f"{code} {axes}" if rng.random() < 0.7 else code
        elif kind == 8:
            most = 4 if self.oops() else 2
            text = " ".join(f"G{rng.choice(G_CODES)}" for _ in range(rng.randrange(1, most)))
        elif kind == 9:
            text = f"M{rng.choice(M_CODES)} {self.words('STPQF', 2)}"
        elif kind == 10:
            text = " ".join(f"{self.parameter()}={self.value()}" for _ in range(rng.randrange(1, 3)))
        else:
            text = self.words(LETTERS, 6) if self.oops() else f"G1 {self.words('XYZ')} F{rng.randrange(1, 900)}"
        if rng.random() < 0.3:
            text += f" F{self.value()}"
        if rng.random() < 0.1:
            text = f"N{rng.randrange(100000)} {text}"
        if rng.random() < 0.05:
            text = f"/{text}"
        if rng.random() < 0.15:
            text += f" {self.comment()}"
        return text

    # -- lines

    def statement(self, depth: int) -> None:
        rng, add = self.rng, self.lines.append
        kind = rng.randrange(20)
        if kind == 0 and depth < 6:
            add(f"if [{self.expression()}]" + rng.choice(("", "", " then")))
            self.body(depth + 1)
            if rng.random() < 0.5:
                self.structural("else")
                self.body(depth + 1)
            self.structural("endif")
        elif kind == 1 and depth < 6:
            counter = f"#{rng.randrange(1, 5)}"
            add(f"{counter} = 0")
            add(f"while [{counter} < {rng.randrange(6)}]" if not self.oops() else f"while [{self.expression()}]")
            add(f"{counter} = [{counter} + 1]")
            self.body(depth + 1)
            self.structural("endwhile")
        elif kind == 2 and self.names:
            add(f"gosub {rng.choice(self.names) if not self.oops() else rng.choice(('nowhere', '', '9', 'a b'))}")
        elif kind == 3:
            texts = [
                'msg "x is " #1',
                'warnmsg "w"',
                "logmsg [1+2]",
                'dlgmsg "d" "a" 1',
                'msg "open',
                "msg",
                'msg "{0} %s"',
            ]
            add(rng.choice(texts) if rng.random() < 0.9 else 'errmsg "stop"')
        elif kind == 4:
            add(rng.choice(("TCAGuard off", "TCAGuard on", "MCAGuard off", "MCAGuard on", "tcaguard maybe")))
        elif kind == 5:
            add(rng.choice(("", "%", self.comment(), "  ", "/", "N10")))
        elif kind == 6 and self.oops():
            add(
                rng.choice(
                    ("endif", "endwhile", "endsub", "else", "sub", "sub part_0", "if", "while [", "homeIsEstop on")
                )
            )
        else:
            add(self.block())

    def structural(self, text: str) -> None:
        if not self.oops():
            self.lines.append(text)

    def body(self, depth: int) -> None:
        for _ in range(self.rng.randrange(4)):
            self.statement(depth)

    def program(self) -> bytes:
        rng = self.rng
        if rng.random() < 0.7:
            self.lines.append("G21 G90 G17 G94 G40 G49 F500")
        for _ in range(rng.randrange(1, 25)):
            self.statement(0)
        end = rng.choice(("M30", "M2", "", "%"))
        self.lines.append(end)
        for name in self.names:
            self.lines.append(f"sub {name}")
            self.body(1)
            self.structural("endsub")
        newline = "\r\n" if rng.random() < 0.1 else "\n"
        text = newline.join(self.lines) + (newline if rng.random() < 0.8 else "")
        return text.encode(rng.choice(("utf-8", "utf-8", "latin-1")), "replace")


def wild_program(rng: random.Random) -> bytes:
    return Wild(rng).program()


def random_bytes(rng: random.Random) -> bytes:
    """Bytes of all values, of text, or of G-code's own alphabet."""
    size = rng.choice((0, 1, 2, 5, 30, 300, 2000))
    kind = rng.randrange(3)
    if kind == 0:
        return rng.randbytes(size)
    alphabet = b'GMXYZIJKRFSTPLNHDQ0123456789.-+ \n\n()[]#=/;%,"<>*\r\t' if kind == 1 else bytes(range(9, 127))
    return bytes(rng.choice(alphabet) for _ in range(size))


def corpus_jobs() -> list[bytes]:
    """Every job of the corpus that is not long."""
    jobs = sorted((ROOT / "corpus").glob("*/*/job.cnc"))
    return [path.read_bytes() for path in jobs if path.stat().st_size < 60_000]


def mutated(rng: random.Random, jobs: list[bytes]) -> bytes:
    """A job, or some of its lines, with a few bytes, numbers or lines changed."""
    lines = rng.choice(jobs).splitlines(keepends=True)
    first = rng.randrange(len(lines))
    data = b"".join(lines if len(lines) < 80 and rng.random() < 0.5 else lines[first : first + 60])
    for _ in range(rng.choice((1, 1, 2, 5, 20))):
        at = rng.randrange(len(data) + 1)
        kind = rng.randrange(7)
        if kind == 0:
            data = data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
        elif kind == 1:
            data = data[:at] + data[at + rng.randrange(1, 10) :]
        elif kind == 2:
            data = data[:at] + rng.choice(STRANGE) + data[at:]
        elif kind == 3:
            data = data[:at] + data[max(0, at - rng.randrange(60)) : at] + data[at:]
        elif kind == 4:
            data = (
                data[:at]
                + rng.choice((*NUMBERS, "G", "M", "#", "[", "]", "(", "if", "sub", "G91 ")).encode()
                + data[at:]
            )
        elif kind == 5:
            parts = data.splitlines(keepends=True)
            rng.shuffle(parts)
            data = b"".join(parts)
        else:
            data = data.replace(
                rng.choice((b"G1", b"G2", b"X", b"F", b"\n", b"M30")), rng.choice((b"G3", b"", b"Y", b"R")), 2
            )
    return data
