""".pre-commit-hooks.yaml: the hooks run by pre-commit itself, from a local clone, without a network."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from ruamel.yaml import YAML
from support.distribution import OFFLINE, copy_of_the_source
from support.goldens import ROOT

from gproof.driver.dialects import extensions, frontends
from gproof.ir.kernel_copies import cache_root

HOOKS = {hook["id"]: hook for hook in YAML(typ="safe", pure=True).load(ROOT / ".pre-commit-hooks.yaml")}
PLATE = ROOT / "corpus" / "eding" / "drilled-plate"
CONFIG = """
repos:
- repo: {source}
  rev: {revision}
  hooks:
  - id: gproof-fmt
  - id: gproof-check
    args: [--machine, machine.toml, --setup, zero]
"""


def takes(hook: str, name: str) -> bool:
    """Whether a hook is given a file of that name."""
    leave = HOOKS[hook].get("exclude")
    return bool(re.search(HOOKS[hook]["files"], name)) and not (leave and re.search(leave, name))


def test_files_are_those_that_the_commands_look_for() -> None:
    no_jobs = {extension for one in frontends() for extension in one.no_jobs}
    never = {name for one in frontends() for name in one.never}
    for extension in [*extensions(), ".toml", ".md", ".ini", ".cncx"]:
        for form in (str.lower, str.upper):
            name = form(f"jobs/part{extension}")
            assert takes("gproof-check", name) == (extension in extensions() and extension not in no_jobs), name
            assert takes("gproof-fmt", name) == (extension in extensions() and extension not in {".txt", ".iso"}), name
    assert not any(takes("gproof-check", f"{folder}{name}") for name in never for folder in ("", "shop/"))
    assert takes("gproof-check", "my-macro.cnc")
    assert takes("gproof-fmt", "shop/macro.cnc")
    # By content some jobs are no text: one that ends in Ctrl-Z would be left out without a word.
    assert [hook["types"] for hook in HOOKS.values()] == [["file"], ["file"]]


def test_pre_commit_runs_both_hooks(tmp_path: Path) -> None:
    environment = {
        **{k: v for k, v in os.environ.items() if not k.startswith(("GIT_", "PRE_COMMIT_", "XDG_"))},
        **OFFLINE, "HOME": str(tmp_path), "PRE_COMMIT_HOME": str(tmp_path / "cache"), "GIT_CONFIG_NOSYSTEM": "1",
        "GPROOF_CACHE_DIR": str(cache_root()),
    }  # fmt: skip

    def run(folder: Path, *words: str) -> tuple[int, str]:
        done = subprocess.run(
            words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, encoding="utf-8", check=False,
        )  # fmt: skip
        return done.returncode, done.stdout

    def commit(folder: Path) -> str:
        who = ("-c", "user.name=t", "-c", "user.email=t@example.org", "-c", "init.defaultBranch=main")
        for words in (("init", "-q"), ("add", "-A"), ("commit", "-q", "-m", "all"), ("rev-parse", "HEAD")):
            code, out = run(folder, "git", *who, *words)
            assert code == 0, out
        return out.strip()

    pre_commit = (sys.executable, "-P", "-m", "pre_commit")
    source = copy_of_the_source(tmp_path / "source")
    code, out = run(source, *pre_commit, "validate-manifest", ".pre-commit-hooks.yaml")
    assert code == 0, out
    shop = tmp_path / "shop"
    shop.mkdir()
    config = CONFIG.format(source=source, revision=commit(source))
    (shop / ".pre-commit-config.yaml").write_text(config, encoding="utf-8")
    shutil.copy(PLATE / "machine.toml", shop)
    (shop / "good.cnc").write_text("G21 G90\nG0 X10\nM30\n", encoding="utf-8")
    (shop / "README.md").write_text("G0 X9000\n", encoding="utf-8")
    commit(shop)
    code, out = run(shop, *pre_commit, "run", "--all-files", "--verbose")
    assert code == 0, out
    assert "good.cnc: SAFE" in out
    (shop / "bad one.cnc").write_text("g21 g90\nG1 x9000 F600\nM30\n", encoding="utf-8")
    run(shop, "git", "add", "-A")
    code, out = run(shop, *pre_commit, "run")
    assert code == 1, out
    assert "files were modified by this hook" in out
    assert "bad one.cnc: UNSAFE" in out
    assert "GP301" in out
    assert (shop / "bad one.cnc").read_text(encoding="utf-8").startswith("G21 G90\nG1 X9000 F600\n")


def test_no_example_of_a_ci_run_takes_the_setup_zero() -> None:
    """It stands for a machine that nobody has: its SAFE says nothing of the shop's own."""
    for name in ("action.yml", "docs/examples/gproof.yml", ".pre-commit-hooks.yaml"):
        assert not re.search(r"\bzero\b", (ROOT / name).read_text(encoding="utf-8")), name
    for name in ("README.md", "docs/ci.md"):
        blocks = re.findall(r"```(?:yaml|toml)\n(.*?)```", (ROOT / name).read_text(encoding="utf-8"), re.S)
        assert blocks
        assert not any(re.search(r"\bzero\b", block) for block in blocks), name
    assert "--setup zero |" not in (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
