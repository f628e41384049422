"""Distances between tools and triangles found another way: geometry of sections and a search that zooms in."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import Tool
from gproof.passes.checks.tooling.tool_shape import UNSTATED, Piece, shape_of

Floats = npt.NDArray[np.float64]


def signed_distance(piece: Piece, points: Floats) -> Floats:
    """(n,) of (n, 3) points to the surface of a piece, less than 0 inside: by its section, a polygon and a radius."""
    rho, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
    ring = [(0.0, piece.rims[0][1]), *piece.rims, (0.0, piece.rims[-1][1])]
    away, inside = np.full(rho.shape, np.inf), np.full(rho.shape, any(r > 0.0 for r, _ in piece.rims))
    for (r0, z0), (r1, z1) in itertools.pairwise(ring):
        across, up = r1 - r0, z1 - z0
        square = across * across + up * up
        if square == 0.0:
            continue
        t = np.clip(((rho - r0) * across + (z - z0) * up) / square, 0.0, 1.0)
        away = np.minimum(away, np.hypot(rho - r0 - t * across, z - z0 - t * up))
        inside &= across * (z - z0) >= up * (rho - r0)
    return np.where(inside, -away, away) - piece.rounding


def least_distance(piece: Piece, triangle: Floats, tip: Floats, way: Floats, *, boxed: bool = False) -> float:
    """The least signed distance of a triangle's points to a piece that moves: never too small, and nearly exact.

    boxed: the piece may be anywhere in the box of the way.
    """
    free = 5 if boxed else 3
    middle, half, best = np.full(free, 0.5), 0.5, math.inf
    for _ in range(26):
        offsets = np.linspace(-1.0, 1.0, 5 if boxed else 7) * half
        a, b, *shares = np.meshgrid(*(np.clip(m + offsets, 0.0, 1.0) for m in middle), indexing="ij")
        over = np.maximum(a + b, 1.0)
        a, b = a / over, b / over
        along = triangle[0] + a[..., None] * (triangle[1] - triangle[0]) + b[..., None] * (triangle[2] - triangle[0])
        share = np.stack(shares, axis=-1) if boxed else shares[0][..., None]
        found = signed_distance(piece, along - tip - share * way)
        k = int(np.argmin(found))
        if found.flat[k] <= best:
            best = float(found.flat[k])
            middle = np.array([a.flat[k], b.flat[k], *(t.flat[k] for t in shares)])
        half *= 0.65
    return best


def random_tool(rng: np.random.Generator) -> Tool:
    """A tool of any shape, with shank and holder."""
    shape = ("flat", "ball", "bull", "vee", "drill")[int(rng.integers(5))]
    diameter = float(rng.uniform(0.5, 20.0))
    flute = float(rng.uniform(0.7, 3.0)) * diameter + 1.0
    stickout = flute + float(rng.uniform(1.0, 30.0))
    return Tool(
        number=1, shape=shape, diameter=diameter, flute_length=flute, stickout=stickout,
        corner_radius=float(rng.uniform(0.05, 0.5)) * diameter, tip_angle=float(rng.uniform(15.0, 150.0)),
        tip_diameter=float(rng.choice([0.0, 0.1 * diameter])), shank_diameter=float(rng.uniform(0.5, 20.0)),
        holder=((float(rng.uniform(5.0, 60.0)), float(rng.uniform(5.0, 60.0)), 20.0), (40.0, 40.0, 10.0)),
    )  # fmt: skip


def random_piece(rng: np.random.Generator) -> Piece:
    """Of a random tool, the cutter every other time."""
    pieces = [piece for piece in shape_of(random_tool(rng)).pieces if piece.part != UNSTATED]
    return pieces[0] if rng.random() < 0.5 else pieces[int(rng.integers(len(pieces)))]


class Case(NamedTuple):
    """A piece, a triangle, a move of the piece, their least signed distance, and what to allow."""

    piece: Piece
    triangle: Floats
    tip: Floats
    way: Floats
    boxed: int
    least: float
    limit: float


def random_case(rng: np.random.Generator) -> Case:
    """Large and small, flat, thin and degenerate ones; the limit close to the distance, on either side."""
    piece = random_piece(rng)
    triangle = rng.normal(size=(3, 3)) * rng.choice([0.3, 3.0, 30.0, 300.0]) + rng.normal(size=3) * 10.0
    if rng.random() < 0.2:
        triangle[:, 2] = triangle[0, 2]
    if rng.random() < 0.1:
        triangle[2] = triangle[0]
    if rng.random() < 0.1:
        triangle[2, :2] = triangle[0, :2]
    tip, way = rng.normal(size=3) * 10.0, rng.normal(size=3) * rng.choice([0.0, 0.5, 20.0, 200.0])
    if rng.random() < 0.3:
        way[2] = 0.0
    elif rng.random() < 0.2:
        way[:2] = 0.0
    boxed = int(rng.random() < 0.15)
    least = least_distance(piece, triangle, tip, way, boxed=boxed == 1)
    limit = least + float(rng.choice([-1.0, 1.0])) * float(rng.choice([3e-6, 1e-3, 0.1, 1.0]))
    return Case(piece, triangle, tip, way, boxed, least, limit)


GAP = 1e-6


def wrong(case: Case, separation: Any, grown: Any) -> str:
    """What is wrong with the answer for a case, nothing where it is right or open."""
    body = grown(case.piece, case.limit - GAP)
    if body is None:
        return ""
    rims = np.zeros((3, 2))
    rims[: len(body[0])] = body[0]
    corners = np.concatenate([case.triangle, case.triangle[2:]]).reshape(1, 12)
    witness = np.zeros(7)
    answer = separation(
        corners, 0, 0.0, case.tip, case.way, rims, len(body[0]), body[1], GAP, case.boxed, np.zeros((4, 9)),
        np.zeros(4), np.zeros(4), witness,
    )  # fmt: skip
    if answer == -1 and case.least < case.limit - 1.5 * GAP:
        return f"said to be clear of {case.limit}, and is {case.least}"
    if answer == 0:
        return "open"
    if answer == 1:
        way, point = witness[:3], witness[3:6]
        edges = (case.triangle[1:] - case.triangle[0]).T
        weights = np.linalg.lstsq(edges, point - case.triangle[0], rcond=None)[0]
        off = float(np.abs(edges @ weights + case.triangle[0] - point).max())
        if off > 1e-8 * (1.0 + float(np.abs(case.triangle).max())) or weights.min() < -1e-6 or weights.sum() > 1 + 1e-6:
            return f"the witness is {off} beside the triangle, {weights}"
        shares = np.divide(way, case.way, out=np.full(3, way @ case.way), where=case.way != 0.0)
        if not case.boxed:
            shares[:] = way @ case.way / max(float(case.way @ case.way), 1e-300)
        if shares.min() < -1e-9 or shares[case.way != 0.0].max(initial=0.0) > 1.0 + 1e-9:
            return f"the witness is at {shares} of the move"
        if float(np.abs(shares * case.way - way).max()) > 1e-9 * (1.0 + float(np.abs(case.way).max())):
            return f"the witness is beside the move: {way}"
        there = float(signed_distance(case.piece, point - case.tip - way))
        if there > case.limit + 1e-7:
            return f"said to be within {case.limit}, and the witness is {there} away"
    return ""
