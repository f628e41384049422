"""Finding codes 4xx: geometry."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

ARC_RADIUS_MISMATCH = code(
    401,
    "arc-radius-mismatch",
    _E,
    "radius {start:.6f} at the start, {end:.6f} at the end: {off:.6f} {unit} apart, {allowed:g} allowed",
    "arcs",
)
ARC_RADIUS_ZERO = code(402, "arc-radius-zero", _E, "the arc has no radius", "arcs")
ARC_UNREACHABLE = code(
    403,
    "arc-unreachable",
    _E,
    "the end is {chord:.6f} {unit} away; an arc of radius {radius:.6f} can not reach it",
    "arcs",
)
ARC_SAME_POINT = code(
    404, "arc-same-point", _E, "an arc given by its radius must end somewhere else than it starts", "arcs"
)
ARC_UNKNOWN = code(405, "arc-unknown", _U, "the arc depends on {cause}", "arcs")
ARC_ILL_CONDITIONED = code(
    406,
    "arc-ill-conditioned",
    _W,
    "a radius arc of {degrees:.2f} degrees: rounding to {digits} decimals moves its centre by up to {off:.4f} {unit}, "
    "{factor:.0f} times as much",
    "arcs",
)
ARC_UNDER_MINIMUM = code(
    407,
    "arc-under-minimum",
    _N,
    "radius {radius:.6f} {unit} is under the smallest one for an arc, {allowed:g}: the controller cuts a straight line",
    "arcs",
)
ARC_CLOSES = code(
    408,
    "arc-nearly-closes",
    _W,
    "the arc ends {chord:.6f} {unit} from where it begins, after {degrees:.4f} degrees; rounded otherwise it would be "
    "{other:.4f}",
    "arcs",
)
ARC_HUGE = code(
    409,
    "arc-huge-radius",
    _W,
    "a radius of {radius:.0f} {unit}: over {chord:.4f} {unit} that is a line, within {off:.2g} {unit}",
    "arcs",
)
CONCAVE_CORNER = code(
    410,
    "concave-corner",
    _E,
    "a corner of {degrees:.2f} degrees towards a tool of radius {radius:.4f} mm, which does not fit into it",
)
CUTTER_GOUGING = code(
    411,
    "cutter-gouging",
    _E,
    "compensation begins {distance:.4f} mm from the programmed point, within the tool's radius of {radius:.4f} mm",
)
ARC_TOO_SMALL_FOR_TOOL = code(
    412,
    "arc-too-small-for-tool",
    _E,
    "a tool of radius {radius:.4f} mm does not fit into an arc of radius {arc:.4f} mm",
)
ENTRY_ARC = code(
    413,
    "entry-arc",
    _E,
    "compensation can not begin with this arc: the tool is at {distance:.4f} mm, and the arc asks for {needed:.4f} mm",
)
ARC_SCALED = code(415, "arc-scaled", _E, "an arc while {axes} is scaled ({code})", "arcs")
HELIX_NOT_SUPPORTED = code(
    416, "helix-not-supported", _E, "{axes} would move during an arc, which this machine does not do", "arcs"
)
ARC_MAPPED = code(417, "arc-mapped", _E, "an arc while the words of the axes are re-mapped ({code})", "arcs")
ARC_LEANING_KNIFE = code(
    419, "arc-with-leaning-knife", _E, "an arc with a blade that leans, which cuts only lines", "arcs"
)
ARC_FULL_CIRCLE = code(
    418,
    "arc-full-circle",
    _W,
    "X and Y end the arc where it begins: taken for a full circle; without X and Y it surely is one",
    "arcs",
)
OPEN_MESH = code(432, "open-mesh", _W, "{name} is not closed ({what}): what is inside of it is not known", "files")
TRAVERSE_IN_STOCK = code(
    435, "traverse-in-stock", _E, "a traverse enters stock that is still there, {depth:.4f} mm deep", "collisions"
)
TRAVERSE_NEAR_STOCK = code(
    436,
    "traverse-near-stock",
    _U,
    "a traverse may enter stock that is still there, by up to {depth:.4f} mm with the clearance that is asked for",
    "collisions",
)
DEEPER_THAN_FLUTES = code(
    437, "deeper-than-flutes", _E, "tool {tool} cuts {over:.4f} mm deeper than {limit}", "collisions"
)
DEEPER_THAN_ALLOWED = code(
    438, "deeper-than-allowed", _E, "tool {tool} cuts {over:.4f} mm deeper than {limit}", "collisions"
)
DEPTH_OPEN = code(439, "depth-open", _U, "tool {tool} may cut up to {over:.4f} mm deeper than {limit}", "collisions")
HOLDER_IN_STOCK = code(
    441,
    "holder-in-stock",
    _E,
    "{part} of tool {tool} enters stock that is still there, by {depth:.4f} mm",
    "collisions",
)
HOLDER_NEAR_STOCK = code(
    442,
    "holder-near-stock",
    _U,
    "{part} of tool {tool} may enter stock that is still there, by up to {depth:.4f} mm",
    "collisions",
)
STOCK_UNKNOWN = code(
    443, "stock-unknown", _U, "what is left of the stock is not known from here on: {cause}", "collisions"
)
GOUGE = code(420, "gouge", _E, "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}", "gouges")
COLLISION = code(421, "collision", _E, "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}", "collisions")
HOLDER_IN_PART = code(422, "shank-or-holder-in-part", _E, "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}", "collisions")
GOUGE_POSSIBLE = code(
    423,
    "gouge-possible",
    _U,
    "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}: {doubt}",
    "gouges",
)
COLLISION_POSSIBLE = code(
    424,
    "collision-possible",
    _U,
    "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}: {doubt}",
    "collisions",
)
GOUGE_UNKNOWN = code(425, "gouge-unknown", _U, "{cause}", "gouges")
COLLISION_UNKNOWN = code(426, "collision-unknown", _U, "{cause}", "collisions")
