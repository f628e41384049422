"""Whatever a file of a stranger holds, each reader answers: no exception, no long run, no memory eaten.

A million cases in a soak, the first eighth of a hundredth of each reader in every run. Each calls the reader itself;
one in so many runs the whole command, which ends with an exit code of its own. A failure prints the seed and the bytes.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from fuzz.readers import READERS, Reader
from support.campaigns import SOAK
from support.command import in_this_process
from support.guarded import alarm, memory

SECONDS, BYTES = 10, 1 << 30
PARTS = 100
"""Of a soak."""
IN_EVERY_RUN = 8
"""Every run makes one in so many of the first part: 1/800 of the million."""
WHOLE = 25
"""One case in so many is a whole command."""
EXITS = (0, 1, 2, 3, 130)
GROUPS = [
    pytest.param(name, part, marks=pytest.mark.soak) if part else (name, part)
    for part in range(PARTS if SOAK else 1)
    for name in READERS
]


def test_there_are_a_million_cases() -> None:
    assert sum(reader.cases for reader in READERS.values()) == 1_000_000
    assert all(reader.cases % PARTS == 0 and reader.cases >= 10 * PARTS for reader in READERS.values())


@pytest.mark.parametrize("name", READERS)
def test_the_right_files_are_read(name: str, tmp_path: Path) -> None:
    """A fuzzer whose seeds all fail at once finds nothing: the first of them gives an answer."""
    reader = READERS[name]
    for file, data in reader.around.items():
        (tmp_path / file).write_bytes(data)
    if reader.seeds()[0]:
        (tmp_path / reader.name).write_bytes(reader.seeds()[0])
        done = in_this_process(reader.words, tmp_path) if reader.words else None
        assert done is None or done.exit in (0, 1, 2), done


def one(reader: Reader, rng: random.Random, path: Path, *, whole: bool) -> None:
    """One case; the file stays as it was read."""
    path.write_bytes(reader.make(rng, reader.seeds()))
    with alarm(SECONDS), memory(BYTES):
        if not whole or not reader.words:
            reader.read(path)
            return
        done = in_this_process(reader.words, path.parent)
    assert done.exit in EXITS, done
    assert "internal error" not in done.err, done.err
    assert "not enough memory" not in done.err, done.err
    assert "MemoryError" not in done.out, done.out
    assert done.exit == 3 or done.out, "neither an answer nor a reason"


@pytest.mark.parametrize(("name", "part"), GROUPS)
def test_any_file_is_answered(name: str, part: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("GPROOF_TRACEBACK", "1")
    reader = READERS[name]
    assert len(reader.seeds()) > 0
    for file, data in reader.around.items():
        (tmp_path / file).write_bytes(data)
    path, size = tmp_path / reader.name, reader.cases // PARTS
    tried = size if SOAK else size // IN_EVERY_RUN
    for number in range(part * size, part * size + tried):
        try:
            one(reader, random.Random(f"{name} {number}"), path, whole=number % WHOLE == 0)
        except BaseException:
            data = path.read_bytes()
            print(f"{name}, case {number}: {reader.name} of {len(data)} bytes\n{data!r}")
            raise
