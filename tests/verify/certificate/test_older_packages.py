"""Packages of older versions are read, or refused as older with exit 2: never UNSAFE; and so are those of newer ones.

``packages/format-N.zip`` has what the version that wrote format N made of the jobs of fixture_packages.py; it stays for
ever.
"""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ir.schema_shapes import ROOTS, classes_of
from support.bundles import unpacked
from support.command import in_this_process
from support.goldens import ROOT
from verify.certificate.test_certificate import edit, edited_body
from verify.fixture_packages import JOBS
from verify.package_files import members_of, rebuilt

from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.package import FORMAT, SCHEMAS, read_package

PACKAGES = unpacked("tests/verify/certificate/packages")
CURRENT = PACKAGES / f"format-{FORMAT.partition('/')[2]}"
OLDER = [path for path in sorted(PACKAGES.rglob("*.gpx")) if CURRENT not in path.parents]
READ = sorted(CURRENT.glob("*.gpx"))


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGES).as_posix()


def test_each_format_has_every_job() -> None:
    assert {path.stem for path in READ} == {job.name for job in JOBS}
    kinds = {tuple(path.stem.split("-")) for path in OLDER}
    assert {(d, k) for d in ("eding", "wincnc", "mcuwin") for k in ("zero", "measured", "signed", "ini")} <= kinds


@pytest.mark.parametrize("path", OLDER, ids=name_of)
def test_an_older_one_is_refused_as_older(path: Path, tmp_path: Path) -> None:
    for words in (["verify"], ["verify", "--format", "json"], ["run", "--board", "virtual", "--allow-untrusted"]):
        done = in_this_process([words[0], str(path), *words[1:]], tmp_path)
        said = " ".join((done.out + done.err).split())
        assert done.exit == 2, (words, done)
        assert "GP857" in said and "UNSAFE" not in said, said
        assert re.search(r"made by gproof [0-9.]+, an older version", said), said
        assert "compile the job again" in said, said
    assert not list(tmp_path.glob("*.json"))


def test_the_others_are_refused_before_anything_of_them_is_read(tmp_path: Path) -> None:
    """Format and schemas stand in the body, which is judged first."""
    members = members_of(READ[0])
    for name in [name for name in members if name not in ("body.json", "signature.json")]:
        del members[name]
    edited_body(lambda body: body.update(format="gproof-certificate/5", members={}, sizes={}))(members)
    done = in_this_process(["verify", str(rebuilt(tmp_path / "a.gpx", members, rehash=False))], tmp_path)
    assert done.exit == 2 and "a newer version" in done.out + done.err


@pytest.mark.parametrize("path", READ, ids=name_of)
def test_one_of_this_format_is_read_and_valid(path: Path) -> None:
    """Whatever has been added to the types since."""
    package = read_package(path)
    check = check_package(package)
    findings = {f.code.label for f in check.findings}
    if path.stem.endswith("measured"):
        assert check.valid_if and findings <= {"GP825", "GP826"}
    else:
        assert check.valid and findings <= {"GP826"}
    assert (check.signer is not None) is path.stem.endswith("signed")


@pytest.mark.parametrize("part", SCHEMAS)
@pytest.mark.parametrize(
    ("number", "said"),
    [(-1, "GP820"), (0, "GP820"), (2, "GP857"), (9999, "GP857"), (True, "GP820"), ("1", "GP820"), (None, "GP820"),
     (10_000, "GP820")],
)  # fmt: skip
def test_other_numbers_of_a_schema(part: str, number: Any, said: str, tmp_path: Path) -> None:
    members = members_of(READ[0])
    edited_body(lambda body: body["schemas"].update({part: number}))(members)
    done = in_this_process(["verify", str(rebuilt(tmp_path / "a.gpx", members, rehash=False))], tmp_path)
    assert said in done.out + done.err
    assert done.exit == (2 if said == "GP857" else 1)
    if said == "GP857":
        assert f"a newer version (schema {number} of {part}; this one reads {SCHEMAS[part]})" in done.out + done.err


@pytest.mark.parametrize(
    ("change", "exit_", "said"),
    [
        (lambda body: body.pop("schemas"), 1, "are missing"), (lambda body: body.update(schemas=[1]), 1, "are missing"),
        (lambda body: body["schemas"].pop("trace"), 2, "an older version (schema 0 of trace"),
        (lambda body: body["schemas"].update(plan=1), 2, "a newer version (schema 1 of plan"),
        (lambda body: body.update(gproof="9.1", format="gproof-certificate/77"), 2, "gproof 9.1, a newer version"),
        (lambda body: body.update(gproof="\x1b[31m", format="gproof-certificate/77"), 2, "made by gproof, a newer"),
        (lambda body: body.update(gproof=["9"], format="gproof-certificate/77"), 2, "made by gproof, a newer"),
    ],
)  # fmt: skip
def test_bodies_of_other_versions(change: Any, exit_: int, said: str, tmp_path: Path) -> None:
    members = members_of(READ[0])
    edited_body(change)(members)
    done = in_this_process(["verify", str(rebuilt(tmp_path / "a.gpx", members, rehash=False))], tmp_path)
    assert (done.exit, said in " ".join((done.out + done.err).split())) == (exit_, True), done


@pytest.mark.parametrize(
    ("part", "find", "put"),
    [("machine", "name:", "wobble: 3 name:"), ("machine", "AxisKind.LINEAR", "AxisKind.HELICAL"),
     ("machine", "(Controller", "(Regulator"), ("trace", "Wait.END", "Wait.LUNCH"),
     ("setup", "(Setup", "(Setup mood: 1"),
     ("stream", "(Motor", "(Motor poles: 4")],
)  # fmt: skip
def test_what_a_newer_version_has_added_is_unknown(part: str, find: str, put: str, tmp_path: Path) -> None:
    members = members_of(READ[0])
    edit(f"{part}.ir", find, put)(members)
    members.pop("signature.json", None)
    done = in_this_process(["verify", str(rebuilt(tmp_path / "a.gpx", members))], tmp_path)
    assert (done.exit, "GP857" in done.out + done.err) == (2, True), done
    assert "another version (" in done.out + done.err


# --- a field more ---------------------------------------------------------------------------------------------

MORE = "added_tomorrow"
SCRIPT = """
import dataclasses, json, sys
from pathlib import Path
from gproof.ir.machine import Machine
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.package import parts_of, read_package
from verify.package_files import members_of
said = {}
for name in sys.argv[1:]:
    package = read_package(Path(name))
    check = check_package(package, machine=package.machine, setup=package.setup)
    parts = parts_of(package.machine, package.setup, package.trace, package.stream)
    members = members_of(Path(name))
    said[name] = {
        "findings": [f.message for f in check.findings],
        "valid": check.valid,
        "same": {part for part, data in parts.items() if members[part] != data} == set(),
        "more": sum(f.name == "added_tomorrow" for f in dataclasses.fields(Machine)),
    }
print(json.dumps(said))
"""


def with_a_field_more(source: str, names: set[str]) -> str:
    """The module with one more field, which has a default, in each class of these names."""
    lines = source.splitlines()
    for node in sorted(ast.walk(ast.parse(source)), key=lambda node: -getattr(node, "lineno", 0)):
        if isinstance(node, ast.ClassDef) and node.name in names:
            fields = [one for one in node.body if isinstance(one, ast.AnnAssign)]
            after = fields[-1].end_lineno if fields else node.body[0].end_lineno
            assert after is not None
            lines.insert(after, f"    {MORE}_of_{node.name}: tuple[int, ...] = ()\n    {MORE}: float = 0.5")
    return "\n".join(lines) + "\n"


def answers(site: Path | None) -> Any:
    places = [str(site)] if site else []
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*places, str(ROOT / "tests")]), "PYTHONSAFEPATH": "1"}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *map(str, READ)], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_field_with_a_default_changes_no_certificate(tmp_path: Path) -> None:
    """In every type that a package can hold: the same bytes are read to the same verdict, and written again."""
    names = {cls.__name__ for root, _ in ROOTS.values() for cls in classes_of(root)}
    site = tmp_path / "site" / "gproof"
    site.mkdir(parents=True)
    changed: set[str] = set()
    for folder in (path for path in (ROOT / ".typing" / "gproof").iterdir()):
        if folder.name != "ir":
            (site / folder.name).symlink_to(folder.resolve())
            continue
        for file in folder.resolve().rglob("*.py"):
            target = site / "ir" / file.relative_to(folder.resolve())
            target.parent.mkdir(parents=True, exist_ok=True)
            text = with_a_field_more(file.read_text(encoding="utf-8"), names)
            changed |= set(re.findall(rf"{MORE}_of_(\w+)", text))
            target.write_text(text, encoding="utf-8")
    assert len(changed) > 30
    assert changed == {name for name in names if name in changed or not _is_enum(name)}
    before, after = answers(None), answers(tmp_path / "site")
    assert all(one["same"] and one["more"] == 0 for one in before.values())
    assert all(one["same"] and one["more"] == 1 for one in after.values())
    assert {name: one["findings"] for name, one in before.items()} == {n: one["findings"] for n, one in after.items()}
    assert {name: one["valid"] for name, one in before.items()} == {n: one["valid"] for n, one in after.items()}


def _is_enum(name: str) -> bool:
    from gproof.ir.text import types

    return name in types().enums
