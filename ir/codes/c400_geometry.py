"""Finding codes 4xx: geometry."""

from __future__ import annotations

from gproof.ir.codes.declared import code, saying
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

ARC_RADIUS_MISMATCH = code(
    401,
    "arc-radius-mismatch",
    _E,
    "radius {start:.4f} {unit} at the start, {end:.4f} {unit} at the end: {off:.4f} {unit} apart, at most "
    "{allowed:g} {unit} allowed",
    "arcs",
)
ARC_RADIUS_ZERO = code(402, "arc-radius-zero", _E, "the arc has no radius", "arcs")
ARC_UNREACHABLE = code(
    403,
    "arc-unreachable",
    _E,
    "the end point is {chord:.4f} {unit} away: an arc of radius {radius:.4f} {unit} cannot reach it",
    "arcs",
)
ARC_SAME_POINT = code(
    404, "arc-same-point", _E, "an arc with a radius (R) must end at another point than its start", "arcs"
)
ARC_UNKNOWN = code(405, "arc-unknown", _U, "the arc depends on {cause}", "arcs")
ARC_ILL_CONDITIONED = code(
    406,
    "arc-ill-conditioned",
    _W,
    "radius arc of {degrees:.2f} degrees: rounding to {digits} decimals moves its centre by up to {off:.3f} {unit}, "
    "{factor:.0f} times as much",
    "arcs",
)
ARC_UNDER_MINIMUM = code(
    407,
    "arc-under-minimum",
    _N,
    "radius {radius:.4f} {unit} is below the smallest arc radius of {allowed:g} {unit}: the controller cuts a "
    "straight line",
    "arcs",
)
ARC_CLOSES = code(
    408,
    "arc-nearly-closes",
    _W,
    "the arc ends {chord:.4f} {unit} from its start, after {degrees:.4f} degrees; rounded otherwise it would be "
    "{other:.4f} degrees",
    "arcs",
)
ARC_HUGE = code(
    409,
    "arc-huge-radius",
    _W,
    "radius {radius:.0f} {unit}: over {chord:.3f} {unit} this is a straight line, within {off:.2g} {unit}",
    "arcs",
)
CONCAVE_CORNER = code(
    410,
    "concave-corner",
    _E,
    "a tool of radius {radius:.3f} mm does not fit into this corner of {degrees:.2f} degrees",
)
CUTTER_GOUGING = code(
    411,
    "cutter-gouging",
    _E,
    "compensation starts {distance:.3f} mm from the programmed point, within the tool radius of {radius:.3f} mm",
)
ARC_TOO_SMALL_FOR_TOOL = code(
    412,
    "arc-too-small-for-tool",
    _E,
    "a tool of radius {radius:.3f} mm does not fit into an arc of radius {arc:.3f} mm",
)
ENTRY_ARC = code(
    413,
    "entry-arc",
    _E,
    "compensation cannot start with this arc: the tool is at {distance:.3f} mm, and the arc needs {needed:.3f} mm",
)
ARC_SCALED = code(415, "arc-scaled", _E, "arc while {axes} is scaled ({code})", "arcs")
HELIX_NOT_SUPPORTED = code(
    416, "helix-not-supported", _E, "{axes} would move during an arc, which this machine cannot do", "arcs"
)
ARC_MAPPED = code(417, "arc-mapped", _E, "arc while axis words are remapped ({code})", "arcs")
ARC_LEANING_KNIFE = code(
    419, "arc-with-leaning-knife", _E, "arc with a tilted blade, which cuts straight lines only", "arcs"
)
ARC_FULL_CIRCLE = code(
    418,
    "arc-full-circle",
    _W,
    "X and Y end the arc at its start point: assumed to be a full circle; without X and Y it certainly is one",
    "arcs",
)
OPEN_MESH = code(432, "open-mesh", _W, "{name} is not closed ({what}): what is inside it is unknown", "files")
TRAVERSE_IN_STOCK = code(
    435, "traverse-in-stock", _E, "rapid move through remaining stock, {depth:.3f} mm deep", "collisions"
)
TRAVERSE_NEAR_STOCK = code(
    436,
    "traverse-near-stock",
    _U,
    "a rapid move may enter remaining stock, by up to {depth:.3f} mm with the required clearance",
    "collisions",
)
DEEPER_THAN_FLUTES = code(
    437, "deeper-than-flutes", _E, "tool {tool} cuts {over:.3f} mm deeper than {limit}", "collisions"
)
DEEPER_THAN_ALLOWED = code(
    438, "deeper-than-allowed", _E, "tool {tool} cuts {over:.3f} mm deeper than {limit}", "collisions"
)
DEPTH_OPEN = code(439, "depth-open", _U, "tool {tool} may cut up to {over:.3f} mm deeper than {limit}", "collisions")
HOLDER_IN_STOCK = code(
    441,
    "holder-in-stock",
    _E,
    "{part} of tool {tool} hits remaining stock by {depth:.3f} mm",
    "collisions",
)
HOLDER_NEAR_STOCK = code(
    442,
    "holder-near-stock",
    _U,
    "{part} of tool {tool} may hit remaining stock, by up to {depth:.3f} mm",
    "collisions",
)
STOCK_UNKNOWN = code(443, "stock-unknown", _U, "the remaining stock is unknown from here on: {cause}", "collisions")
_AT = " at X{x:.3f} Y{y:.3f} Z{z:.3f}"
_HITS = "tool {tool} ({part}) hits {name} by {depth:.3f} mm" + _AT + " ({allowed})"
_NEARS = "tool {tool} ({part}) comes within {distance:.3f} mm of {name}" + _AT + " ({allowed})"
_INSIDE = "tool {tool} ({part}) is already inside {name} where this move starts," + _AT
_MAY_HIT = "tool {tool} ({part}) may hit {name}: its path is {depth:.3f} mm inside" + _AT + " ({allowed}); {doubt}"
_MAY_NEAR = "tool {tool} ({part}) may hit {name}: its path is {distance:.3f} mm away" + _AT + " ({allowed}); {doubt}"
GOUGE = code(420, "gouge", _E, _HITS, "gouges")
GOUGE_NEAR = saying(GOUGE, _NEARS)
GOUGE_INSIDE = saying(GOUGE, _INSIDE)
COLLISION = code(421, "collision", _E, _HITS, "collisions")
COLLISION_NEAR = saying(COLLISION, _NEARS)
COLLISION_INSIDE = saying(COLLISION, _INSIDE)
HOLDER_IN_PART = code(422, "shank-or-holder-in-part", _E, _HITS, "collisions")
HOLDER_NEAR_PART = saying(HOLDER_IN_PART, _NEARS)
GOUGE_POSSIBLE = code(423, "gouge-possible", _U, _MAY_HIT, "gouges")
GOUGE_POSSIBLE_NEAR = saying(GOUGE_POSSIBLE, _MAY_NEAR)
COLLISION_POSSIBLE = code(424, "collision-possible", _U, _MAY_HIT, "collisions")
COLLISION_POSSIBLE_NEAR = saying(COLLISION_POSSIBLE, _MAY_NEAR)
GOUGE_UNKNOWN = code(425, "gouge-unknown", _U, "gouges cannot be checked: {cause}", "gouges")
COLLISION_UNKNOWN = code(426, "collision-unknown", _U, "collisions cannot be checked: {cause}", "collisions")
