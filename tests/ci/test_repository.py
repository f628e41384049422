"""What the hosting site reads (.github/, SECURITY.md, CITATION.cff) fits its public schemas and names what exists."""

from __future__ import annotations

import json
import re
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from jsonschema.validators import validator_for
from ruamel.yaml import YAML
from support.goldens import ROOT

READER = YAML(typ="safe", pure=True)
GITHUB = ROOT / ".github"
FORMS = sorted(set((GITHUB / "ISSUE_TEMPLATE").glob("*.yml")) - {GITHUB / "ISSUE_TEMPLATE" / "config.yml"})
SCHEMAS = {
    **dict.fromkeys((GITHUB / "workflows").glob("*.yml"), "github-workflows"),
    **dict.fromkeys(FORMS, "github-issue-forms"),
    GITHUB / "ISSUE_TEMPLATE" / "config.yml": "github-issue-config",
    GITHUB / "dependabot.yml": "dependabot",
    ROOT / "CITATION.cff": "citation-file-format",
}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PINNED = re.compile(r"uses: ([\w-]+/[\w./-]+)@([0-9a-f]{40}) # v\d+\.\d+\.\d+$")


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def read(path: Path) -> Any:
    return READER.load(path)


def test_every_file_for_the_site_is_known_here() -> None:
    known = {*SCHEMAS, GITHUB / "pull_request_template.md"}
    assert {path for path in GITHUB.rglob("*") if path.is_file()} == known - {ROOT / "CITATION.cff"}


@pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
def test_it_fits_the_public_schema(path: Path) -> None:
    vendored = resources.files("check_jsonschema") / "builtin_schemas" / "vendor" / f"{SCHEMAS[path]}.json"
    schema = json.loads(vendored.read_text(encoding="utf-8"))
    validator = validator_for(schema)(schema)
    assert [error.message for error in validator.iter_errors(read(path))] == []
    assert not validator.is_valid(["no", "table"])


def test_the_workflow_runs_ci_in_debian_12_with_few_rights() -> None:
    text = (GITHUB / "workflows" / "ci.yml").read_text(encoding="utf-8")
    page = READER.load(text)
    (job,) = page["jobs"].values()
    assert job["container"] == "debian:12"
    assert page["permissions"] == {"contents": "read"}
    assert job["timeout-minutes"] <= 90
    assert "concurrency" in page
    assert job["steps"][-1]["run"] == "bash .ci/run"
    assert (ROOT / ".ci" / "run").is_file()
    uses = [line.strip().removeprefix("- ") for line in text.splitlines() if "uses:" in line]
    assert uses
    assert [line for line in uses if not PINNED.fullmatch(line)] == [], (
        "an action without a full commit and its version"
    )


@pytest.mark.parametrize("path", FORMS, ids=name_of)
def test_forms_ask_for_each_thing_once(path: Path) -> None:
    asked = [part["id"] for part in read(path)["body"] if part["type"] != "markdown"]
    assert len(asked) == len(set(asked))
    assert asked


def test_a_wrong_verdict_comes_with_all_that_repeats_it() -> None:
    parts = read(GITHUB / "ISSUE_TEMPLATE" / "wrong-verdict.yml")["body"]
    required = {part["id"] for part in parts if part.get("validations", {}).get("required")}
    assert required >= {"job", "machine", "setup", "command", "said", "right", "version"}
    (note,) = (part["attributes"]["value"] for part in parts if part["type"] == "markdown")
    assert "SECURITY.md" in note
    assert "public" in note


@pytest.mark.parametrize("path", [*FORMS, GITHUB / "pull_request_template.md"], ids=name_of)
def test_pages_of_the_repository_that_it_links_exist(path: Path) -> None:
    linked = re.findall(r"\]\(\.\./blob/HEAD/([^)#]+)", path.read_text(encoding="utf-8"))
    assert [name for name in linked if not (ROOT / name).is_file()] == []


def test_targets_that_a_contributor_is_asked_to_run_exist() -> None:
    targets = re.findall(r"`make ([a-z]+)", (GITHUB / "pull_request_template.md").read_text(encoding="utf-8"))
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert targets
    assert [name for name in targets if f"\n{name}:" not in makefile] == []


def test_the_readme_is_one_look() -> None:
    """A picture, how to install, what SAFE means and the command of the tests, within 150 lines."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 150
    for part in ("](docs/images/", "\npipx install ", "](docs/tutorial.md)", "\n## What SAFE means", "`make test`"):
        assert part in text, part
    shown = re.findall(r"^(?:job|[\w-]+)\.\w+: (SAFE|UNSAFE)$", text, flags=re.MULTILINE)
    assert sorted(set(shown)) == ["SAFE", "UNSAFE"]


def test_changes_of_a_release_are_short_and_in_groups() -> None:
    """As keepachangelog.com has it: what is not released yet first, then versions with a day, newest first."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    heads = re.findall(r"^## (.+)$", text, flags=re.MULTILINE)
    assert heads[0] == "Unreleased"
    assert all(re.fullmatch(r"\d+\.\d+\.\d+ - \d{4}-\d\d-\d\d", head) for head in heads[1:])
    groups = set(re.findall(r"^### (.+)$", text, flags=re.MULTILINE))
    assert groups <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    released = text.split(f"\n## {heads[1]}\n", 1)[1].splitlines()
    assert [line for line in released if line.startswith(" ")] == [], "an entry of a release is one line"
    assert [line for line in released if len(line) > 180] == []


def test_citation_and_project_say_the_same() -> None:
    cited = read(ROOT / "CITATION.cff")
    assert (cited["version"], cited["license"]) == (PROJECT["version"], PROJECT["license"])
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## {cited['version']} - {cited['date-released']}\n" in changes
    assert all(set(author) == {"name"} for author in cited["authors"])
