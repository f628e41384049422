"""Compile the kernels into the cache (GPROOF_CACHE_DIR, else the user's), so that no test waits for the compiler.

    python scripts/kernels.py [proved | checked]

Runs a job of each kind through the stages with `GPROOF_KERNELS=numba`: what they call is compiled and kept. Where the
copies are there already it is done in seconds. Nothing depends on it but the time that tests take. `proved` and
`checked` are halves of about the same length, for two processes: a job that is compiled and run, and all others.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from corpus.expectations import around as around_of  # noqa: E402  (tests/ is on the path only now)
from support.bundles import unpacked  # noqa: E402

CORPUS = ROOT / "corpus"
PROVED = ("drilled-plate",)
DUMPED = ("pcb-height-map", "cutter-compensation")
SHOPS = {"wincnc": "*/jobs/*.tap", "mcuwin": "*/jobs/*.src"}


def commands(folder: Path) -> dict[str, list[list[str]]]:
    """By half what to run, one after the other."""
    return {"proved": [command for name in PROVED for command in _eding(name, folder)], "checked": _checked(folder)}


def _eding(name: str, folder: Path) -> list[list[str]]:
    job = CORPUS / "eding" / name
    around = around_of(job / "job.cnc")
    out = [["dump", str(job / "job.cnc"), *around, "--stage", "stream"], ["fmt", "--stdout", str(job / "job.cnc")]]
    if name in PROVED:
        made = str(folder / "made.gpx")
        out.append(["compile", str(job / "job.cnc"), *around, "--unsigned", "-o", made])
        out.append(["run", made, "--board", "virtual", "--override", "0.5"])
    return out


def _checked(folder: Path) -> list[list[str]]:
    """First what `proved` has no use for: by the end that has compiled what the two share."""
    out = []
    part = unpacked("docs/codes")
    stock = part / "GP435"
    around = ["--machine", str(stock / "machine.toml"), "--setup", str(stock / "setup.toml"), "--also", "collisions"]
    out.append(["check", str(stock / "good.cnc"), *around])
    around = ["--machine", str(part / "shapes.toml"), "--setup", str(part / "workpiece.toml"), "--also", "gouges"]
    out.append(["check", str(part / "GP420" / "bad.cnc"), *around])
    for dialect, jobs in SHOPS.items():
        job = sorted((CORPUS / dialect).glob(jobs))[0]
        out.append(["check", str(job), "--dialect", dialect])
        out.append(["fmt", "--stdout", "--dialect", dialect, str(job)])
    return [*out, *(command for name in DUMPED for command in _eding(name, folder))]


def main() -> None:
    """Run them; what they print is thrown away."""
    os.environ["GPROOF_KERNELS"] = "numba"
    from gproof.cli.main import main as gproof
    from gproof.driver.errors import COULD_NOT_RUN
    from gproof.ir.kernel_copies import cache_root

    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CONFIG_HOME"] = folder  # the journals of the runs are of no use to the user
        halves = commands(Path(folder))
        for words in (words for half in sys.argv[1:] or halves for words in halves[half]):
            said = [io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2)]
            with contextlib.redirect_stdout(said[0]), contextlib.redirect_stderr(said[1]):
                code = gproof(words)
            if code == COULD_NOT_RUN:
                said[1].seek(0)
                sys.exit(f"gproof {' '.join(words)} could not run: {said[1].read()}")
    count = sum(1 for _ in (cache_root() / "kernels").glob("*/*.nbc"))
    print(f"{count} compiled copies in {cache_root()}")


if __name__ == "__main__":
    main()
