"""Packages of the smallest job, made by the command line in a folder with keys of its own."""

from __future__ import annotations

import datetime
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from support.command import Done, in_this_process

from gproof.verify.certificate.keys import create_key, load_key, public_key_text, raw_public
from gproof.verify.certificate.package import BODY, SIGNATURE, canonical, write_members

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 10
max_acceleration = 100
"""
JOB = "G21 G90\nG0 X1\nM30\n"
COMPILE = ("compile", "job.cnc", "--machine", "machine.toml", "--setup", "zero")
BOARD = ("--board", "virtual")


class Shop:
    """A folder with job, machine, setup and packages; `home`: whose keys count (there are several users)."""

    def __init__(self, folder: Path, use: Callable[[str, str], None]) -> None:
        self.folder, self._use = folder, use
        self.home("me")
        (folder / "job.cnc").write_text(JOB)
        (folder / "machine.toml").write_text(MACHINE)
        (folder / "setup.toml").write_text('schema = "gproof-setup/1"\nhomed = ["x"]\n')

    def home(self, name: str) -> None:
        """Be another user from now on."""
        self._use("XDG_CONFIG_HOME", str(self.folder / name))
        self.keys = self.folder / name / "gproof"

    def __call__(self, *words: str) -> Done:
        return in_this_process(words, self.folder)

    def compile(self, *words: str, output: str = "made.gpx") -> Path:
        done = self(*COMPILE, *words, "-o", output)
        assert done.exit == 0, done
        return self.folder / output

    def key(self, name: str) -> tuple[Path, Path]:
        """A new private key and the file of its public half."""
        private, public = self.folder / f"{name}-private.pem", self.folder / f"{name}.pem"
        public.write_text(public_key_text(create_key(private)))
        return private, public

    def day(self, days: int) -> str:
        """A date so many days from today (UTC)."""
        return str(datetime.datetime.now(datetime.UTC).date() + datetime.timedelta(days=days))


def members_of(path: Path) -> dict[str, bytes]:
    """The members of a package."""
    import zipfile

    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def resigned(path: Path, private: Path, change: Callable[[dict[str, Any]], object], **label: str) -> Path:
    """A package whose body somebody has changed and signed with a key of his own."""
    import base64

    members, key = members_of(path), load_key(private)
    body = json.loads(members[BODY])
    change(body)
    members[BODY] = canonical(body)
    said = {
        "public_key": base64.b64encode(raw_public(key)).decode(),
        "signature": base64.b64encode(key.sign(members[BODY])).decode(),
        "created": "",
        "comment": "",
        **label,
    }
    over = base64.b64encode(key.sign(canonical(said))).decode()
    members[SIGNATURE] = canonical({**said, "label_signature": over})
    write_members(path, members)
    return path
