"""How fast the later stages are, measured inside one process: rows planned, steps lowered, steps validated a second.

``python bench/stages.py JOB MACHINE`` prints one JSON object. Every stage runs twice and the second time
counts, so that compiling or loading kernels is not in it; what a stage takes only once stands in ``first_s``.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

NOT_AVAILABLE = "not available"


def timed(work: Callable[[], Any]) -> tuple[Any, dict[str, float]]:
    """The result of a second run and the seconds of both."""
    began = time.perf_counter()
    work()
    between = time.perf_counter()
    result = work()
    return result, {"seconds": time.perf_counter() - between, "first_s": between - began}


def stages(job: Path, machine_file: Path) -> dict[str, Any]:
    """Figures by stage; a stage that is missing or refuses the job says so instead."""
    from gproof.driver.dialects import load_machine
    from gproof.driver.running import execute
    from gproof.frontend.eding.load import load_program
    from gproof.ir.finding import Findings
    from gproof.ir.setup import ZERO

    out: dict[str, Any] = {}
    findings = Findings()
    machine, _ = load_machine(machine_file, findings)
    program = load_program(job, findings)
    assert machine is not None and program is not None, findings.kept
    trace, took = timed(lambda: execute(program, ZERO, machine, findings))
    rows = sum(len(section.rows) for section in trace.sections)
    out["execute"] = took | {"count": rows, "unit": "rows"}

    plan = _stage("gproof.passes.motion.plan", "plan", out, lambda f: f(trace, machine, findings))
    if plan is None:
        return out
    out["plan"] |= {"count": sum(len(section.rows) for section in plan.sections), "unit": "rows"}
    stream = _stage("gproof.passes.motion.step", "step", out, lambda f: f(trace, plan, machine, findings))
    if stream is None:
        return out
    out["step"] |= {"count": stream.steps(), "unit": "steps"}
    report = _stage("gproof.verify.stream", "validate", out, lambda f: f(stream, trace, machine, ZERO))
    if report is not None:
        out["validate"] |= {"count": stream.steps(), "unit": "steps"}
    raised, setup = over_a_height_map(trace)
    path = _stage(
        "gproof.passes.motion.height_compensation", "follow", out, lambda f: f(raised, setup, machine, findings)
    )
    if path is not None:
        made = sum(len(section.rows) for section in path.trace.sections)
        out["follow"] |= {"count": rows, "unit": "rows", "lines": made}
    chords = _stage("gproof.verify.kernel.lifted_path", "Lifting", out, lambda f: checked(f, raised, setup, stream))
    if chords is not None:
        out["Lifting"] |= {"count": rows, "unit": "rows", "lines": chords}
    return out


def over_a_height_map(trace: Any) -> tuple[Any, Any]:
    """The job with compensation on over a grid of 5 mm that covers it, with waves of 0.1 mm; and the setup."""
    import numpy as np

    from gproof.ir.setup import HeightMap, Setup
    from gproof.ir.trace import HEIGHT_MAP

    points = np.vstack([section.rows["to"][:, :2] for section in trace.sections] + [[[0.0, 0.0]]])
    low = points.min(axis=0) - 50.0
    nx, ny = (np.ceil((points.max(axis=0) + 50.0 - low) / 5.0).astype(int) + 1).tolist()
    heights = 0.1 * np.sin(np.arange(nx) / 3.0)[np.newaxis, :] * np.cos(np.arange(ny) / 4.0)[:, np.newaxis]
    area = HeightMap(x=low[0], y=low[1], size=5.0, heights=tuple(tuple(row) for row in heights.tolist()))
    states = [dataclasses.replace(state, following=(HEIGHT_MAP,)) for state in trace.states]
    return dataclasses.replace(trace, states=states), Setup(height_map=area)


def checked(lifting: Any, trace: Any, setup: Any, stream: Any) -> int:
    """How many chords the stream checker makes of a job over a height map."""
    from gproof.verify.kernel.proof import Proof
    from gproof.verify.kernel.rows import row_arrays, tables_of

    made = lifting(trace, setup.height_map, stream.motors)
    arrays = [row_arrays(section, tables_of(stream, trace), Proof()) for section in trace.sections]
    return sum(len(made.section(number, rows).origin) for number, rows in enumerate(arrays) if rows is not None)


def _stage(module: str, name: str, out: dict[str, Any], call: Callable[[Any], Any]) -> Any:
    try:
        function = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError):
        out[name] = {"problem": NOT_AVAILABLE}
        return None
    try:
        result, took = timed(lambda: call(function))
    except Exception as error:  # a stage under work must not stop the others' figures
        out[name] = {"problem": f"{type(error).__name__}: {error}"}
        return None
    out[name] = took if result is not None else {"problem": "refused the job"}
    return result


def main() -> None:
    job, machine = (Path(a) for a in sys.argv[1:3])
    with open(os.devnull, "w", encoding="utf-8") as nowhere, contextlib.redirect_stdout(nowhere):
        figures = stages(job, machine)
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
