"""Findings that differ in numbers only, reported once: ``and 312 more like this``, from where to where, and the worst.

Text reports take them from ``Findings``, reports for other programs from the JSON report, which has the same figures.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from gproof.ir.finding import Finding, Findings, Group, group_key, key_of, measure, pattern
from gproof.ir.record import record
from gproof.report.units import MM, LengthUnit

ALONE = 3
"""So many findings of a kind are shown one by one."""
FIRST_KEYS = 6
"""So many keys that are not known are named in one line."""
NAMED = 8
"""So many lines are named one by one."""
Accepted = Mapping[Finding, tuple[str, str]]
"""How findings were accepted, and why: see ``cli.accept``."""


@record(frozen=True, slots=True, kw_only=True)
class More:
    """What else there is of a kind: how many, where, and the worst of all.

    line, last_line: all are between them (0: not known); lines: the others', () when not all are known; worst_line: 0
    where it is not known which it is; worst: its message, "" when it is the one shown; keys: the first of the others
    that are named, where they are keys.
    """

    count: int
    line: int
    last_line: int
    lines: tuple[int, ...] = ()
    worst_line: int = 0
    worst: str = ""
    keys: tuple[str, ...] = ()

    def text(self) -> str:
        """``and 312 more like this in lines 5 ... 403; the worst in line 403: …``."""
        where = f" in lines {self.line} ... {self.last_line}" if self.last_line > self.line > 0 else ""
        if where and self.lines and len(self.lines) <= NAMED:
            where = f" in line{'s' if len(self.lines) > 1 else ''} {', '.join(map(str, self.lines))}"
        furthest = ""
        if self.worst_line:
            furthest = f"; the worst in line {self.worst_line}: {self.worst}" if self.worst else "; none is worse"
        keys = f": {', '.join(self.keys)}{' ...' if self.count > len(self.keys) else ''}" if self.keys else ""
        return f"and {self.count} more like this{where}{furthest}{keys}"


@record(frozen=True, slots=True, kw_only=True)
class Shown:
    """A finding that is shown, how often it came at its place, and what it stands for besides."""

    finding: Finding
    times: int
    more: More | None = None


def shown(
    findings: Findings, by_place: Iterable[Finding], accepted: Accepted, say: Callable[[Finding], str], *, every: bool
) -> list[Shown]:  # fmt: skip
    """The kept findings in the given order, those of one kind once; every: each of them.

    say: the message of a finding in the unit of the report.
    """
    ordered = list(by_place)
    if every:
        return [Shown(finding=f, times=findings.times[f]) for f in ordered]
    kinds: dict[object, list[Finding]] = {}
    keys = [(group_key(finding), accepted.get(finding)) for finding in ordered]
    for finding, kind in zip(ordered, keys, strict=True):
        kinds.setdefault(kind, []).append(finding)
    partly = {group_key(finding) for finding in accepted}
    counts: dict[object, tuple[int, int]] = {}
    """Of each kind: how often the kept ones came, and all of them."""
    out = []
    for finding, kind in zip(ordered, keys, strict=True):
        key, is_accepted = kind
        members = kinds[kind]
        group = findings.groups.get(key)
        if kind not in counts:
            own = sum(findings.times[f] for f in members)
            open_ones = group is not None and is_accepted is None
            counts[kind] = own, _left(findings, group, key, accepted, own, partly) if group and open_ones else own
        own, total = counts[kind]
        if len(members) <= ALONE and total <= own:
            out.append(Shown(finding=finding, times=findings.times[finding]))
        elif finding is members[0]:
            whole = group if group is not None and key not in partly else None
            rest = [f.span.line for f in members[1:]] if total <= own else []
            more = _more(total - findings.times[finding], members, rest, whole, say)
            out.append(Shown(finding=finding, times=findings.times[finding], more=more))
    return out


def _left(
    findings: Findings, group: Group, key: object, accepted: Accepted, own: int, partly: Iterable[object]
) -> int:  # fmt: skip
    """How many of a group nobody accepted."""
    if key not in partly:
        return max(group.times, own)
    return max(own, group.times - sum(findings.times[f] for f in accepted if group_key(f) == key))


def _more(
    count: int, members: list[Finding], rest: list[int], group: Group | None, say: Callable[[Finding], str]
) -> More:
    first = members[0]
    if group is not None:
        line, last, worst = group.line, group.last_line, group.worst
    else:
        line, last = min(f.span.line for f in members), max(f.span.line for f in members)
        measured = [(most, f) for f in members if (most := measure(f)) is not None]
        worst = max(measured, key=lambda pair: pair[0])[1] if measured else None
    same = worst is None or worst.message == first.message
    return More(
        count=count, line=line, last_line=last, lines=_others(first.span.line, rest),
        worst_line=0 if worst is None else worst.span.line or first.span.line,
        worst="" if worst is None or same else say(worst), keys=_keys(f.message for f in members[1:]),
    )  # fmt: skip


def _keys(messages: Iterable[str]) -> tuple[str, ...]:
    """The first keys that messages name."""
    return tuple(itertools.islice(filter(None, map(key_of, messages)), FIRST_KEYS))


def _others(first: int, lines: Iterable[int]) -> tuple[int, ...]:
    """Lines other than the first, each once."""
    return tuple(sorted(set(lines) - {first, 0}))


def left_over(findings: Findings, listed: Iterable[Shown]) -> dict[int, int]:
    """By code, how many findings none of those listed stands for."""
    told: dict[int, int] = {}
    for one in listed:
        number = one.finding.code.number
        told[number] = told.get(number, 0) + one.times + (one.more.count if one.more is not None else 0)
    rest = {number: count - told.get(number, 0) for number, count in findings.counts.items()}
    return {number: count for number, count in sorted(rest.items()) if count > 0}


def groups_json(findings: Findings, unit: LengthUnit = MM) -> list[dict[str, Any]]:
    """The kinds that came more than once, as docs/check-json.md defines them; unit: of the texts."""
    out = []
    for group in sorted(findings.groups.values(), key=lambda g: (g.file, g.line, g.code.number, g.pattern)):
        if group.times < 2:
            continue
        entry: dict[str, Any] = {
            "code": group.code.label, "name": group.code.name, "file": group.file,
            "pattern": group.pattern.replace("# mm", f"# {unit.name}"), "times": group.times,
            "line": group.line, "last_line": group.last_line,
        }  # fmt: skip
        if group.worst is not None:
            entry["worst"] = {"line": group.worst.span.line, "message": unit.message(group.worst)}
        out.append(entry)
    return out


def shown_json(report: Mapping[str, Any], *, every: bool) -> list[tuple[dict[str, Any], More | None]]:
    """The findings of a report that nobody accepted, those of one kind once, with what each stands for."""
    found = [f for f in report["findings"] if "suppressed" not in f]
    if every:
        return [(f, None) for f in found]
    groups = {(g["code"], g["file"], g["pattern"]): g for g in report.get("groups", ())}
    partly = {_key(f) for f in report["findings"] if "suppressed" in f}
    kinds: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    for f in found:
        kinds.setdefault(_key(f), []).append(f)
    out: list[tuple[dict[str, Any], More | None]] = []
    for f in found:
        key = _key(f)
        members = kinds[key]
        group = groups.get(key) if key not in partly else None
        own = sum(one["times"] for one in members)
        total = own if group is None else max(own, int(group["times"]))
        if len(members) <= ALONE and total <= own:
            out.append((f, None))
        elif f is members[0]:
            lines = [one["line"] for one in members]
            line, last = (min(lines), max(lines)) if group is None else (group["line"], group["last_line"])
            worst = None if group is None else group.get("worst")
            more = More(
                count=total - f["times"], line=line, last_line=last,
                lines=_others(f["line"], lines if total <= own else ()),
                worst_line=0 if worst is None else worst["line"] or line,
                worst="" if worst is None or worst["message"] == f["message"] else worst["message"],
                keys=_keys(one["message"] for one in members[1:]),
            )  # fmt: skip
            out.append((f, more))
    return out


def _key(finding: Mapping[str, Any]) -> tuple[str, str, str]:
    return finding["code"], finding["file"], pattern(finding["message"])
