"""Compiled code is kept and read only where nobody else can write."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from gproof.ir.private_folder import make_private, not_private, private_or_other, read_own

pytestmark = pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
ROOT = os.name == "posix" and os.geteuid() == 0


@pytest.fixture
def cache(tmp_path: Path) -> Path:
    folder = tmp_path / "home" / "cache"
    make_private(folder)
    return folder


def open_to_all(cache: Path) -> Path:
    cache.chmod(0o777)
    return cache


def open_to_the_group(cache: Path) -> Path:
    cache.chmod(0o770)
    return cache


def sticky_itself(cache: Path) -> Path:
    cache.chmod(0o1777)
    return cache


def parent_open_to_all(cache: Path) -> Path:
    cache.parent.chmod(0o777)
    return cache


def missing_below_one_that_is_open(cache: Path) -> Path:
    cache.chmod(0o777)
    return cache / "gproof"


def itself_a_link(cache: Path) -> Path:
    link = cache.parent / "link"
    link.symlink_to(cache)
    return link


def a_link_to_nothing(cache: Path) -> Path:
    link = cache.parent / "link"
    link.symlink_to(cache / "missing")
    return link


def below_a_link_into_an_open_folder(cache: Path) -> Path:
    (cache / "a").mkdir()
    cache.chmod(0o777)
    link = cache.parent / "link"
    link.symlink_to(cache / "a")
    return link / "gproof"


def below_links_in_a_ring(cache: Path) -> Path:
    (cache / "a").symlink_to(cache / "b")
    (cache / "b").symlink_to(cache / "a")
    return cache / "a" / "gproof"


def a_file(cache: Path) -> Path:
    (cache / "file").write_bytes(b"")
    return cache / "file"


def of_somebody_else(cache: Path) -> Path:
    os.chown(cache, 65534, -1)
    return cache


def below_somebody_else(cache: Path) -> Path:
    os.chown(cache.parent, 65534, -1)
    return cache


def below_the_link_of_somebody_else(cache: Path) -> Path:
    link = cache.parent / "link"
    link.symlink_to(cache)
    os.lchown(link, 65534, -1)
    return link / "gproof"


SHARED: list[Callable[[Path], Path]] = [
    open_to_all, open_to_the_group, sticky_itself, parent_open_to_all, missing_below_one_that_is_open, itself_a_link,
    a_link_to_nothing, below_a_link_into_an_open_folder, below_links_in_a_ring, a_file,
]  # fmt: skip
FOREIGN = [of_somebody_else, below_somebody_else, below_the_link_of_somebody_else]


@pytest.mark.parametrize("make", SHARED + (FOREIGN if ROOT else []))
def test_a_folder_that_somebody_else_can_change_is_not_used(make: Callable[[Path], Path], cache: Path) -> None:
    folder = make(cache)
    assert not_private(folder)
    if folder.is_dir():
        (folder / "kept").write_bytes(b"code")
        assert read_own(folder / "kept") is None


def test_a_private_folder_is_used_also_below_a_sticky_one(cache: Path) -> None:
    assert not not_private(cache)
    cache.parent.chmod(0o1777)
    assert not not_private(cache)
    assert private_or_other(str(cache)) == cache


def test_a_missing_folder_of_a_sticky_one_is_made_at_once(cache: Path) -> None:
    cache.parent.chmod(0o1777)
    new = cache.parent / "new"
    assert not not_private(new)
    assert new.stat().st_mode & 0o777 == 0o700


def test_a_missing_folder_of_a_private_one_is_not_made(cache: Path) -> None:
    assert not not_private(cache / "one" / "two")
    assert not (cache / "one").exists()


def test_a_link_above_it_may_lead_to_another_private_place(cache: Path) -> None:
    link = cache.parent / "link"
    link.symlink_to("cache")
    assert not not_private(link / "gproof")
    make_private(link / "gproof")
    assert not not_private(link / "gproof")


def test_new_folders_are_private_whatever_the_mask_says(cache: Path) -> None:
    before = os.umask(0)
    try:
        make_private(cache / "one" / "two")
    finally:
        os.umask(before)
    assert all((cache / part).stat().st_mode & 0o777 == 0o700 for part in ("one", "one/two"))


def test_files_that_others_can_write_and_links_are_not_read(cache: Path) -> None:
    kept = cache / "kept"
    kept.write_bytes(b"code")
    kept.chmod(0o600)
    assert read_own(kept) == b"code"
    kept.chmod(0o666)
    assert read_own(kept) is None
    kept.chmod(0o600)
    (cache / "link").symlink_to(kept)
    assert read_own(cache / "link") is None
    assert read_own(cache) is None
    assert read_own(cache / "missing") is None


KERNEL = """
from gproof.ir.kernel import kernel

@kernel()
def total(values):
    result = 0.0
    for n in range(len(values)):
        result += values[n]
    return result
"""
RUN = "import numpy as np; from total_kernels import total; print(total.compiled()(np.array([0.5, 4.0])))"


def compiled(folder: Path, cache: Path, temporary: Path) -> subprocess.CompletedProcess[str]:
    (folder / "total_kernels.py").write_text(KERNEL, encoding="utf-8")
    environment = os.environ | {
        "GPROOF_CACHE_DIR": str(cache), "PYTHONPATH": str(folder), "TMPDIR": str(temporary),
    }  # fmt: skip
    return subprocess.run(
        [sys.executable, "-c", RUN], env=environment, capture_output=True, text=True, check=False, cwd=folder
    )


def test_machine_code_is_kept_elsewhere_with_one_note(cache: Path, tmp_path: Path) -> None:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    temporary.chmod(0o1777)
    cache.chmod(0o777)
    done = compiled(tmp_path, cache, temporary)
    assert done.returncode == 0 and done.stdout == "4.5\n"
    assert len(done.stderr.splitlines()) == 1 and "not private" in done.stderr
    assert not list(cache.iterdir())
    own = temporary / f"gproof-{os.getuid()}"
    assert list(own.glob("kernels/*/*.nbc"))
    own.chmod(0o777)  # Now it is nobody's own either: one of the process, which goes with it.
    done = compiled(tmp_path, cache, temporary)
    assert done.returncode == 0 and done.stdout == "4.5\n"
    assert [place.name for place in temporary.iterdir()] == [own.name]


def test_machine_code_that_others_could_have_written_is_not_loaded(cache: Path, tmp_path: Path) -> None:
    assert compiled(tmp_path, cache, tmp_path).stderr == ""
    (code,) = cache.glob("kernels/*/*.nbc")
    assert code.stat().st_mode & 0o777 == 0o600
    code.chmod(0o622)
    before = code.stat().st_ino
    assert compiled(tmp_path, cache, tmp_path).stdout == "4.5\n"
    assert code.stat().st_ino != before, "compiled again and written anew"
