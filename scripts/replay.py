"""Run two revisions of gproof over the corpus and say where their outputs differ.

``replay.py BASE`` compares the working tree with the git revision BASE: for every job of ``corpus/``
the text of each stage, its exit code included. A difference is reported at the first stage that shows
it. Exit code 0: same bytes everywhere; 1: something differs; 3: could not compare, which includes that
no job at all gave a stream.

The base revision's packages are installed, without dependencies, under ``build/replay/``.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STAGES = ("program", "trace", "plan", "stream")
RUN = "import sys; from gproof.cli.main import main; sys.exit(main())"


def install_base(revision: str) -> Path:
    """The folder with the packages of a revision, built once for each commit."""
    commit = _output("git", "rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}").strip()
    site = ROOT / "build" / "replay" / commit
    if site.exists():
        return site
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "source"
        source.mkdir()
        archive = Path(folder) / "source.tar"
        _output("git", "archive", "-o", str(archive), commit)
        _output("tar", "-xf", str(archive), "-C", str(source))
        fresh = Path(folder) / "site"
        pip = (sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
        _output(*pip, "--no-deps", "--no-build-isolation", "--target", str(fresh), str(source))
        site.parent.mkdir(parents=True, exist_ok=True)
        _output("mv", str(fresh), str(site))
    return site


def _output(*command: str) -> str:
    done = subprocess.run(command, cwd=ROOT, text=True, stdout=subprocess.PIPE, check=False)
    if done.returncode != 0:
        print(f"replay: {' '.join(command[:4])} … ended with {done.returncode}", file=sys.stderr)
        sys.exit(3)
    return done.stdout


def arguments(job: Path) -> list[str]:
    """The options that the job's ``expect.toml``, or the table beside it, names."""
    beside = job.parent / "expect.toml"
    expect = tomllib.loads((beside if beside.is_file() else job.with_suffix(".toml")).read_text(encoding="utf-8"))
    options = ["--machine", str(job.parent / expect["machine"])]
    if "setup" in expect:
        setup = expect["setup"]
        options += ["--setup", setup if setup == "zero" else str(job.parent / setup)]
    return options


def digest(job: Path, stage: str, site: Path | None) -> tuple[str, int]:
    """A hash over what ``gproof dump`` prints for one stage, and its exit code."""
    environment = {**os.environ, "PYTHONPATH": str(site) if site else ""}
    command = [sys.executable, "-c", RUN, "dump", str(job), "--stage", stage, *arguments(job)]
    content = hashlib.sha256()
    with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE) as running:
        assert running.stdout is not None
        while chunk := running.stdout.read(1 << 20):
            content.update(chunk)
    return content.hexdigest()[:16], running.returncode


def check_origin(site: Path) -> None:
    """Refuse to compare a revision with itself: PYTHONPATH has to win over the working tree."""
    found = subprocess.run(
        [sys.executable, "-c", "import gproof.ir; print(gproof.ir.__file__)"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(site)},
        text=True,
        stdout=subprocess.PIPE,
        check=True,
    )
    if not Path(found.stdout.strip()).is_relative_to(site):
        print(f"replay: the base revision is not what Python imports: {found.stdout}", file=sys.stderr)
        sys.exit(3)


def main(base: str) -> int:
    """Compare all jobs; print one line for each that differs and a summary."""
    site = install_base(base)
    check_origin(site)
    jobs = sorted(path.parent / "job.cnc" for path in (ROOT / "corpus").rglob("expect.toml"))
    jobs += sorted(
        path for path in (ROOT / "corpus/wincnc").glob("*/jobs/*.tap") if path.with_suffix(".toml").is_file()
    )
    if not jobs:
        print("replay: corpus/ holds no job", file=sys.stderr)
        return 3
    differing = streams = 0
    for job in jobs:
        for stage in STAGES:
            before, now = digest(job, stage, site), digest(job, stage, None)
            if before != now:
                differing += 1
                print(f"{job.relative_to(ROOT)}: {stage} differs: (hash, exit code) {before} -> {now}")
                break
            streams += stage == "stream" and now[1] == 0
    print(f"replay: {len(jobs)} jobs against {base}: {differing} differ, {streams} gave the same stream")
    if not differing and not streams:
        print("replay: no job gave a stream, so nothing was compared", file=sys.stderr)
        return 3
    return 1 if differing else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: replay.py BASE")
    sys.exit(main(sys.argv[1]))
