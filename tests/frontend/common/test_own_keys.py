"""gproof's own files are strict: the table of keys is what the readers ask for, and no misspelt key passes.

Each mistake is made from the table: a key with a letter changed, with dashes, a table renamed, a key in another table.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from gproof.cli.main import main
from gproof.cli.telling import tell
from gproof.driver.dialects import load_machine, load_setup
from gproof.driver.errors import Tell, UsageError
from gproof.driver.jobs import read_job_file
from gproof.driver.policy import load_policy
from gproof.frontend.common.own_keys import KEYS, Keys, suggestion
from gproof.frontend.common.toml_table import TomlFile
from gproof.ir.finding import Findings

Path_ = tuple[str, ...]
HEADS = {
    "gproof-machine/1": 'schema = "gproof-machine/1"\nunits = "mm"\n',
    "gproof-setup/1": 'schema = "gproof-setup/1"\n',
    "gproof-policy/1": 'schema = "gproof-policy/1"\n',
    "gproof-job/1": 'schema = "gproof-job/1"\njob = "job.cnc"\n',
}
NAMES = {
    "axes": "x", "areas": "tool_change", "tools": "1", "spindles": "1", "task0": "M3", "work": "1", "heads": "1",
    "parameters": "100", "resident": "CI601", "positions": "P4", "inputs": "1", "outputs": "1", "virtual_inputs": "1",
    "motors": "x", "layers": "cut", "severity": "GP260",
}  # fmt: skip
"""A name that each table of names takes."""
LISTS = {"slaves", "keep_out", "pockets", "fixtures", "jobs"}
"""Tables of which there are lists."""


def tables(keys: Keys, path: Path_ = ()) -> Iterator[tuple[Path_, Keys]]:
    """Every table with keys of its own; ``*`` for a name."""
    yield path, keys
    for name, inner in keys.tables.items():
        yield from tables(inner, (*path, name))
    if keys.named is not None:
        yield from tables(keys.named, (*path, "*"))


def header(path: Path_) -> str:
    """The line that begins a table; "" at the top."""
    if not path:
        return ""
    named = [NAMES[before] if name == "*" else name for before, name in zip(("", *path), path, strict=False)]
    around = "".join(
        f"[[{'.'.join(named[: n + 1])}]]\n" for n, name in enumerate(path[:-1]) if name in LISTS
    )  # fmt: skip
    return around + (f"[[{'.'.join(named)}]]\n" if path[-1] in LISTS else f"[{'.'.join(named)}]\n")


WHERE = [
    pytest.param(schema, path, keys, id=f"{schema.split('/')[0]}:{'.'.join(path)}")
    for schema in HEADS
    for path, keys in tables(KEYS[schema])
    if keys.own or keys.tables
]


def hints(schema: str, folder: Path, text: str) -> dict[str, tuple[str, int]]:
    """By key, the hint and line of each GP611."""
    (folder / "file.toml").write_text(text)
    findings = Findings(limit=1000)
    file = folder / "file.toml"
    if schema == "gproof-machine/1":
        machine, _ = load_machine(file, findings)
        assert machine is None or not findings.counts.get(611)
    elif schema == "gproof-setup/1":
        setup, _ = load_setup(file, findings)
        assert setup is None or not findings.counts.get(611)
    else:
        load: Callable[[Path, Tell], object] = load_policy if schema == "gproof-policy/1" else read_job_file
        told = TomlFile(file, schema, findings)
        told.finish()
        if findings.counts.get(611):
            with pytest.raises(UsageError):
                load(file, tell)
    return {
        dict(f.values)["key"].rpartition(".")[2]: (f.hint, f.span.line)  # type: ignore[attr-defined]
        for f in findings.kept
        if f.code.number == 611
    }


def misspelt(key: str) -> str:
    """One letter other."""
    at = len(key) // 2
    return key[:at] + ("q" if key[at] != "q" else "k") + key[at + 1 :]


@pytest.mark.parametrize(("schema", "path", "keys"), WHERE)
def test_each_key_with_a_letter_changed(schema: str, path: Path_, keys: Keys, tmp_path: Path) -> None:
    """All at once: each is reported, at its line, with what it may mean."""
    wrong = {misspelt(key): key for key in (*sorted(keys.own), *sorted(keys.tables))}
    before = HEADS[schema] + header(path) if path else HEADS[schema]
    told = hints(schema, tmp_path, before + "".join(f"{key} = 1\n" for key in wrong))
    first = before.count("\n") + 1
    for line, (key, meant) in enumerate(wrong.items(), first):
        assert told[key][1] == line, key
        assert repr(meant) in told[key][0] if len(meant) > 1 else f"{meant}" in told[key][0], (key, told[key])


@pytest.mark.parametrize(("schema", "path", "keys"), WHERE)
def test_a_table_renamed(schema: str, path: Path_, keys: Keys, tmp_path: Path) -> None:
    for key in keys.tables:
        for other in {misspelt(key), key.replace("_", ""), key + "s"} - {key, *keys.own, *keys.tables}:
            text = HEADS[schema] + header((*path, key)).replace(key, other) + "x = [0.0, 1.0]\n"
            told = hints(schema, tmp_path, text)
            assert repr(key) in told[other][0], (other, told)


@pytest.mark.parametrize(("schema", "path", "keys"), WHERE)
def test_a_key_in_the_wrong_table(schema: str, path: Path_, keys: Keys, tmp_path: Path) -> None:
    """Every key of two letters or more of the other tables."""
    others = {key: other for other, them in tables(KEYS[schema]) for key in them.own if len(key) > 1}
    strange = {key: place for key, place in others.items() if not keys.knows(key)}
    text = (HEADS[schema] + header(path) if path else HEADS[schema]) + "".join(f"{key} = 1\n" for key in strange)
    told = hints(schema, tmp_path, text)
    for key in strange:
        assert f"{key!r} of " in told[key][0], (key, told.get(key))


@pytest.mark.parametrize(("schema", "path", "keys"), WHERE)
def test_dashes_are_underscores(schema: str, path: Path_, keys: Keys, tmp_path: Path) -> None:
    """The same findings, of values too, whichever of both is written."""
    found = []
    for sign in "_-":
        text = HEADS[schema] + (header(path) if path else "")
        text += "".join(f"{key.replace('_', sign)} = -1.5\n" for key in sorted(keys.own) if "_" in key)
        (tmp_path / "file.toml").write_text(text)
        findings = Findings(limit=1000)
        if schema == "gproof-machine/1":
            load_machine(tmp_path / "file.toml", findings)
        elif schema == "gproof-setup/1":
            load_setup(tmp_path / "file.toml", findings)
        else:
            continue
        found.append(sorted((f.span.line, f.code.number, f.message.replace("-", "_")) for f in findings.kept))
        assert 611 not in findings.counts, found
    assert len(set(map(str, found))) <= 1


@pytest.mark.parametrize("schema", [schema for schema in HEADS if schema != "gproof-job/1"])
def test_both_spellings_of_a_key_are_an_error(schema: str, tmp_path: Path) -> None:
    key = next(key for key in sorted(KEYS[schema].own) if "_" in key)
    (tmp_path / "file.toml").write_text(HEADS[schema] + f"{key} = 1\n{key.replace('_', '-')} = 1\n")
    findings = Findings()
    assert TomlFile(tmp_path / "file.toml", schema, findings).errors == 1
    (finding,) = findings.kept
    assert (finding.code.number, finding.span.line) == (603, HEADS[schema].count("\n") + 2)
    assert "both are the same key" in finding.message


def test_names_keep_their_dashes(tmp_path: Path) -> None:
    (tmp_path / "policy.toml").write_text(HEADS["gproof-policy/1"] + '[severity]\noperator-stop = "warning"\n')
    assert load_policy(tmp_path / "policy.toml", tell).severity
    (tmp_path / "machine.toml").write_text(
        HEADS["gproof-machine/1"] + "[areas.left-clamp]\nx = [0, 1]\n[areas.left_clamp]\nx = [2, 3]\n"
    )
    machine, _ = load_machine(tmp_path / "machine.toml", Findings())
    assert machine is not None
    assert [area.name for area in machine.keep_out] == ["left-clamp", "left_clamp"]


def asked_for(schema: str, path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[Path_, set[str]]:
    """What the readers take from a file, by table."""
    files: list[TomlFile] = []
    plain = TomlFile.__init__

    def remember(self: TomlFile, *values: object) -> None:
        files.append(self)
        plain(self, *values)  # type: ignore[arg-type]

    monkeypatch.setattr(TomlFile, "__init__", remember)
    if schema == "gproof-machine/1":
        load_machine(path, Findings())
    elif schema == "gproof-setup/1":
        load_setup(path, Findings())
    else:
        with contextlib.suppress(UsageError):
            (load_policy if schema == "gproof-policy/1" else read_job_file)(path, tell)
    (file,) = [one for one in files if one.schema == schema]
    return {tuple(part.partition("[")[0] for part in path): taken for path, taken in file.taken.items()}


def everything(keys: Keys, path: Path_ = (), without: frozenset[str] = frozenset()) -> str:
    """Every table of a file, empty."""
    text = "" if not path else header(path)
    for name, inner in keys.tables.items():
        if name not in without:
            text += everything(inner, (*path, name), without)
    if keys.named is not None and (keys.named.own or keys.named.tables):
        text += everything(keys.named, (*path, "*"), without)
    return text


BODIES = ("stock", "part", "fixtures")
SHAPES = {
    "gproof-machine/1": ["[[keep_out]]\npolygon = 1\n", "[controller]\nmacro_file = 1\n"],
    "gproof-setup/1": [
        "[[keep_out]]\npolygon = 1\n",
        '[height_map]\nfile = "none"\n',
        "[stock]\ncylinder = {x = 1}\n",
        "[stock]\nbox = 1\n",
        "[stock]\npolygon = [[0, 0], [9, 0], [9, 9]]\nbottom = 0\ntop = 9\n"
        "[[stock.pockets]]\nfloor = 5\npolygon = [[1, 1], [2, 1], [2, 2]]\n",
        '[stock]\ndxf = "none"\n',
        '[stock]\nstl = "none"\n',
        "[stock]\ndxf = 1\nlayers = {cut = {top = 1}}\n",
    ],
    "gproof-policy/1": [],
    "gproof-job/1": [],
}
"""Tables that read other keys where they have some."""


def test_the_table_lists_what_the_readers_ask_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A key that a reader takes and the table lacks has no hint; one that nobody takes would be read and dropped."""
    file = tmp_path / "file.toml"
    for schema, head in HEADS.items():
        taken: dict[Path_, set[str]] = {}
        for text in (everything(KEYS[schema], without=frozenset(BODIES)), *SHAPES[schema]):
            file.write_text(head + text)
            with monkeypatch.context() as patch:
                for place, found in asked_for(schema, file, patch).items():
                    taken.setdefault(place, set()).update(found)
        for path, keys in tables(KEYS[schema]):
            # What bodies of a kind have is looked at once; the layers of a drawing are read where there is one.
            if path[:1] in (("part",), ("fixtures",)) or "layers" in path or keys.named is not None:
                continue
            named = tuple(NAMES[before] if n == "*" else n for before, n in zip(("", *path), path, strict=False))
            asked, known = taken.get(named, set()), keys.own | keys.tables.keys()
            assert asked <= known, ("KEYS in frontend/common/own_keys.py lacks", schema, path, asked - known)
            # Which letters axes have is the machine's.
            assert known - asked <= {"u", "v", "w"}, (schema, path, known - asked)


@pytest.mark.parametrize("text", ['[[keepout]]\nname = "a"\nx = [0.0, 1.0]\n', "max-rpms = 3\n"])
def test_nothing_is_silent_with_quiet(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "job.cnc").write_text("G21 G90 G94 G17 G40 G49 G54\nG0 Z5\nM30\n")
    (tmp_path / "machine.toml").write_text(HEADS["gproof-machine/1"] + text)
    several = [str(tmp_path / "job.cnc"), str(tmp_path / "job.cnc")]
    for jobs in (several[:1], several):
        code = main(["check", *jobs, "-q", "--machine", str(tmp_path / "machine.toml"), "--setup", "zero"])
        told = capsys.readouterr()
        assert code == 3
        assert "SAFE" not in told.out
        assert "GP611" in told.out + told.err
        assert "did you mean" in told.out + told.err


@pytest.mark.parametrize("key", ["strict", "fail-on", "fail_on"])
def test_policies_and_job_files_take_the_options(key: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "job.cnc").write_text("G21 G90 G94 G17 G40 G49 G54\nG0 Z5\nM30\n")
    machine = "".join(f"[axes.{axis}]\nmin = 0.0\nmax = 300.0\n" for axis in "xyz")
    (tmp_path / "machine.toml").write_text(HEADS["gproof-machine/1"] + machine)
    words = ["check", str(tmp_path / "job.cnc"), "--machine", str(tmp_path / "machine.toml"), "-q"]
    assert main(words) == 0
    (tmp_path / "policy.toml").write_text(
        HEADS["gproof-policy/1"] + (f"{key} = true\n" if key == "strict" else f'{key} = "note"\n')
    )
    policy = load_policy(tmp_path / "policy.toml", tell)
    assert (policy.strict, policy.fail_on) == ((True, "unknown") if key == "strict" else (False, "note"))
    assert main([*words, "--policy", str(tmp_path / "policy.toml")]) == (2 if key == "strict" else 0)
    capsys.readouterr()


def test_strict_of_a_job_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A table of its own takes back what the top of the file says; neither takes back an option or a policy."""
    (tmp_path / "job.cnc").write_text("G21 G90 G94 G17 G40 G49 G54\nG0 Z5\nM30\n")
    machine = "".join(f"[axes.{axis}]\nmin = 0.0\nmax = 300.0\n" for axis in "xyz")
    (tmp_path / "machine.toml").write_text(HEADS["gproof-machine/1"] + machine)
    (tmp_path / "policy.toml").write_text(HEADS["gproof-policy/1"] + "strict = true\n")
    for top, own, policy, option, code in (
        ("true", "", False, False, 2), ("true", "false", False, False, 0), ("false", "true", False, False, 2),
        ("", "", False, False, 0), ("", "false", True, False, 2), ("false", "false", False, True, 2),
    ):  # fmt: skip
        text = 'schema = "gproof-job/1"\nmachine = "machine.toml"\n'
        text += (f"strict = {top}\n" if top else "") + ('policy = "policy.toml"\n' if policy else "")
        text += '[[jobs]]\njob = "job.cnc"\n' + (f"strict = {own}\n" if own else "")
        (tmp_path / "jobs.toml").write_text(text)
        words = ["check", str(tmp_path / "jobs.toml"), "-q", *(["--strict"] if option else [])]
        assert main(words) == code, text
    capsys.readouterr()


@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("keepout", "did you mean 'keep_out'?"),
        ("KEEP-OUT", "did you mean 'keep_out'?"),
        ("laf_angle", "did you mean 'laf_angle' of [controller]?"),
        ("homed", "did you mean 'homed' of a setup file (--setup)?"),
        ("clear_z", "did you mean 'clear_z' of [tool_change]?"),
    ],
)
def test_suggestions(word: str, hint: str) -> None:
    keys = KEYS["gproof-machine/1"]
    assert suggestion(word, "gproof-machine/1", (*keys.own, *keys.tables), ()) == hint
