"""Ctrl-C, SIGTERM and SIGHUP end what reads a stranger's file: soon, with one line, exit 130, and nothing is left."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.packages import MACHINE, Shop, members_of
from support.campaigns import seeds
from support.command import COMMAND
from verify.package_files import rebuilt

SOON = 2.0
"""Seconds of processor time; others may have the processor too."""
PATIENCE = 60.0

# The command as it is, but a file of the name is there as soon as a function is called for the first time.
UNTIL = """
import importlib, pathlib, sys
module, owner, name, *words = sys.argv[1:]
place = importlib.import_module(module)
for part in filter(None, owner.split(".")):
    place = getattr(place, part)
real = getattr(place, name)
def called(*args, **kwargs):
    pathlib.Path("reading").touch()
    return real(*args, **kwargs)
setattr(place, name, called)
from gproof.cli.main import main
sys.exit(main(words))
"""


def interrupted(
    folder: Path, at: tuple[str, str, str], words: tuple[str, ...], number: int, moment: float = 0.3
) -> None:
    """The command gets the signal a moment (in seconds) after it began to read; it ends as it should."""
    before = set(os.listdir(folder)) | {"reading"}
    command = [COMMAND[0], "-c", UNTIL, *at, *words]
    env = os.environ | {"XDG_CONFIG_HOME": str(folder)}
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env
    ) as process:
        end = time.monotonic() + PATIENCE
        while not (folder / "reading").exists():
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < end
            time.sleep(0.01)
        time.sleep(moment)
        assert process.poll() is None, process.communicate()
        used = processor_seconds(process.pid)
        process.send_signal(number)
        while process.poll() is None:
            used_now = processor_seconds(process.pid)
            assert used_now - used < SOON, "it goes on"
            assert time.monotonic() < end
            time.sleep(0.02)
        out, err = process.communicate()
    assert process.returncode == 130, (process.returncode, err)
    assert (out, err) == ("", "gproof: interrupted\n")
    assert set(os.listdir(folder)) - before <= {"gproof"}


def processor_seconds(pid: int) -> float:
    """What a process has used so far; 0 when it has gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    return Shop(tmp_path, monkeypatch.setenv)


@pytest.mark.parametrize(
    ("part", "number"), [("setup.ir", signal.SIGINT), ("setup.ir", signal.SIGTERM), ("machine.ir", signal.SIGHUP)]
)
def test_while_a_package_is_read(part: str, number: int, shop: Shop) -> None:
    made = shop.compile("--unsigned")
    data = b"[" + b"1 " * (15 << 20) + b"]"
    rebuilt(shop.folder / "big.gpx", members_of(made) | {part: data})
    interrupted(
        shop.folder, ("gproof.verify.certificate.package_zip", "Sealed", "member"), ("verify", "big.gpx"), number
    )


def test_while_steps_are_proved_in_plain_python(shop: Shop) -> None:
    (shop.folder / "job.cnc").write_text("G21 G90\n" + "G0 X100\nG0 X0\n" * 30 + "M30\n")
    shop.compile("--unsigned")
    words = ("verify", "made.gpx", "--pure")
    interrupted(shop.folder, ("gproof.verify.kernel.prove", "_Walker", "_follow"), words, signal.SIGINT)


PROGRAMS: dict[str, Callable[[], str]] = {
    "job.cnc": lambda: "g21 g90 f100\n" + "".join(f"#{n % 99 + 1}=[{n}]\n" for n in range(400_000)) + "m30\n",
    "job.tap": lambda: "g20g90\nf100\n" + "x[1]y[2]\n" * 400_000,
    "job.src": lambda: "%1\nG90\nF10\n" + "CD600 := 1 + 1\n" * 400_000 + "M30\n%\n",
}
LOADERS = {
    "job.cnc": "gproof.frontend.eding.load",
    "job.tap": "gproof.frontend.wincnc.load",
    "job.src": "gproof.frontend.mcuwin.load",
}


@pytest.mark.parametrize(
    ("name", "command", "number"),
    [
        ("job.cnc", ("check",), signal.SIGTERM), ("job.cnc", ("compile", "-o", "o.gpx"), signal.SIGINT),
        ("job.tap", ("dump", "--stage", "trace"), signal.SIGINT), ("job.src", ("check",), signal.SIGINT),
    ],
)  # fmt: skip
def test_while_a_program_is_read(name: str, command: tuple[str, ...], number: int, tmp_path: Path) -> None:
    (tmp_path / name).write_text(PROGRAMS[name]())
    (tmp_path / "machine.toml").write_text(MACHINE)
    at = (LOADERS[name], "", "load_program")
    interrupted(tmp_path, at, (*command, name, "--machine", "machine.toml", "--setup", "zero"), number)


@pytest.mark.parametrize("seed", seeds(2, 400))
def test_at_any_moment_of_reading(seed: int, tmp_path: Path) -> None:
    """Modules are imported meanwhile, and kernels are loaded: none of it may lose the signal."""
    rng = random.Random(f"moment {seed}")
    name = rng.choice(list(PROGRAMS))
    number = rng.choice([signal.SIGINT, signal.SIGTERM])
    (tmp_path / name).write_text(PROGRAMS[name]())
    (tmp_path / "machine.toml").write_text(MACHINE)
    words = ("check", name, "--machine", "machine.toml", "--setup", "zero")
    interrupted(tmp_path, (LOADERS[name], "", "load_program"), words, number, rng.uniform(0.0, 0.4))


def test_while_a_drawing_is_read(tmp_path: Path) -> None:
    line = "0\nLINE\n8\n0\n10\n{}\n20\n0\n11\n{}\n21\n5\n"
    entities = "".join(line.format(n, n + 1) for n in range(60_000))
    (tmp_path / "part.dxf").write_text(f"0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n")
    (tmp_path / "setup.toml").write_text(
        'schema = "gproof-setup/1"\n[[part]]\ndxf = "part.dxf"\nlayers = { 0 = { bottom = -5, top = 0 } }\n'
    )
    (tmp_path / "job.cnc").write_text("g21 g90\nm30\n")
    at = ("gproof.frontend.common.dxf", "", "open_drawing")
    interrupted(tmp_path, at, ("check", "job.cnc", "--setup", "setup.toml"), signal.SIGINT)
