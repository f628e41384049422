"""Every key of gproof's own files, by schema and table: what is read as one, and what a misspelt one may mean.

The readers decide what a key means; this table says which keys there are, so that a key in the wrong table is found in
the right one, and so that each mistake of a file is reported even where reading stops early.
``tests/frontend/files/test_own_keys.py`` holds the readers and this table to one another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from gproof.ir.record import field, record

LISTED = 24
"""Keys of a table that a hint names at most."""
_NEAR, _ELSEWHERE = 0.6, 0.8
"""How much two words have to be alike, in one table and in different ones."""
_OTHER_FILES = {
    "gproof-machine/1": "a machine file (--machine)",
    "gproof-setup/1": "a setup file (--setup)",
    "gproof-policy/1": "a policy (--policy)",
    "gproof-job/1": "a job file",
    "gproof-translation/1": "the map of a translation (--map)",
}


@record(frozen=True, slots=True, kw_only=True)
class Keys:
    """The keys of a table.

    own: with plain values; tables: that are tables or lists of tables; named: every other key is a name (of a tool, an
    axis, a layer), and what is under it has these keys.
    """

    own: frozenset[str] = frozenset()
    tables: Mapping[str, Keys] = field(default_factory=dict)
    named: Keys | None = None

    def knows(self, key: str) -> bool:
        """Whether there is such a key."""
        return key in self.own or key in self.tables or self.named is not None

    def inner(self, key: str) -> Keys | None:
        """The keys of the table under a key; None: not known."""
        return self.tables.get(key, self.named)

    def spelt(self, key: str) -> str:
        """A key as the readers call it: ``-`` is ``_``, names stay as they are."""
        plain = key.replace("-", "_")
        return plain if self.named is None or plain in self.own or plain in self.tables else key


def _keys(own: str = "", named: Keys | None = None, **tables: Keys) -> Keys:
    return Keys(own=frozenset(own.split()), tables=tables, named=named)


_PLAIN = _keys()
_AXES = "x y z a b c u v w"
_SLAVE = _keys(
    "joint steps_per_unit min max travel_min travel_max max_velocity max_acceleration backlash pitch home_position"
    " home_velocity"
)
_AXIS = _keys(
    "kind steps_per_unit min max travel_min travel_max max_velocity max_acceleration backlash slaves pitch"
    " home_position home_velocity tip_feed letter vertical boundary_min boundary_max feed_velocity home_place"
    " position_unit",
    slaves=_SLAVE,
)
_ZONE = _keys("name x y z polygon holes work")
_BODY = _keys(
    "name units work rotate shift box polygon dxf stl bottom top holes join",
    cylinder=_keys("x y diameter bottom top"),
    pockets=_keys("polygon holes floor"),
    layers=_keys(named=_keys("bottom top floor")),
)
_JOB = "job machine setup dialect policy also strict"

KEYS: dict[str, Keys] = {
    "gproof-machine/1": _keys(
        "schema name units base kinematics z_down_tool_length spindle",
        axes=_keys(named=_AXIS),
        areas=_keys(named=_keys("x y z")),
        keep_out=_ZONE,
        tool_change=_keys("clear_z at_start"),
        tools=_keys(
            named=_keys(
                "length diameter x_offset orientation min_rpm max_rpm max_feed max_plunge max_depth shape corner_radius"
                " tip_angle tip_diameter flute_length shank_diameter stickout holder"
            )
        ),
        spindles=_keys(named=_keys("x y z min_rpm max_rpm ramp_time spin_up output oriented_stop")),
        knife=_keys("axis angle lift blend_angle blend_distance"),
        controller=_keys(
            "dialect laf_angle interpolation_time fifo_time max_step_frequency auto_tool_change absolute_arc_centers"
            " xz_seen_from diameter_programming extruder spindle_ramp_time macro_file super_long_file homing_mandatory"
            " safety_feed home_is_stop turning thread_peak straight_traverse version accepts limits_hold"
        ),
        controls=_keys(
            "highest_channel around_files array_order absolute soft_limits limits_available adjust_boundary"
            " adjust_vertical arcs_modal helical_arcs arcs_share_feed arc_tolerance smallest_arc shift_sign"
            " rotation_sign virtual_on knife_positions nesting start end abort coolant inputs outputs devices"
            " feed_groups command_group"
        ),
        board=_keys(
            "name tick_frequency step_pulse direction_setup port baud probe",
            motors=_keys(named=_keys("step direction enable limit")),
            outputs=_keys(named=_keys("pin idle speed")),
        ),
        din=_keys(
            "version case_sensitive line_numbers position_unit time_unit wait_unit persistence absolute_centers"
            " interpolation_axes g60 zero_offsets angle_unit arc_tolerance program_size pre_include post_include"
            " tool_unit tool_file shortest_path channels error_compensation",
            task0=_keys(named=_keys("does breaks parameters")),
        ),
    ),
    "gproof-setup/1": _keys(
        "schema name units homed active_work tool tool_length block_delete optional_stop answers",
        start=_keys(_AXES),
        work=_keys(named=_keys(_AXES)),
        g92=_keys(_AXES),
        tools=_keys(named=_keys("length")),
        parameters=_keys(named=_PLAIN),
        resident=_keys(named=_PLAIN),
        heads=_keys(named=_keys("x y z")),
        height_map=_keys("on file x y size heights"),
        cylinder=_keys("radius y z zero"),
        transform=_keys("angle factor factor_x factor_y x y"),
        keep_out=_ZONE,
        workpiece=_keys("tolerance clearance cell"),
        stock=_BODY,
        part=_BODY,
        fixtures=_BODY,
        positions=_keys(named=_keys(f"{_AXES} lift clearance")),
        inputs=_keys(named=_PLAIN),
        outputs=_keys(named=_PLAIN),
        virtual_inputs=_keys(named=_PLAIN),
        measures=_keys(_AXES),
        contacts=_keys(_AXES),
    ),
    "gproof-policy/1": _keys("schema properties fail_on warnings_are_errors strict", severity=_keys(named=_PLAIN)),
    "gproof-job/1": _keys(f"schema {_JOB}", jobs=_keys(_JOB)),
    "gproof-translation/1": _keys(
        "schema tool_change",
        outputs=_keys(named=_PLAIN),
        inputs=_keys(named=_PLAIN),
        tools=_keys(named=_PLAIN),
        offsets=_keys(named=_PLAIN),
        coolant=_keys("mist flood"),
        style=_keys("decimals_mm decimals_inch decimals_deg decimals numbers indent extension newline header footer"),
    ),
    "gproof-baseline/1": _keys("schema", files=_keys(named=_keys("fingerprint code message"))),
}
"""By schema the keys of the whole file."""


def unknown_keys(
    values: Mapping[str, object], keys: Keys, taken: Mapping[tuple[str, ...], set[str]], path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], str, Keys]]:
    """Keys that neither the table nor a reader knows: the path of their table as written, the key, the keys there.

    taken: what readers read, by the path of a table (``nth`` names those of lists).
    """
    for key, value in values.items():
        name = keys.spelt(key)
        if not keys.knows(name) and name not in taken.get(path, ()):
            yield path, key, keys
            continue
        inner = keys.inner(name)
        if inner is None:
            continue
        if isinstance(value, dict):
            yield from unknown_keys(value, inner, taken, (*path, key))
        elif isinstance(value, list):
            for number, one in enumerate(value, 1):
                if isinstance(one, dict):
                    yield from unknown_keys(one, inner, taken, (*path, nth(key, number)))


def suggestion(word: str, schema: str, here: Iterable[str], given: Iterable[str]) -> str:
    """What an unknown key of a file may mean: ``did you mean 'min'?``, a table that has it, else the keys there are.

    here: the keys of its table; given: those that are there already.
    """
    known, there, low = sorted(set(here)), set(given), word.lower().replace("-", "_")
    near = [key for key in known if key == low or _one_apart(low, key)]
    far = [] if low in near else [f"{low!r} of {place}" for place in _places(schema, low)]
    near = near or ([] if far else _near(low, known, _NEAR))
    found = [f"{key!r}, which is there too" if key in there else repr(key) for key in near] + far
    if not found:
        found = [
            f"{key!r} of {place}" for key in _near(low, _every(schema), _ELSEWHERE) for place in _places(schema, key)
        ]
    if not found:
        others = [other for other in _OTHER_FILES if other != schema]
        found = [f"{low!r} of {_OTHER_FILES[other]}" for other in others if low in set(_every(other))]
    if found:
        return f"did you mean {', or '.join(dict.fromkeys(found[:3]))}?"
    more = f" and {len(known) - LISTED} more" if len(known) > LISTED else ""
    return f"use one of these keys: {', '.join(known[:LISTED])}{more}" if known else ""


def _near(word: str, known: Iterable[str], how: float) -> list[str]:
    from difflib import get_close_matches

    return get_close_matches(word, sorted(set(known)), 2, how)


def _one_apart(a: str, b: str) -> bool:
    """Whether one letter more, less or other, or two that are swapped, is all the difference, of words with some."""
    if min(len(a), len(b)) < 2 or abs(len(a) - len(b)) > 1 or a == b:
        return False
    begin = next((n for n, (one, other) in enumerate(zip(a, b, strict=False)) if one != other), min(len(a), len(b)))
    rest, other = a[begin:], b[begin:]
    swapped = len(rest) > 1 and len(other) > 1 and rest[:2] == other[1::-1] and rest[2:] == other[2:]
    return swapped or rest[1:] == other[1:] or rest[1:] == other or rest == other[1:]


def _walk(keys: Keys, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Keys]]:
    """Every table of a file, named ones as ``*``."""
    yield path, keys
    for name, inner in keys.tables.items():
        yield from _walk(inner, (*path, name))
    if keys.named is not None:
        yield from _walk(keys.named, (*path, "*"))


def _every(schema: str) -> Iterator[str]:
    for _, keys in _walk(KEYS[schema]):
        yield from (key for key in (*keys.own, *keys.tables) if len(key) > 1)


def _places(schema: str, key: str) -> list[str]:
    """The tables of a file that have a key; none for a key of one letter, which many have."""
    if len(key) < 2:
        return []
    found = [path for path, keys in _walk(KEYS[schema]) if key in keys.own or key in keys.tables]
    return [f"[{'.'.join(path)}]" if path else "the top of the file" for path in found]


def nth(name: str, number: int) -> str:
    """How messages name a table of a list, ``[[name]]``."""
    return name if number < 2 else f"{name}[{number}]"


def key_paths(values: Mapping[str, object], path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Every key of a TOML file, with the tables that it is in; ``-`` counts as ``_``."""
    for key, value in values.items():
        here = (*path, key.replace("-", "_"))
        if isinstance(value, Mapping):
            yield from key_paths(value, here)
        else:
            yield here
