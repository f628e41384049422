"""The problems and remarks of the kernel in words: place in the source, motor, tick, and the numbers.

``Words`` has a sentence for each kind that the kernel gives; walk_words.py those for what the walk notes. Nothing is
decided here, but for one thing that changes no verdict of the whole: a step that no path point explains refutes the
order where another row of the trace would explain it, and the position otherwise.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.ir.drives import AXIS_NAMES
from gproof.ir.finding import Span
from gproof.ir.machine import Machine
from gproof.ir.setup import Setup
from gproof.ir.trace import Op, Trace, Wait
from gproof.verify.explain.walk_words import WALK, Noted, left
from gproof.verify.kernel.proof import Job, Problem, Remark

_SHOWN = 40
"""Characters of a stranger's name in a message."""
_NAMED = 5
"""Commands that no board carries out, as many by name."""


def span_of(trace: Trace, section: int, row: int) -> Span:
    """The source line of a row; the file as a whole when there is none."""
    rows = trace.sections[section].rows if 0 <= section < len(trace.sections) else ()
    if isinstance(rows, tuple) or not 0 <= row < len(rows):
        return Span(trace.files[0] if trace.files else "", 0)
    return Span(trace.files[int(rows["file"][row])], int(rows["line"][row]))


class Words:
    """Of the proof of a stream for this trace, machine and setup; seen: what was followed."""

    def __init__(self, seen: Job | None, trace: Trace, machine: Machine, setup: Setup) -> None:
        self._seen, self._trace, self._machine, self._setup = seen, trace, machine, setup

    def charged(self, problem: Problem) -> Problem:
        """The problem with the property that it is reported under."""
        if problem.kind != "walk.left":
            return problem
        order, what = left(self._noted(problem), self._trace)
        return problem._replace(property="stream-order" if order else problem.property, values=(*problem.values, what))

    def place(self, problem: Problem) -> Span:
        """Where in the source it is."""
        return span_of(self._trace, problem.section, problem.row)

    def what(self, problem: Problem) -> str:
        """A problem, as ``charged`` has it."""
        group = problem.kind.partition(".")[0]
        section, row, values = problem.section, problem.row, problem.values
        if group in ("form", "cylinder"):
            return FORM[problem.kind](self._machine, *values)
        if group == "graph":
            where = f"section {section}" + (f", row {row}" if row >= 0 else "") + ": " if section >= 0 else ""
            return where + GRAPH[problem.kind](*values)
        if group in ("row", "raised"):
            return f"section {section}, row {row}: {ROWS[problem.kind](*values)}"
        if group == "event":
            tick, *more = values
            return f"section {section}, row {row}, tick {tick}: {EVENTS[problem.kind](*more)}"
        if group == "walk":
            tick = values[1]
            said = values[-1] if problem.kind == "walk.left" else WALK[problem.kind](self._noted(problem))
            return f"section {section}, row {row}, tick {tick}: {said}"
        return BETWEEN[problem.kind](section, *values)

    def remark(self, remark: Remark) -> str:
        """What a verdict depends on, or why it is open."""
        if remark.kind == "open.travel":
            motor, section, row = remark.values
            assert self._seen is not None
            line = span_of(self._trace, section, row).line
            name = self._seen.stream.motors[motor].name
            return f"{name} passes its soft limit with the guard off in line {line}; the machine file gives no travel"
        return REMARKS[remark.kind](*remark.values)

    def _noted(self, problem: Problem) -> Noted:
        assert self._seen is not None
        return Noted(problem, self._seen, self._machine, self._setup)


FORM: dict[str, Callable[..., str]] = {
    "form.part": lambda _, part, why: f"{'Machine' if part == 'Drives' else part}: {why}",
    "form.tick-frequency": lambda _, frequency: f"tick frequency {frequency}",
    "form.section-place": lambda _, number, place: f"section {number} is at place {place}",
    "form.one-for-each-motor": lambda _, number: (
        f"section {number}: not one start position and one run table for each motor"
    ),
    "form.table": lambda _, number: f"section {number}: a table has neither runs nor events",
    "form.start": lambda _, number, start, duration: f"section {number}: start {start}, duration {duration}",
    "form.run": lambda _, number, k, motor, run: f"section {number}: run {k} of {motor} is {run}",
    "form.too-long": lambda _, number, motor: f"section {number}: {motor} has more steps or ticks than can be counted",
    "form.sections": lambda _, stream, trace: f"the stream has {stream} sections, the trace {trace}",
    "form.machine-number": lambda _, name, value: f"{name} {value!r}",
    "form.interpolation-time": lambda _, value: f"interpolation time {value!r} is less than a tick",
    "form.limit": lambda _, drive: f"axis {drive.lower()}: a limit is not a number",
    "form.slaves": lambda _, axis, count: f"axis {axis}: {count} slaves",
    "form.board-frequency": lambda machine, stream, board: (
        f"the stream counts {stream} ticks per second, the board {machine.board.name} {board}"
    ),
    "form.motor-names": lambda _, names: f"two motors with the same name: {', '.join(names)}",
    "form.no-such-motor": lambda _, motor, axis: f"motor {motor} drives axis {axis}: the machine has no such motor",
    "form.other-steps": lambda _, motor, steps, name, known: (
        f"motor {motor} has {steps} steps per unit, the machine's {name} {known}"
    ),
    "form.steps-per-unit": lambda _, motor, steps: f"motor {motor}: {steps} steps per unit",
    "form.motors-of-axis": lambda _, axis, found, wanted: (
        f"axis {axis} has {found} motors in the stream, {wanted} on the machine"
    ),
    "form.no-height-map": lambda _: "Z follows a height map, but the setup has none",
    "form.height-map": lambda _, problem: f"the height map: {problem}",
    "form.never-homed": lambda _, axis: f"axis {axis} moves, but the setup says that it is not homed",
    "form.tip-feed": lambda _, axis: f"the feed of axis {axis} is that of the tool over the material",
    "cylinder.numbers": lambda _, radius, y, zero: (
        f"Y is mapped onto A with radius {radius}, axis of rotation {y}, zero {zero}"
    ),
    "cylinder.axes": lambda _: "Y is mapped onto A, but the machine lacks one of them",
    "cylinder.height-map": lambda _: "a height map is used on a cylinder",
    "cylinder.turned": lambda _, number: f"section {number} moves A while Y is mapped onto it",
    "cylinder.start": lambda _, angle, low, high: (
        f"the trace starts with A at {angle:.6f}; the setup says {low:.6f} to {high:.6f}"
    ),
}
"""Of machine and numbers, in the job as a whole."""


def _waiting(kind: Op) -> str:
    name = kind.name.lower().replace("_", " ")
    article = "the" if kind is Op.END else "an" if name[0] in "aeiou" else "a"
    return f"{article} {name}"


def _waits(waits: tuple[Wait, ...]) -> str:
    return " and ".join(sorted(wait.value for wait in waits))


GRAPH: dict[str, Callable[..., str]] = {
    "graph.no-section": lambda: "there is no section, so there is nothing to run",
    "graph.no-edge": lambda: "what follows is not known",
    "graph.two-waits": lambda waits: f"it ends in {_waits(waits)} at once",
    "graph.undecided": lambda wait: f"a step stream cannot decide what follows ({wait.value})",
    "graph.one-outcome": lambda outcomes: f"two continuations for one outcome: {', '.join(map(repr, outcomes))}",
    "graph.end-goes-on": lambda target: f"the program ends here and goes on with section {target}",
    "graph.goes-on": lambda kind: f"the section goes on after {_waiting(kind)}",
    "graph.other-wait": lambda kind, *waits: f"after {_waiting(kind)} comes {_waits(waits) or 'nothing'}",
    "graph.wait-without-row": lambda wait: f"it ends in {wait.value}, and no row of it says so",
    "graph.setpoint": lambda name: f"{name[:_SHOWN]!r} cannot be set",
    "graph.back": lambda target: f"it leads back to section {target}: the stream would never end",
    "graph.no-way": lambda: "nothing leads to this section",
    "graph.synchronised": lambda: "this move follows the turns of the spindle",
    "graph.surface-speed": lambda: "the spindle's speed follows the tool",
    "graph.head": lambda: "another head is selected",
    "graph.retimed": lambda: "the job changes what the machine file says of its axes",
    "graph.knife": lambda: "the knife is turned by the controller, not by these rows",
    "graph.orientation": lambda: "the spindle stops in an orientation",
    "graph.unused-height-map": lambda: (
        "the height map of the setup is on, but no move follows it; "
        "write on = false if the job switches it off before it moves"
    ),
}
"""Of the section graph."""

ROWS: dict[str, Callable[..., str]] = {
    "row.start-unknown": lambda: "the section's start depends on something that is not known",
    "row.table": lambda: "the table has no trace rows",
    "row.start-not-finite": lambda: "the start is not finite",
    "row.unknown": lambda: "the position depends on something that is not known",
    "row.jump": lambda: "the position jumps in a row without motion",
    "row.no-motor": lambda: "an axis without a motor moves",
    "row.arc-without-motor": lambda: "an arc in an axis without a motor",
    "row.far": lambda farthest: f"a position of more than {farthest} steps",
    "row.no-plane": lambda: "an arc in no plane",
    "row.no-feed": lambda: "motion without a feed",
    "row.far-start": lambda farthest: f"a start of more than {farthest} steps",
    "row.no-radius": lambda: "an arc without a radius",
    "row.long-arc": lambda farthest: f"an arc of more than {farthest} steps",
    "raised.on-or-off": lambda: "the map is on or off at the start of the section, depending on what came before",
    "raised.jump": lambda jump: f"the map ends or is switched here, and Z would jump by {jump:.6f} mm",
    "raised.far": lambda farthest: f"Z is raised to more than {farthest} steps",
    "raised.chords": lambda most: f"more than {most} chords are needed",
    "raised.grid-lines": lambda: "the grid lines that it crosses cannot be determined",
}
"""Of a row of the trace."""

EVENTS: dict[str, Callable[..., str]] = {
    "event.missing": lambda: "the event of this row is missing",
    "event.no-row": lambda: "an event for a row that has none",
    "event.again": lambda: "the event of this row a second time",
    "event.order": lambda: "an event out of the order of its rows",
    "event.outside": lambda duration: f"an event outside its section of {duration} ticks",
    "event.early": lambda: "an event before the one of an earlier row",
    "event.other": lambda given, op: f"the event is {given}, the row {op.name} ({int(op)})",
    "event.unknown": lambda op: f"{op.name} with a value that is not known",
    "event.value": lambda op, given, value: f"{op.name} with {given} thousandths, the row says {value!r}",
    "event.dwell": lambda seconds: f"a dwell of {seconds!r} seconds",
    "event.spindle": lambda direction: f"a spindle direction of {direction!r}",
}
"""Of an event, with its tick."""

BETWEEN: dict[str, Callable[..., str]] = {
    "start.step": lambda number, motor, steps, at, exact: (
        f"section {number}: {motor} starts at step {steps}, but the trace at {at:.6f}, which is step {exact:.3f}"
    ),
    "start.stated": lambda _, axis, at, low, high: (
        f"the trace starts at {AXIS_NAMES[axis]} {at:.6f}; the setup says {low:.6f} to {high:.6f}"
    ),
    "edge.start": lambda number, final, target, start: (
        f"section {number} ends at {final}, but section {target} starts at {start}"
    ),
    "edge.setup": lambda number, motor, ticks, target, needed: (
        f"{_gap(number, motor, ticks, target)}; {needed} needed for the new direction"
    ),
    "edge.ticks": lambda number, motor, ticks, target, needed: f"{_gap(number, motor, ticks, target)}; {needed} needed",
}
"""Of a section's start, and of what is between two sections."""


def _gap(number: int, motor: str, ticks: int, target: int) -> str:
    return f"{motor}: {ticks} ticks between the steps of sections {number} and {target}"


def _left_to_others(names: tuple[str, ...]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"no board executes {', '.join(names[:_NAMED])}{more}: whoever runs the stream has to do it"


REMARKS: dict[str, Callable[..., str]] = {
    "assumed.backlash": lambda motor, backlash: (
        f"{motor.lower()} reached its start position from below (backlash {backlash:g})"
    ),
    "assumed.no-limit": lambda motor: f"axis {motor.lower()} needs no limit: the machine file gives none",
    "assumed.no-step-frequency": lambda: "the machine file gives no maximum step frequency",
    "assumed.left-to-others": _left_to_others,
    "assumed.moved-by-others": lambda wait: f"{wait.value} leaves the machine where the trace continues",
    "open.no-velocity": lambda motor: f"the machine file gives no velocity for {motor.lower()}",
    "open.no-acceleration": lambda motor: f"the machine file gives no acceleration for {motor.lower()}",
    "open.malformed": lambda: "the stream is malformed",
    "open.section": lambda number: f"section {number} could not be followed",
    "open.section-end": lambda number: f"section {number} was not followed to its end",
}
"""Of what verdicts depend on, and why they are open. Certificates hold those of ``assumed``: a change of their words
has a row in earlier_words.py."""
