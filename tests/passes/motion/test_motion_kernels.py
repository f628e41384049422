"""The motion kernels in both speeds, bit for bit; the compression by itself."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from passes.motion.reference_motion import paths
from passes.motion.test_height_compensation import a_map, a_path, followed, lowered, using
from passes.motion.traces import Path, machine
from support.campaigns import seeds

from gproof.ir.finding import Findings
from gproof.ir.kernel import Kernel
from gproof.ir.text import print_ir
from gproof.ir.trace import Op, Trace, chunks
from gproof.passes.motion import plan_kernels, run_kernels, step_kernels
from gproof.passes.motion.plan import MotionEstimate, plan
from gproof.passes.motion.step import step

RANDOM = settings(deadline=None, max_examples=12, suppress_health_check=list(HealthCheck))
FAST = 16_000_000


def everything(trace: Trace) -> str:
    """All that plan, step and estimate say of a trace, every bit."""
    findings, m = Findings(), machine(laf_angle=10.0, spindle_ramp_time=0.3)
    made = plan(trace, m, findings)
    assert made is not None
    stream = step(trace, made, m, findings)
    assert stream is not None
    estimate = MotionEstimate(m)
    for chunk in chunks(trace):
        estimate.feed(chunk)
    estimate.finish()
    return "\n".join([
        print_ir(made), print_ir(stream), repr(estimate.seconds), repr(estimate.path_length_mm), repr(findings.counts)
    ])  # fmt: skip


def in_mode(mode: str, run: Callable[[], str]) -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GPROOF_KERNELS", mode)
        return run()


@RANDOM
@given(paths())
def test_python_and_numba_say_the_same(trace: Trace) -> None:
    assert in_mode("python", lambda: everything(trace)) == in_mode("numba", lambda: everything(trace))


def test_python_and_numba_say_the_same_of_a_long_job() -> None:
    path = Path()
    for n in range(1, 150):
        path.feed(2000 + n, x=20 * math.sin(n * 0.07), y=0.003 * n * n, z=math.cos(n))
        if n % 40 == 0:
            path.arc(1500, 2, (path.place[0] + 3.7, path.place[1]), z=1.0, a=n).dwell(0.01)
            path.arc(9000, -1, (path.place[0], path.place[1] - 8.0003), x=path.place[0] + 8.0, y=path.place[1] - 8.0)
    trace = path.done()
    assert in_mode("python", lambda: everything(trace)) == in_mode("numba", lambda: everything(trace))


@pytest.mark.parametrize("seed", seeds(4, 12))
def test_python_and_numba_follow_a_height_map_alike(seed: int) -> None:
    rng = random.Random(3000 + seed)
    area = a_map(rng, steep=0.02)
    trace = a_path(rng, area)

    def way() -> str:
        path = followed(trace, using(area), machine())
        return f"{print_ir(path.trace)} {path.origin} {print_ir(lowered(trace, using(area), machine()))}"

    assert in_mode("python", way) == in_mode("numba", way)


def ways(kernel: Kernel[..., Any]) -> list[Callable[..., Any]]:
    return [kernel.python, kernel.compiled()]


@settings(deadline=None)
@given(*(st.one_of(st.floats(-100, 100), st.sampled_from([0.0, -0.0, 1.0, 1e-17, -1e-17])),) * 4, st.integers(1, 3))
def test_arc_shapes(u0: float, v0: float, u1: float, v1: float, turns: int) -> None:
    for signed in (turns, -turns):
        first, second = (way(u0, v0, u1, v1, signed) for way in ways(plan_kernels.arc_shape))
        assert first == second
        start, sweep, r0, r1 = first
        assert (abs(signed) - 1) * 2 * math.pi - 1e-9 <= abs(sweep) <= abs(signed) * 2 * math.pi + 1e-9
        assert sweep != 0 and (sweep > 0) == (signed > 0)
        assert r0 * math.cos(start) == pytest.approx(u0, abs=1e-9)
        assert r1 * math.sin(start + sweep) == pytest.approx(v1, abs=1e-9)
        if (u0, v0) == (u1, v1) != (0, 0):
            assert abs(sweep) == pytest.approx(abs(signed) * 2 * math.pi)


@settings(deadline=None)
@given(st.floats(-20, 20), st.floats(0, 20))
def test_most_sine(low: float, width: float) -> None:
    first, second = (way(low, low + width) for way in ways(plan_kernels.most_sine))
    assert first == second
    seen = max(abs(math.sin(low + width * n / 200)) for n in range(201))
    assert seen <= first + 1e-12
    assert first - seen < 0.01


@settings(deadline=None)
@given(st.floats(0.01, 50), st.floats(-0.002, 0.002), st.floats(-7, 7), st.integers(-2, 2))
def test_extremes_of_a_drifting_arc(radius: float, change: float, angle: float, half: int) -> None:
    drift = change / 6.0
    first, second = (way(half * math.pi, angle, radius, drift) for way in ways(step_kernels.extreme))
    assert first == second
    r = radius + drift * (first - angle)
    if r > 0.005:
        assert drift * math.cos(first) - r * math.sin(first) == pytest.approx(0, abs=1e-12 * (1 + radius))


# --- compression --------------------------------------------------------------------------------------------


def compressed(
    ticks: list[int], signs: list[int], tolerance: int, near: int, turn: int, way: int = 0
) -> list[tuple[int, int, int, int]]:  # fmt: skip
    """Runs for step times; checks every step against its bounds."""
    n = len(ticks)
    at, sign = np.array(ticks, dtype=np.int64), np.array(signs, dtype=np.int8)
    low, high = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    runs, encoder = np.zeros((n, 4), dtype=np.int64), np.zeros(run_kernels.ENCODER_WIDTH, dtype=np.int64)
    ways(run_kernels.bounds)[way](at, sign, n, 0, tolerance, near, turn, 1, 1 << 62, low, high)
    done, filled = ways(run_kernels.compress)[way](at, sign, low, high, n, True, near, turn, encoder, runs, 0)
    assert done == n
    now, k, was = 0, 0, 0
    for interval, count, add, direction in runs[:filled].tolist():
        for _ in range(count):
            assert interval >= (near if direction == was else turn)
            now += interval
            interval += add
            assert direction == signs[k]
            gaps = [ticks[k] - (ticks[k - 1] if k else 0), *(ticks[k + 1 : k + 2] and [ticks[k + 1] - ticks[k]])]
            assert abs(now - ticks[k]) <= min(tolerance, min(gaps) / 2)
            k, was = k + 1, direction
    assert k == n and encoder[run_kernels.E_TICK] == now
    return [tuple(run) for run in runs[:filled].tolist()]


@settings(deadline=None, max_examples=200)
@given(
    st.lists(st.tuples(st.integers(1, 40), st.integers(0, 3000), st.integers(-40, 40), st.booleans()), max_size=8),
    st.integers(0, 800), st.integers(1, 200), st.integers(0, 200),
)  # fmt: skip
def test_any_step_times_compress_within_their_bounds(
    pieces: list[tuple[int, int, int, bool]], tolerance: int, near: int, extra: int
) -> None:
    ticks, signs, now, turn = [], [], 0, near + extra
    for count, gap, add, up in pieces:
        for n in range(count):
            sign = 1 if up else -1
            least = near if signs and signs[-1] == sign else turn
            now += max(least, gap + add * n)
            ticks.append(now)
            signs.append(sign)
    first, second = (compressed(ticks, signs, tolerance, near, turn, way) for way in (0, 1))
    assert first == second


def profile(steps: int, rate: float, acceleration: float) -> list[int]:
    """Ticks of a move over ``steps`` from rest to rest."""
    ramp = min(steps / 2, rate * rate / (2 * acceleration))
    top = math.sqrt(2 * acceleration * ramp)
    total = 2 * top / acceleration + (steps - 2 * ramp) / top
    out = []
    for n in range(steps):
        s = n + 0.5
        if s < ramp:
            t = math.sqrt(2 * s / acceleration)
        elif s < steps - ramp:
            t = top / acceleration + (s - ramp) / top
        else:
            t = total - math.sqrt(2 * (steps - s) / acceleration)
        out.append(int(t * FAST + 0.5))
    return out


def test_compression_is_worth_its_name() -> None:
    """Steps a run, at least: figures a little below what is reached, so that a loss is noticed."""
    near = 70
    up = [int(math.sqrt(2 * (n + 0.5) / 20_000.0) * FAST + 0.5) for n in range(20_000)]
    assert len(compressed(up, [1] * len(up), 400, near, near)) < 20_000 / 150
    trapezoid = profile(1600, 50_000, 2e6)
    assert len(compressed(trapezoid, [1] * 1600, 400, near, near)) < 1600 / 60
    even = [int((n + 0.5) * 480.3 + 1000) for n in range(20_000)]
    assert len(compressed(even, [1] * len(even), 400, near, near)) < 20_000 / 900
    circle = [int((math.acos(1 - (n + 0.5) / 4000) * 4000 / 30_000 + 0.01) * FAST) for n in range(8000)]
    assert len(compressed(circle, [1] * 8000, 400, near, near)) < 8000 / 60


def test_exact_parabolas_are_one_run() -> None:
    ticks = [5000 * k - 3 * k * (k - 1) // 2 for k in range(1, 1001)]
    assert compressed(ticks, [1] * 1000, 0, 10, 10) == [(5000, 1000, -3, 1)]


def test_runs_end_where_the_direction_changes() -> None:
    ticks = [1000 * k for k in range(1, 21)]
    runs = compressed(ticks, [1] * 10 + [-1] * 10, 100, 10, 900)
    assert [(count, direction) for _, count, _, direction in runs] == [(10, 1), (10, -1)]


def test_ops_are_those_of_the_trace() -> None:
    assert [plan_kernels.TRAVERSE, plan_kernels.ARC, plan_kernels.DWELL] == [Op.TRAVERSE, Op.ARC, Op.DWELL]
