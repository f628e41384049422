"""A legal Job as text of Eding CNC. Sections are those of the Eding CNC manual 4.01."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gproof.backend.emit.eding.expressions import inside, part, value, variable
from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.rs274.writer import ONCE, OUTPUT, Rs274Writer
from gproof.ir.job import (
    AxisPlace,
    Choice,
    Job,
    LeaveRoutine,
    LoopWhile,
    Moves,
    Node,
    Quantity,
    Routine,
    RunRoutine,
    SetFrame,
    SetVariable,
    ShowText,
    SwitchGuard,
    SwitchOutput,
    WaitFor,
)
from gproof.ir.job_diameters import x_times
from gproof.ir.machine import Machine
from gproof.ir.program import Binary, Expr, Number
from gproof.ir.target import Style, Target


class EdingWriter(Rs274Writer):
    """See the module's text."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.handlers |= {
            SetVariable: self.setting, RunRoutine: self.run, ShowText: self.message, SwitchOutput: self.output,
            WaitFor: self.wait, SwitchGuard: self.guard,
        }  # fmt: skip

    def expression(self, value_: Expr) -> str:
        """``5``, ``#1``, ``[#1 + 2]`` (3.2.2)."""
        return super().expression(value_) if isinstance(value_, Number) else value(value_)

    def comment(self, text: str) -> str:
        """``(text)``, or after a semicolon where the text has brackets (3.2.4)."""
        return f"({text})" if "(" not in text and ")" not in text else f"; {text}"

    parks_all = True  # 3.4.8

    # ---- X of lathes (2.1.14)

    def words(self, places: tuple[AxisPlace, ...], *, summed: bool = False) -> list[str]:
        """Axis words; X of a machine with diameter programming is a diameter."""
        if self.machine.controller.diameter_programming:
            places = tuple(replace(place, at=_doubled(place.at)) if place.axis == "x" else place for place in places)
        return super().words(places, summed=summed)

    def moves(self, node: Moves) -> None:
        """A table, likewise."""
        super().moves(x_times(node, 2.0) if self.machine.controller.diameter_programming else node)

    # ---- structure (4.1)

    def routine_name(self, name: str) -> str:
        """A letter, then letters, digits and _."""
        plain = "".join(
            one if one.isascii() and (one.isalnum() or one == "_") else "_" for one in self.plain_name(name)
        )
        return plain if plain[:1].isalpha() else f"sub_{plain}"

    def open(self, node: Node) -> None:
        """``if [..]``, ``while [..]``."""
        assert isinstance(node, Choice | LoopWhile)
        self.line(f"{'if' if isinstance(node, Choice) else 'while'} [{inside(node.condition)}]")

    def divide(self, node: Choice) -> None:
        """``else``."""
        self.line("else")

    def close(self, node: Node) -> None:
        """``endif``, ``endwhile``."""
        self.line("endif" if isinstance(node, Choice) else "endwhile")

    def routine(self, routine: Routine) -> None:
        """``sub`` ... ``endsub``."""
        self.line(f"sub {self.names[routine.name]}")
        body = routine.body
        if body and isinstance(body[-1], LeaveRoutine):
            body = body[:-1]
        self.indented(body)
        self.line("endsub")
        self.line("")

    def run(self, node: RunRoutine) -> None:
        """``gosub``."""
        self.line(f"gosub {self.names[node.name]}")
        self.state = dict(self.constant)

    def setting(self, node: SetVariable) -> None:
        """``#1 = [..]``."""
        self.line(f"{variable(node.target)} = {value(node.value)}")

    # ---- operations

    def message(self, node: ShowText) -> None:
        """``msg`` (4.2)."""
        self.line(" ".join(["logmsg" if node.kind == "log" else "msg", *(part(one) for one in node.parts)]))

    def guard(self, node: SwitchGuard) -> None:
        """``tcaguard``, ``mcaguard`` (4.2)."""
        name = {"tool_change_area": "tcaguard", "machine_area": "mcaguard"}[node.name]
        self.line(f"{name} {'on' if node.on else 'off'}")

    def output(self, node: SwitchOutput) -> None:
        """M54, M55 P (3.5.9)."""
        if not isinstance(node.value, Number):
            raise Unprintable("an output whose state is computed")
        code = "M54" if node.value.value else "M55"
        self.put(OUTPUT, [code, f"P{self.expression(node.channel)}"], node.span)
        self.flush()

    def wait(self, node: WaitFor) -> None:
        """M56 P L Q (3.5.9)."""
        limit = [] if node.timeout is None else [f"Q{self.expression(node.timeout.value)}"]
        state = {None: [], True: ["L1"], False: ["L2"]}[node.on]
        words = ["M56", f"P{self.expression(node.channel)}", *state, *limit]
        self.put(OUTPUT, words, node.span)
        self.flush()

    def frame(self, node: SetFrame) -> None:
        """G68, G69 (3.4.18), G50, G51 (3.4.13) besides."""
        if node.action == "rotate" and node.angle is not None:
            # How its X and Y count in G91 is open (3.4.18).
            self.distances(node.places, node.span)
            self.flush()
            self.put(ONCE, ["G68", *self.words(node.places), f"R{self.amount(node.angle)}"], node.span)
            self.flush()
        elif node.action == "rotate_off":
            self.put(ONCE, ["G69"], node.span)
        elif node.action == "scale":
            factors = [f"{one.axis.upper()}{self.amount(one.at)}" for one in node.factors]
            about = {one.axis: self.amount(one.at) for one in node.places}
            # 3.4.13: about a place, always.
            places = [f"{letter}{about.get(axis, '0')}" for axis, letter in zip("xy", "IJ", strict=True)]
            self.put(ONCE, ["G51", *factors, *places], node.span)
            self.flush()
        elif node.action == "scale_off":
            self.put(ONCE, ["G50"], node.span)
        else:
            super().frame(node)


def _doubled(amount: Quantity) -> Quantity:
    value = amount.value
    if isinstance(value, Number):
        return replace(amount, value=replace(value, value=value.value * 2.0))
    return replace(amount, value=Binary("*", value, Number(2.0, value.span), value.span))


def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    """The files of a job: text by name, "" for its own; Unprintable."""
    return {"": EdingWriter(job, target, machine, style).write()}
