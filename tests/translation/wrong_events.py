"""Kinds of wrong translation besides the moves of a target: dwells, stops, ends, devices, tools, zeros, structure.

As ``wrong_moves``: a kind gives the wrong texts that a target has room for, and leaves out what changes nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from translation.target_text import AXES, MILLING, Line, Text
from translation.wrong_moves import kind

# ---- dwells, stops, ends

_TIME = r"(G0?4\s*[PX]?\s*)(\d+\.?\d*)"


def _times(t: Text, factor: float) -> Iterator[str]:
    for n, line in t.each("dwell"):
        match = re.search(_TIME, line.code)
        if match and float(match[2]):
            yield t.replaced(n, f"{match[1]}{float(match[2]) * factor:g}")


@kind
def seconds_as_milliseconds(t: Text) -> Iterator[str]:
    return _times(t, 0.001)


@kind
def milliseconds_as_seconds(t: Text) -> Iterator[str]:
    """A loop that waits for an input looks every ten seconds then."""
    return _times(t, 1000)


@kind
def a_dwell_that_is_lost(t: Text) -> Iterator[str]:
    """A loop that only waits for an input may do so at any pace."""
    for n, line in t.each("dwell"):
        if float(re.search(_TIME, line.code)[2]) and not _in_wait(t, n):  # type: ignore[index]
            yield t.replaced(n)


def _in_wait(t: Text, n: int) -> bool:
    return any("while" in one.raw.lower() for one in t.lines[max(0, n - 1) : n])


@kind
def a_dwell_that_is_doubled(t: Text) -> Iterator[str]:
    for n, line in t.each("dwell"):
        if float(re.search(_TIME, line.code)[2]) and not _in_wait(t, n):  # type: ignore[index]
            yield t.before(n, line.raw)


@kind
def a_dwell_in_addition(t: Text) -> Iterator[str]:
    dwell = {"wincnc": "G4 X2", "mcuwin": "G04 2"}.get(t.dialect, "G4 P2")
    for n, _ in t.each("move", "machine"):
        yield t.before(n, dwell)


@kind
def a_wait_for_a_time(t: Text) -> Iterator[str]:
    dwell = {"wincnc": "G4 X1", "mcuwin": "G04 1"}.get(t.dialect, "G4 P1")
    for n, _ in t.each("stop"):
        yield t.replaced(n, dwell)


@kind
def a_time_as_a_stop(t: Text) -> Iterator[str]:
    for n, _ in t.each("dwell"):
        if not _in_wait(t, n):
            yield t.replaced(n, "G4" if t.dialect == "wincnc" else "M00" if t.dialect == "mcuwin" else "M0")


@kind
def a_stop_that_is_lost(t: Text) -> Iterator[str]:
    for n, _ in t.each("stop"):
        yield t.replaced(n)


@kind
def a_stop_that_is_optional(t: Text) -> Iterator[str]:
    for n, _ in t.each("stop"):
        yield from t.substituted(n, "M00?(?![0-9])", "M1")


@kind
def a_stop_in_addition(t: Text) -> Iterator[str]:
    stop = {"wincnc": "G4", "mcuwin": "M00"}.get(t.dialect, "M0")
    for n, _ in t.each("move", "machine"):
        yield t.before(n, stop)


_EVENT = re.compile(r"(?<![A-Z0-9.])M0?(?:[34578]|9|1[1-4]C\d+|2[67] \d+|5[45] P\d+)(?![0-9.])|S\d+$")


def _is_event(line: Line) -> bool:
    return line.kind in ("dwell", "stop") or (line.kind == "other" and bool(_EVENT.match(line.code.strip())))


@kind
def an_event_that_is_late(t: Text) -> Iterator[str]:
    """After the move that it comes before."""
    for n, line in enumerate(t.lines[:-1]):
        after = t.lines[n + 1]
        if _is_event(line) and not line.code.startswith("S") and after.kind == "move" and after.moves:
            yield t.exchanged(n)


@kind
def an_event_that_is_early(t: Text) -> Iterator[str]:
    """Before the move that it comes after."""
    for n, line in enumerate(t.lines[:-1]):
        after = t.lines[n + 1]
        if _is_event(after) and not after.code.startswith("S") and line.kind == "move" and line.moves:
            yield t.exchanged(n)


@kind
def an_end_before_the_end(t: Text) -> Iterator[str]:
    end = {"wincnc": "M99", "mcuwin": "M02"}.get(t.dialect, "M2")
    for n, line in t.each("move"):
        if line.moves is not False:
            yield t.before(n, end)


@kind
def an_end_that_is_cut_off(t: Text) -> Iterator[str]:
    """Only what comes before the last move."""
    moves = [n for n, line in t.each("move", "cycle", "machine") if line.moves is not False]
    if moves:
        end = t.lines[-1].raw if t.dialect == "mcuwin" else ""
        ends = [line.raw for line in t.lines if line.kind == "end"][:1]
        yield "\n".join([*t.raw[: moves[-1]], *ends, *([end] if end else [])]) + "\n"


# ---- devices


@kind
def direction_of_the_spindle(t: Text) -> Iterator[str]:
    for n, _ in t.coded("M3"):
        yield from t.substituted(n, r"M(0?)3(?![0-9])", r"M\g<1>4")


@kind
def speed_of_the_spindle(t: Text) -> Iterator[str]:
    for n, _ in enumerate(t.lines):
        yield from t.substituted(n, r"(?<![A-Z%])S(\d+)(?!\.)", r"S1\g<1>")


@kind
def a_spindle_that_does_not_start(t: Text) -> Iterator[str]:
    for n, _ in t.coded("M3", "M4"):
        yield from t.substituted(n, r"M0?[34](?![0-9])", "")


@kind
def a_spindle_that_does_not_stop(t: Text) -> Iterator[str]:
    """An end of the program (M30) may stop it, too."""
    for n, line in t.coded("M5"):
        resets = any(one.has("M30") for one in t.lines) and t.dialect in ("eding", "grbl", "linuxcnc")
        if not resets and line.code.strip() in ("M5", "M05"):
            yield t.replaced(n)


@kind
def a_spindle_in_addition(t: Text) -> Iterator[str]:
    for n, _ in t.each("move"):
        yield t.before(n, "S4321 M3" if t.dialect in MILLING else "S4321\nM3")


@kind
def mist_for_flood(t: Text) -> Iterator[str]:
    for n, line in t.coded("M8", "M7"):
        if t.dialect != "mcuwin":
            old, new = ("M0?8(?![0-9])", "M7") if line.has("M8") else ("M0?7(?![0-9])", "M8")
            yield from t.substituted(n, old, new)


@kind
def coolant_that_is_lost(t: Text) -> Iterator[str]:
    for n, _ in t.coded("M7", "M8"):
        yield t.replaced(n)


@kind
def coolant_in_addition(t: Text) -> Iterator[str]:
    """Where no coolant is on."""
    if not any(line.has("M7", "M8") for line in t.lines):
        for n, _ in t.each("move"):
            yield t.before(n, "M08" if t.dialect == "mcuwin" else "M8")


@kind
def coolant_that_stays_on(t: Text) -> Iterator[str]:
    resets = any(one.has("M30") for one in t.lines) and t.dialect in ("eding", "grbl", "linuxcnc")
    for n, line in t.coded("M9"):
        if not resets and line.code.strip() in ("M9", "M09"):
            yield t.replaced(n)


_OUTPUT = {"wincnc": r"(M1[1-4]C)(\d+)", "mcuwin": r"(M2[67] )(\d+)", "eding": r"(M5[45] P)(\d+)"}


def _outputs(t: Text) -> Iterator[tuple[int, re.Match[str]]]:
    for n, line in enumerate(t.lines):
        match = re.match(_OUTPUT.get(t.dialect, r"(M6[2-5] P)(\d+)"), line.code.strip())
        if match:
            yield n, match


@kind
def a_channel_off_by_one(t: Text) -> Iterator[str]:
    for n, match in _outputs(t):
        yield t.replaced(n, f"{match[1]}{int(match[2]) + 1}")


@kind
def channels_that_count_from_zero(t: Text) -> Iterator[str]:
    for n, match in _outputs(t):
        yield t.replaced(n, f"{match[1]}{int(match[2]) - 1}")


@kind
def the_channel_of_another_axis(t: Text) -> Iterator[str]:
    for n, match in _outputs(t) if t.dialect == "mcuwin" else ():
        yield t.replaced(n, f"{match[1]}{int(match[2]) + 100}")


@kind
def an_output_off_for_on(t: Text) -> Iterator[str]:
    pairs = (("M11", "M12"), ("M13", "M14"), ("M26", "M27"), ("M54", "M55"))
    other = dict(pairs) | {b: a for a, b in pairs}
    for n, match in _outputs(t):
        yield t.replaced(n, other[match[1][:3]] + match[1][3:] + match[2])


@kind
def an_output_that_is_lost(t: Text) -> Iterator[str]:
    for n, _ in _outputs(t):
        yield t.replaced(n)


@kind
def an_output_that_does_not_wait(t: Text) -> Iterator[str]:
    """M13 in place of M11: motion goes on, unless the axes rest there anyway."""
    for n, match in _outputs(t) if t.dialect == "wincnc" else ():
        near = [t.lines[k].kind == "move" for k in (n - 1, n + 1) if 0 <= k < len(t.lines)]
        if near == [True, True] and match[1] in ("M11C", "M12C"):
            yield t.replaced(n, {"M11C": "M13C", "M12C": "M14C"}[match[1]] + match[2])


@kind
def an_output_that_waits(t: Text) -> Iterator[str]:
    for n, _match in _outputs(t):
        near = [t.lines[k].kind == "move" for k in (n - 1, n + 1) if 0 <= k < len(t.lines)]
        if near == [True, True] and t.dialect == "mcuwin":
            yield t.before(n, "G04 0.01")


@kind
def another_tool(t: Text) -> Iterator[str]:
    for n, _ in enumerate(t.lines):
        yield from t.substituted(n, r"(?<![A-Z0-9])T(\d+)", r"T1\g<1>")


@kind
def a_tool_change_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        if line.has("M6") or line.code.startswith("L110"):
            yield t.replaced(n)


@kind
def a_tool_that_is_only_selected(t: Text) -> Iterator[str]:
    for n, _ in t.coded("M6") if t.dialect in MILLING else ():
        yield from t.substituted(n, r"\s*M0?6(?![0-9])", "")


@kind
def a_tool_change_in_addition(t: Text) -> Iterator[str]:
    change = {"wincnc": "L110 T7", "mcuwin": "T7 M06", "grbl": "T7 M6"}.get(t.dialect, "T3 M6")
    for n, _ in t.each("move"):
        yield t.before(n, change)


# ---- zeros


def _set(t: Text) -> Iterator[tuple[int, Line]]:
    """Lines that set a zero with numbers."""
    pattern = re.compile(rf"(?:G92|G10 ).*[{AXES}]-?\d")
    return ((n, line) for n, line in t.each("frame", "other") if pattern.search(line.code))


def _zeros(t: Text, by: str) -> Iterator[str]:
    for n, line in _set(t):
        for match in re.finditer(rf"([{AXES}])(-?)(\d+\.?\d*)", line.code):
            new = match.expand(by).replace("--", "")
            is_read = "G10" not in line.code or any(match[1] in one.words for one in t.lines[n + 1 :])
            if is_read and (float(match[3]) or not by.startswith(r"\1-")):
                yield t.replaced(n, line.raw[: match.start()] + new + line.raw[match.end() :])


@kind
def sign_of_an_offset(t: Text) -> Iterator[str]:
    return (text for text in _zeros(t, r"\1-\2\3"))


@kind
def an_offset_that_is_a_little_wrong(t: Text) -> Iterator[str]:
    return _zeros(t, r"\1\g<2>1\3")


@kind
def an_offset_that_is_lost(t: Text) -> Iterator[str]:
    for n, _ in _set(t):
        yield t.replaced(n)


@kind
def an_offset_of_another_axis(t: Text) -> Iterator[str]:
    for n, line in _set(t):
        axes = re.findall(rf"([{AXES}])-?\d", line.code)
        free = next((a for a in AXES if a not in axes), None)
        if free:
            yield from t.substituted(n, rf"{axes[0]}(?=-?\d)", free)


@kind
def an_offset_that_is_doubled(t: Text) -> Iterator[str]:
    """One that adds: WinCNC's G92.2, McuWIN's G92 in G91."""
    for n, line in _set(t):
        adds = line.has("G92.2") if t.dialect == "wincnc" else line.relative and t.dialect == "mcuwin"
        if adds and re.search(rf"[{AXES}]-?0*[1-9]|[{AXES}]-?0\.0*[1-9]", line.code):
            yield t.before(n, line.raw)


@kind
def an_offset_that_is_not_taken_back(t: Text) -> Iterator[str]:
    for n, _line in t.coded("G92.1") if t.dialect in MILLING else t.coded("G54") if t.dialect == "mcuwin" else ():
        if t.has_moved(n):
            yield t.replaced(n)


@kind
def a_work_offset_that_is_not_restored(t: Text) -> Iterator[str]:
    for n, _line in t.coded("G54"):
        if t.has_moved(n) and t.dialect in MILLING:
            yield from t.substituted(n, "G54", "")


@kind
def another_work_offset(t: Text) -> Iterator[str]:
    for n, _line in t.coded("G54"):
        if t.dialect != "wincnc":
            yield from t.substituted(n, "G54", "G56")


@kind
def the_first_work_offset_for_a_spare_one(t: Text) -> Iterator[str]:
    for n, _line in t.coded("G59.3", "G55"):
        yield from t.substituted(n, r"G59\.3|G55", "G54")


@kind
def a_zero_of_another_kind(t: Text) -> Iterator[str]:
    other = {
        "wincnc": {"G92": "G92.2", "G92.2": "G92.1", "G92.1": "G92.2", "G92.3": "G92"},
        "eding": {"G92.1": "G92.3", "G92": "G10 L20 P2"},
    }.get(t.dialect, {})
    for n, line in t.each("frame"):
        found = re.search(r"G92(?:\.\d)?", line.code)
        if found and found[0] in other:
            yield t.replaced(n, line.raw.replace(found[0], other[found[0]], 1))


@kind
def a_zero_in_addition(t: Text) -> Iterator[str]:
    code = {"wincnc": "G92.2 X3", "mcuwin": "G92 X3"}.get(t.dialect, "G92 X3")
    for n, line in t.each("move"):
        if line.before["X"] is not None and line.before["X"] != 3.0 and not t.zero_again(n, "X"):
            yield t.before(n, code)


@kind
def a_zero_that_is_left_for_the_next_job(t: Text) -> Iterator[str]:
    ends = [n for n, line in t.each("end")]
    if t.dialect == "wincnc" and not t.called:
        yield "\n".join([*t.raw, "G92.2 X3", "L92"]) + "\n"
    elif ends:
        yield t.before(ends[-1], "G92 X3.5")


@kind
def a_zero_that_the_end_takes_away(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        if line.code.startswith("L92"):
            yield t.replaced(n)


@kind
def a_machine_place_for_one_of_the_work(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion == 0 and not line.relative and line.axes and not t.is_cut(n) and t.is_plain_before(n):
            words = " ".join(f"{a}{line.words[a]:g}" for a in line.axes)
            if t.dialect == "mcuwin":
                yield t.replaced(n, "G53", line.raw, "G54")
            else:
                yield t.replaced(n, f"G53 {words}" if t.dialect == "wincnc" else f"G53 G0 {words}")


@kind
def a_work_zero_in_the_numbers(t: Text) -> Iterator[str]:
    """The offset of the day of the translation, X100 Y80 Z-30, baked into a move."""
    zero = {"X": 100.0, "Y": 80.0, "Z": -30.0}
    for n, line in t.each("move"):
        if line.motion == 0 and not line.relative and line.axes and not t.is_cut(n):
            words = " ".join(f"{a}{line.words[a] + zero[a]:g}" for a in line.axes)
            if t.dialect == "mcuwin":
                yield t.replaced(n, "G53", f"G00 {words}", "G54")
            else:
                yield t.replaced(n, f"G53 {words}" if t.dialect == "wincnc" else f"G53 G0 {words}")


@kind
def a_place_of_the_work_for_one_of_the_machine(t: Text) -> Iterator[str]:
    for n, _line in t.each("machine"):
        yield from t.substituted(n, r"G53 (?:G0 )?", "G0 ")


@kind
def a_zero_that_is_not_brought_back(t: Text) -> Iterator[str]:
    for n, _ in t.coded("G154"):
        yield t.replaced(n)


@kind
def a_zero_that_is_not_kept(t: Text) -> Iterator[str]:
    for n, _ in t.coded("G153"):
        yield t.replaced(n)


# ---- structure


@kind
def the_wrong_branch(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        code = line.code
        if re.match(r"(?i)if ", code):
            old, new = next(pair for pair in (("== 1", "== 0"), ("== 0", "== 1"), ("<>", "==")) if pair[0] in code)
            yield from t.substituted(n, old, new)
        elif code.startswith("$if"):
            yield t.replaced(n, re.sub(r"\$if \((.*?)\) then", r"$if (not (\1)) then", line.raw))
        elif re.match(r"M1[78]\.1", code):
            yield t.replaced(n, ("M18" if code[2] == "7" else "M17") + line.raw[3:])


@kind
def a_choice_for_all(t: Text) -> Iterator[str]:
    """What is chosen is always done."""
    for n, line in enumerate(t.lines):
        if re.match(r"(?i)if ", line.code) or line.code.startswith("$if"):
            end = next(k for k in range(n, len(t.lines)) if re.match(r"(?i)endif|\$end", t.raw[k]))
            if not any(re.fullmatch(r"(?i)else", x.strip()) for x in t.raw[n:end]):
                yield "\n".join([*t.raw[:n], *t.raw[n + 1 : end], *t.raw[end + 1 :]]) + "\n"
        elif re.match(r"M1[78]\.[13]", line.code):
            yield t.replaced(n)


@kind
def a_choice_for_nobody(t: Text) -> Iterator[str]:
    """What is chosen is never done."""
    for n, line in enumerate(t.lines):
        if re.match(r"(?i)if ", line.code) or line.code.startswith("$if"):
            end = next(k for k in range(n, len(t.lines)) if re.match(r"(?i)endif|\$end", t.raw[k]))
            yield "\n".join([*t.raw[:n], *t.raw[end + 1 :]]) + "\n"


@kind
def the_input_of_a_choice(t: Text) -> Iterator[str]:
    for n, _line in enumerate(t.lines):
        yield from t.substituted(n, r"(?<=M56 P)(\d+)", r"1\1")
        yield from t.substituted(n, r"(?<=X\.digib\.)(\d+)", r"1\1")
        yield from t.substituted(n, r"(?<=M1[78]\.1C)(\d+)", r"1\1")


@kind
def another_line_is_skipped(t: Text) -> Iterator[str]:
    """A line that does nothing takes the place of the one that the choice is about."""
    for n, line in enumerate(t.lines[:-1]):
        if re.match(r"M1[78]\.[13]", line.code):
            yield t.replaced(n, line.raw, "G90")


@kind
def one_pass_more(t: Text) -> Iterator[str]:
    for n, _line in enumerate(t.lines):
        yield from _counts(t, n, 1)


@kind
def one_pass_less(t: Text) -> Iterator[str]:
    for n, _line in enumerate(t.lines):
        yield from _counts(t, n, -1)


def _counts(t: Text, n: int, by: int) -> Iterator[str]:
    for pattern in (r"(?i)(while \[#\d+ <= )(\d+)", r"(\$for .*? to )(\d+)", r"(M98 L\d+ O)(\d+)"):
        match = re.search(pattern, t.lines[n].raw)
        if match:
            yield t.replaced(n, t.raw[n][: match.start(2)] + str(int(match[2]) + by) + t.raw[n][match.end(2) :])


@kind
def a_loop_that_begins_late(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        match = re.match(r"(#\d+ = )(\d+)$", line.code.strip())
        if match:
            yield t.replaced(n, f"{match[1]}{int(match[2]) + 1}")
        if line.code.startswith("$for"):
            yield t.replaced(n, re.sub(r":=(\d+)", lambda m: f":={int(m[1]) + 1}", line.raw, count=1))


@kind
def a_step_of_a_loop(t: Text) -> Iterator[str]:
    for n, _ in enumerate(t.lines):
        yield from t.substituted(n, r"\+ 1\]", "+ 2]")


@kind
def a_call_that_is_lost(t: Text) -> Iterator[str]:
    for n, _ in t.each("call"):
        yield t.replaced(n)


@kind
def a_call_that_is_doubled(t: Text) -> Iterator[str]:
    """A call that moves; one that only names the present place again changes nothing."""
    for n, _ in t.each("call"):
        if not re.search(r"(?i)zero", t.raw[n]):
            yield t.before(n, t.raw[n])


@kind
def a_return_that_is_early(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        ends = line.code.strip() == "M17" or re.fullmatch(r"(?i)endsub", line.code.strip())
        if ends and t.lines[n - 1].kind in ("move", "frame"):
            yield t.exchanged(n - 1) if line.code.strip() == "M17" else t.replaced(n - 1)


@kind
def a_wait_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        if re.match(r"(?i)while \[#5399|\$while", line.code):
            end = next(k for k in range(n, len(t.lines)) if re.match(r"(?i)endwhile|\$end", t.raw[k]))
            yield "\n".join([*t.raw[:n], *t.raw[end + 1 :]]) + "\n"


@kind
def a_wait_for_the_other_state(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        if re.match(r"(?i)while \[#5399", line.code):
            yield from t.substituted(n, "== 0", "== 1")
        if line.code.startswith("$while not "):
            yield t.replaced(n, line.raw.replace("not ", "", 1))


@kind
def a_comment_that_becomes_words(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines):
        match = re.search(r"[XY]\d+", line.raw[len(line.code.rstrip()) :])
        if match and line.kind == "move":
            code = line.code.rstrip()
            yield t.replaced(n, *([code, match[0]] if match[0][0] in line.words else [f"{code} {match[0]}"]))
