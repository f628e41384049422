"""The distribution: every folder is listed, the wheel holds the tree and works in an empty venv."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
VERSION = SETTINGS["project"]["version"]
PACKAGES = set(SETTINGS["tool"]["setuptools"]["packages"])
PLACES = SETTINGS["tool"]["setuptools"]["package-dir"]
DOCS_CODES = "gproof.docs_codes"
CODE_PACKAGES = set(PLACES) - {DOCS_CODES}
FIRMWARE = ROOT / "backend" / "firmware"
"""Its images are shipped, its sources are in the source archive."""
NOT_PACKAGES = {"tests", "bench", "scripts", "corpus", "docs", "build", "dist"}


def packages_on_disk() -> set[str]:
    found = {DOCS_CODES}
    for package in CODE_PACKAGES:
        top = ROOT / PLACES[package]
        for folder in {path.parent for path in top.rglob("*.py")}:
            found.add(".".join([package, *folder.relative_to(top).parts]))
    return found


def files_to_ship() -> set[str]:
    shipped = {"gproof/docs_codes/__init__.py", "gproof/docs_codes/pages.txt"}
    for package in CODE_PACKAGES:
        place = PLACES[package]
        for path in (ROOT / place).rglob("*"):
            left_out = path.parent == FIRMWARE and path.suffix in {".c", ".h", ".txt"}
            if (
                path.is_file()
                and not left_out
                and "__pycache__" not in path.parts
                and path.suffix not in {".pyc", ".pyo"}
            ):
                shipped.add(f"{package.replace('.', '/')}/{path.relative_to(ROOT / place).as_posix()}")
    return shipped


def run(*command: str | Path, cwd: Path) -> str:
    """Output of a command that must succeed, away from the checkout's own packages."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command} ended with {done.returncode}:\n{done.stdout}"
    return done.stdout


def test_every_folder_with_python_files_is_listed() -> None:
    assert packages_on_disk() == PACKAGES, "[tool.setuptools] packages in pyproject.toml"


def test_every_package_folder_has_an_init_file() -> None:
    missing = [name for name in PACKAGES if not (ROOT / folder_of(name) / "__init__.py").is_file()]
    assert not missing


def folder_of(package: str) -> str:
    top = next(name for name in PLACES if package == name or package.startswith(f"{name}."))
    return PLACES[top] + package[len(top) :].replace(".", "/")


def test_every_top_level_folder_is_a_subpackage_or_known_not_to_be() -> None:
    folders = {path.parent.name for path in ROOT.glob("[!.]*/*.py")} - NOT_PACKAGES
    assert folders == {PLACES[name] for name in CODE_PACKAGES}


def test_types_and_import_contracts_cover_every_subpackage() -> None:
    links = {f"gproof.{path.name}": path for path in (ROOT / ".typing" / "gproof").iterdir()}
    assert set(links) == CODE_PACKAGES
    for name, link in links.items():
        assert link.resolve() == ROOT / PLACES[name]
        assert (link / "py.typed").is_file()
    assert set(SETTINGS["tool"]["importlinter"]["root_packages"]) == CODE_PACKAGES


def test_nothing_stands_above_the_subpackages() -> None:
    assert "gproof" not in PACKAGES
    assert not (ROOT / "__init__.py").exists()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from the source archive, which is built from a copy of the tree."""
    folder = tmp_path_factory.mktemp("package")
    ignored = shutil.ignore_patterns(".*", "build", "dist", "*.egg-info", "__pycache__")
    shutil.copytree(ROOT, folder / "source", ignore=ignored)
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, "source", cwd=folder)
    assert (folder / f"gproof-{VERSION}.tar.gz").is_file()
    (built,) = folder.glob(f"gproof-{VERSION}-*.whl")
    return built


def test_wheel_holds_every_file_of_the_packages(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if not name.endswith("/")}
    assert {name for name in names if ".dist-info/" not in name} == files_to_ship()
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in names)
    assert len(names) <= 760


def test_wheel_works_in_an_empty_venv(wheel: Path, tmp_path: Path) -> None:
    venv.create(tmp_path / "venv", with_pip=False)
    commands = tmp_path / "venv" / "bin"
    # The lock's versions without its hashes: pip takes no hash for a wheel that was just built.
    locked = re.findall(r"^[\w.-]+==[^\\\n]+", (ROOT / "requirements.lock").read_text(), flags=re.MULTILINE)
    (tmp_path / "constraints.txt").write_text("\n".join(locked))
    pip = (sys.executable, "-m", "pip", "--python", commands / "python", "--disable-pip-version-check")
    install = (*pip, "install", "--no-compile")
    run(*install, "-c", tmp_path / "constraints.txt", wheel, cwd=tmp_path)

    assert VERSION in run(commands / "gproof", "--version", cwd=tmp_path)
    explained = run(commands / "gproof", "explain", "GP301", cwd=tmp_path)
    assert "GP301" in explained
    assert "soft-limit" in explained
    assert "```gcode bad.cnc" in explained
    for code in ("GP301", "GP603", "GP857"):
        page = (ROOT / "docs" / "codes" / f"{code}.md").read_text("utf-8")
        assert run(commands / "gproof", "explain", code, "--files", cwd=tmp_path).startswith(page)

    # A drawing of the part needs the extra; without it the command says so, and how to get it.
    shop = shutil.copytree(ROOT / "corpus" / "eding" / "clamped-bracket", tmp_path / "shop")
    check = (commands / "gproof", "check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml")
    refused = subprocess.run(check, cwd=shop, capture_output=True, encoding="utf-8", check=False)
    assert refused.returncode == 3
    assert "pip install 'gproof[dxf]'" in refused.stdout + refused.stderr
    run(*install, "-c", tmp_path / "constraints.txt", "gproof[dxf]", cwd=tmp_path)
    assert "job.cnc: SAFE" in run(*check, cwd=shop)
