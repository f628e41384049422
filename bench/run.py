"""``make bench``: gproof beside LinuxCNC's ``rs274`` on the same programs, in one run on this machine.

    python bench/run.py [--only lines|loops|...] [--lines 2000,100000] [--shapes raster] [--repeat 5]
                        [--dialects wincnc,mcuwin] [--long] [--json FILE] [--svg FILE]

Timings are no tests: the exit code is 0 whatever they are. bench/README.md explains the columns.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import collisions
import gouges
import link
import loops
import stock
import translation
from measure import Runs, gproof_command, gproof_itself, rs274_command, run_once
from plot import Line, Panel, plot
from programs import COMMON_SHAPES, MACHINES, SHAPES, write_program

HERE = Path(__file__).resolve().parent
MACHINE = MACHINES / "machine.toml"
DIALECTS = {
    "eding": ("Eding", ".ngc", MACHINE), "wincnc": ("WinCNC", ".tap", MACHINES / "WINCNC.INI"),
    "mcuwin": ("McuWIN", ".din", MACHINES / "mcuwin.toml"),
}  # fmt: skip
"""Name, suffix of programs, machine."""
PARSED = ("eding", "mcuwin")
"""Dialects whose reading is measured."""
PARTS = ("start", "lines", "scale", "parse", "steps", "collisions", "gouges", "stock", "loops", "translate", "link")
LINES = (2_000, 100_000, 1_000_000)
SCALE = (10_000, 100_000, 1_000_000, 10_000_000)
SCALE_SHAPES = ("raster",)
START_LINES = 100
STEP_LINES = 20_000
LOADED = 20_000
"""Lines that McuWIN's controller surely loads; of more the size alone makes a job UNKNOWN or UNSAFE (GP146, GP147)."""
VERDICTS = (0, 1, 2)
"""Exit codes of SAFE, UNSAFE and UNKNOWN."""
LONG = 100_000  # from so many lines on a cold run is not repeated
VERY_LONG = 10_000_000  # from so many lines on a program is removed after its runs, of which there are two

GOAL_START_S = 0.35
GOALS = {1_000_000: (0.5, 400.0), 10_000_000: (0.125, 600.0)}
"""From so many lines on: the most of rs274's wall time, and of memory in MB."""
GOAL_VALIDATE = 20_000_000  # steps a second
GOAL_PARSE = {"repeat": 20_000, "different": 3_000}  # lines a second


@dataclass(slots=True, kw_only=True)
class Compared:
    """One program under both tools; cold: gproof without any compiled kernel on disk."""

    dialect: str
    shape: str
    lines: int
    warm: Runs
    cold: Runs
    peer: Runs | None

    @property
    def ratio(self) -> float | None:
        """Best wall time of gproof, kernels cached, in that of rs274."""
        return self.warm.best / self.peer.best if self.peer is not None else None

    @property
    def cpu_ratio(self) -> float | None:
        return self.warm.cpu / self.peer.cpu if self.peer is not None else None

    @property
    def peak_mb(self) -> float:
        return max(self.warm.peak_mb, self.cold.peak_mb)

    def as_json(self) -> dict[str, object]:
        peer = self.peer.as_json() if self.peer is not None else None
        runs = {"gproof_warm": self.warm.as_json(), "gproof_cold": self.cold.as_json(), "rs274": peer}
        about = {"dialect": self.dialect, "shape": self.shape, "lines": self.lines}
        return {**about, "ratio": self.ratio, **runs}


class Bench:
    """A temporary folder with the programs, caches and rs274's home, and what runs in it."""

    def __init__(self, folder: Path, repeat: int) -> None:
        self.folder = folder
        self.repeat = repeat
        self.rs274 = shutil.which("rs274")
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("GPROOF_", "PYTHON"))}
        (folder / "home").mkdir()
        self.peer_environment = kept | {"HOME": str(folder / "home")}
        # Bytecode is there, as pip leaves it for a package that is installed.
        bytecode = {"PYTHONPYCACHEPREFIX": str(folder / "bytecode")}
        self.warm_environment = kept | bytecode | {"GPROOF_CACHE_DIR": str(folder / "warm")}

    def program(self, shape: str, lines: int, suffix: str = ".ngc") -> Path:
        path = self.folder / f"{shape}-{lines}{suffix}"
        if not path.exists():
            write_program(shape, lines, path)
        return path

    def fill_cache(self) -> None:
        """Compile every kernel and module that ``check`` uses."""
        for dialect, (_, suffix, machine) in DIALECTS.items():
            for shape in shapes_of(dialect):
                command = gproof_command(self.program(shape, START_LINES, suffix), machine)
                for mode in ("numba", "python"):
                    run_once(command, self.warm_environment | {"GPROOF_KERNELS": mode}, Runs())

    def compare(self, dialect: str, shape: str, lines: int) -> Compared:
        """Both tools in turn, so that a change of the machine's load meets both; each reads the path in its own way."""
        _, suffix, machine = DIALECTS[dialect]
        path = self.program(shape, lines)
        command = gproof_command(self.program(shape, lines, suffix), machine)
        accepted = VERDICTS if dialect == "mcuwin" and lines > LOADED else (0,)
        warm, cold, peer = Runs(), Runs(), Runs()
        for _ in range(self.repeat if lines < VERY_LONG else min(2, self.repeat)):
            said = run_once(command, self.warm_environment, warm, accepted)
            if accepted == (0,) and "SAFE" not in said.split("\n", 1)[0] and not warm.problem:
                warm.problem = "not SAFE"
            if self.rs274:
                run_once(rs274_command(path, self.rs274), self.peer_environment, peer)
        for n in range(1 if lines >= LONG else self.repeat):
            empty = self.folder / f"cold-{dialect}-{shape}-{lines}-{n}"
            run_once(command, self.warm_environment | {"GPROOF_CACHE_DIR": str(empty)}, cold, accepted)
            shutil.rmtree(empty, ignore_errors=True)
        if lines >= VERY_LONG:
            self.program(shape, lines, suffix).unlink()
            path.unlink(missing_ok=True)
        return Compared(
            dialect=dialect, shape=shape, lines=lines, warm=warm, cold=cold, peer=peer if self.rs274 else None
        )  # fmt: skip

    def compare_all(self, dialects: list[str], shapes: list[str], sizes: list[int]) -> list[Compared]:
        """Each dialect's shapes by size."""
        return [
            self.compare(dialect, shape, lines)
            for dialect in dialects
            for lines in sizes
            for shape in shapes
            if shape in shapes_of(dialect)
        ]

    def stages(self, shape: str) -> dict[str, Any]:
        command = [sys.executable, str(HERE / "stages.py"), str(self.program(shape, STEP_LINES)), str(MACHINE)]
        runs = Runs()
        said = run_once(command, self.warm_environment | {"GPROOF_KERNELS": "numba"}, runs)
        figures: dict[str, Any] = {"execute": {"problem": runs.problem}} if runs.problem else json.loads(said)
        return {"shape": shape, "peak_mb": runs.peak_mb, "stages": figures}

    def parse(self, dialect: str) -> dict[str, Any]:
        runs = Runs()
        said = run_once([sys.executable, str(HERE / "parse.py"), dialect], self.warm_environment, runs)
        return {"problem": runs.problem} if runs.problem else dict(json.loads(said))


def shapes_of(dialect: str) -> tuple[str, ...]:
    return tuple(SHAPES) if dialect == "eding" else COMMON_SHAPES


def about() -> dict[str, str]:
    """What was measured, on what."""
    peer = "not installed (Debian: linuxcnc-uspace)"
    if shutil.which("rs274"):
        asked = ["dpkg-query", "-W", "-f", "${Package} ${Version}", "linuxcnc-uspace"]
        known = shutil.which("dpkg-query") and subprocess.run(asked, capture_output=True, text=True, check=False)
        peer = (known.stdout if known else "") or "version unknown"
    processor = ""
    if os.path.exists("/proc/cpuinfo"):
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        processor = next((x.partition(":")[2].strip() for x in text.splitlines() if x.startswith("model name")), "")
    names = " ".join(f"{name} {version(name)}" for name in ("gproof", "numpy", "numba"))
    return {
        "gproof": f"{names}, Python {sys.version.split()[0]}",
        "rs274": peer,
        "machine": f"{processor or 'unknown processor'}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}",
    }


def verdict(met: bool) -> str:
    return "PASS" if met else "MISS"


def figures(runs: Runs | None) -> str:
    """Wall time, best and median, and processor time."""
    return f"{'-':>22}" if runs is None else f"{runs.best:7.3f} {runs.median:7.3f} {runs.cpu:6.3f}"


HEADING = (
    f"  {'':>9}  {'':<7} {'rs274':^22}   {'gproof, warm':^22}   {'cold':>7} {'peak':>5}  {'ratio':^11}\n"
    f"  {'lines':>9}  {'shape':<7} {'best  median    cpu':>22}   {'best  median    cpu':>22}   {'best':>7} {'MB':>5}"
    f"  {'wall   cpu':>11}  goal"
)


def print_start(rows: list[Compared]) -> None:
    for row in _by_dialect(rows, "Start-up: check of a small job"):
        goal = f"medians at most {GOAL_START_S} s"
        met = max(row.warm.median, row.cold.median) <= GOAL_START_S
        print(f"{_figures(row)}  {goal}  {verdict(met)}{_problem(row)}")


def print_lines(rows: list[Compared]) -> None:
    for row in _by_dialect(rows, "Check beside rs274"):
        print(f"{_figures(row)}  {',  '.join(_goals(row))}".rstrip() + _problem(row))


def _goals(row: Compared) -> list[str]:
    size = max((size for size in GOALS if size <= row.lines), default=0)
    if not size:
        return []
    ratio, peak_mb = GOALS[size]
    told = [] if row.ratio is None else [f"ratio at most {ratio}  {verdict(row.ratio <= ratio)}"]
    return [*told, f"{peak_mb:.0f} MB  {verdict(row.peak_mb <= peak_mb)}"]


def print_scale(rows: list[Compared], start_s: float) -> None:
    """Time and memory over the number of lines; start_s: what a job of one line takes."""
    for row in _by_dialect(rows, "Scaling"):
        print(f"{_figures(row)}  {',  '.join(_goals(row))}".rstrip() + _problem(row))
    print(f"\n  {'lines':>9}  {'shape':<7} {'rs274 µs a line':>16} {'gproof µs a line':>17} {'without the start':>18}")
    for row in rows:
        peer = f"{1e6 * row.peer.best / row.lines:.2f}" if row.peer is not None else "-"
        alone = 1e6 * max(0.0, row.warm.best - start_s) / row.lines
        print(f"  {row.lines:9,}  {row.shape:<7} {peer:>16} {1e6 * row.warm.best / row.lines:17.2f} {alone:18.2f}")


def scale_plot(rows: list[Compared], start_s: float) -> str:
    """The same as a picture of straight lines: SVG."""

    def both(title: str, unit: str, figure: Callable[[Runs], float]) -> Panel:
        lines = [Line("gproof check", "#1f77b4", [(row.lines, figure(row.warm)) for row in rows])]
        peers = [(row.lines, figure(row.peer)) for row in rows if row.peer is not None]
        return Panel(title, "lines", unit, [*lines, *([Line("rs274", "#d62728", peers)] if peers else [])])

    wall = both("Wall time of the whole process", "seconds", lambda runs: runs.best)
    alone = [(row.lines, row.warm.best - start_s) for row in rows if row.warm.best > 1.1 * start_s]
    dashed = Line("gproof without its start", "#1f77b4", alone, dashed=True)
    wall = replace(wall, lines=[*wall.lines, *([dashed] if len(alone) > 1 else [])])
    cpu = both("Processor time", "seconds", lambda runs: runs.cpu)
    return plot([wall, cpu, both("Peak memory", "MB", lambda runs: runs.peak_mb)])


def _by_dialect(rows: list[Compared], what: str) -> Iterator[Compared]:
    """The rows, with a heading above those of each dialect."""
    for n, row in enumerate(rows):
        if n == 0 or rows[n - 1].dialect != row.dialect:
            print(f"\n{what}, {DIALECTS[row.dialect][0]}, seconds of the whole process\n{HEADING}")
        yield row


def _figures(row: Compared) -> str:
    ratio = f"{row.ratio:5.2f} {row.cpu_ratio:5.2f}" if row.ratio is not None else f"{'-':>11}"
    return (
        f"  {row.lines:9,}  {row.shape:<7} {figures(row.peer)}   {figures(row.warm)}   {row.cold.best:7.3f} "
        f"{row.peak_mb:5.0f}  {ratio}"
    )


def _problem(row: Compared) -> str:
    said = [
        f"{name}: {runs.problem}" for name, runs in (("gproof", row.warm), ("gproof cold", row.cold)) if runs.problem
    ]
    if row.peer is not None and row.peer.problem:
        said.append(f"rs274: {row.peer.problem}")
    return "".join(f"\n             ! {text}" for text in said)


def print_stages(rows: list[dict[str, Any]]) -> None:
    print(f"\nStages in one process, kernels compiled, {STEP_LINES:,} lines: thousands a second")
    names = ("execute", "plan", "step", "validate", "follow", "Lifting")
    print(f"  {'shape':<7}" + "".join(f" {name:>18}" for name in names) + f" {'steps':>12} {'MB':>5}")
    for row in rows:
        cells = []
        for name in names:
            f = row["stages"].get(name, {})
            figure = f"{f['count'] / f['seconds'] / 1e3:,.0f} {f['unit']}" if "count" in f else ""
            cells.append(f" {figure or f.get('problem', '-')[:18]:>18}")
        steps = row["stages"].get("step", {}).get("count")
        told = ""
        if "count" in (checked := row["stages"].get("validate", {})):
            met = checked["count"] / checked["seconds"] >= GOAL_VALIDATE
            told = f"  at least {GOAL_VALIDATE // 1000:,} steps validated  {verdict(met)}"
        print(f"  {row['shape']:<7}" + "".join(cells) + f" {steps if steps else '-':>12} {row['peak_mb']:5.0f}{told}")


def print_parse(dialect: str, found: dict[str, Any]) -> None:
    print(
        f"\nReading {DIALECTS[dialect][0]} programs in one process, kernels compiled: lines a second of processor time"
    )
    if "problem" in found:
        print(f"  ! {found['problem']}")
        return
    print(f"  {'kind':<10} {'lines':>10} {'a second':>10} {'bytes a line':>13}  goal")
    for kind, row in found.items():
        rate, goal = row["lines"] / row["seconds"], GOAL_PARSE.get(kind)
        told = f"at least {goal:,}  {verdict(rate >= goal)}" if goal else ""
        print(f"  {kind:<10} {row['lines']:>10,} {rate:>10,.0f} {row['bytes_a_line']:>13,.0f}  {told}".rstrip())


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="gproof beside rs274 on the same programs.")
    parser.add_argument("--only", action="append", choices=PARTS, help="a part; repeatable (default: all)")
    parser.add_argument("--lines", default=",".join(map(str, LINES)), help="sizes, by commas")
    parser.add_argument("--shapes", default=",".join(SHAPES), help="shapes of program, by commas")
    parser.add_argument("--dialects", default=",".join(DIALECTS), help="dialects of start, lines and parse, by commas")
    parser.add_argument("--repeat", type=int, default=5, help="runs of each command (default 5)")
    parser.add_argument("--long", action="store_true", help="10 million lines of every shape and dialect, too")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write every figure here")
    parser.add_argument("--svg", type=Path, metavar="FILE", help="draw what ``scale`` found here")
    return parser.parse_args()


def main() -> None:
    asked = arguments()
    parts = asked.only or PARTS
    shapes, sizes = asked.shapes.split(","), [int(n) for n in asked.lines.split(",")]
    dialects = asked.dialects.split(",")
    sizes += [VERY_LONG] if asked.long and VERY_LONG not in sizes else []
    answer: dict[str, Any] = {"schema": "gproof-bench/1", "about": about()}
    print("\n".join(f"{name + ':':<9}{text}" for name, text in answer["about"].items()))
    with tempfile.TemporaryDirectory(prefix="gproof-bench-") as name:
        bench = Bench(Path(name), max(1, asked.repeat))
        bench.fill_cache()
        if "start" in parts:
            rows = bench.compare_all(dialects, shapes, [START_LINES])
            print_start(rows)
            answer["start"] = [row.as_json() for row in rows]
        if "lines" in parts:
            rows = bench.compare_all(dialects, shapes, sizes)
            print_lines(rows)
            answer["lines"] = [row.as_json() for row in rows]
        if "scale" in parts:
            rows = bench.compare_all(dialects[:1], [s for s in shapes if s in SCALE_SHAPES] or shapes, list(SCALE))
            start_s = bench.compare(dialects[0], rows[0].shape, START_LINES).warm.best
            print_scale(rows, start_s)
            answer["scale"] = {"start_s": start_s, "rows": [row.as_json() for row in rows]}
            if asked.svg is not None:
                asked.svg.write_text(scale_plot(rows, start_s), encoding="utf-8")
        if "parse" in parts:
            answer["parse"] = {}
            for dialect in dialects:
                if dialect in PARSED:
                    answer["parse"][dialect] = bench.parse(dialect)
                    print_parse(dialect, answer["parse"][dialect])
        if "steps" in parts:
            stages = [bench.stages(shape) for shape in shapes]
            print_stages(stages)
            answer["steps"] = stages
        if "collisions" in parts:
            rows = collisions.compare(bench.folder, bench.warm_environment, gproof_itself(), bench.repeat)
            collisions.show(rows)
            answer["collisions"] = rows
        if "gouges" in parts:
            rows = gouges.measure(bench.folder, bench.warm_environment, gproof_itself(), bench.repeat)
            gouges.show(rows)
            answer["gouges"] = rows
        if "stock" in parts:
            rows = stock.measured(bench.folder, bench.warm_environment, gproof_itself(), bench.repeat)
            stock.show(rows)
            answer["stock"] = rows
        if "loops" in parts:
            rows = loops.measured(bench.folder, bench.warm_environment, gproof_itself(), bench.repeat)
            loops.show(rows)
            answer["probing"] = loops.probing(bench.warm_environment, gproof_itself())
            loops.show_probing(answer["probing"])
            answer["loops"] = rows
        if "translate" in parts:
            rows = translation.measured(
                bench.folder, bench.program, bench.warm_environment, gproof_itself(), repeat=bench.repeat,
                shapes=[one for one in shapes if one in translation.SHAPES], lines=min(max(sizes), translation.LINES),
            )  # fmt: skip
            translation.show(rows)
            answer["translate"] = rows
        if "link" in parts:
            answer["link"] = link.measured(bench.warm_environment)
            link.show(answer["link"])
    if asked.json is not None:
        asked.json.write_text(json.dumps(answer, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
