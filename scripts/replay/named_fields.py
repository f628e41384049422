"""The mapping of one announced change: text forms with named fields, and a Machine's settings in one object.

Before it (format 3 of packages) a dataclass printed all of its fields in their order; since then (format 4) those that
have not their default, by name. Both texts are brought to the first form, token by token: what is left of a difference
is one of content. The body of a package names its texts by hash and size: each is checked against the text of its own
side, and replaced by those of the common form; so is the body's own hash, which ``compile`` prints.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Texts = dict[str, str]
Fields = dict[str, list[tuple[str, str | None]]]
"""By class, in order, its fields and the text of their defaults before the change; None: there is none."""

PARTS = ("machine.ir", "setup.ir", "stream.ir", "trace.ir")
STAGES = ("program", "trace", "plan", "stream")
_ERRORS = "\n--- standard error\n"
_TOKEN = re.compile(r'(?:\s+|;[^\n]*)*+([()\[\]{}]|b?"(?:[^"\\]|\\.)*+"|[^\s()\[\]{};"]+|$)', re.DOTALL)
_OF_EDING = ("macro_file", "super_long_file", "thread_peak")
_SETTINGS = {"Settings": "", "EdingSettings": "", "WinCncSettings": "Controls", "McuWinSettings": "Din"}

_ASK = """
import dataclasses, json
from gproof.ir import text
def default(field):
    made = field.default_factory
    value = field.default if made is dataclasses.MISSING else made()
    try:
        return None if value is dataclasses.MISSING else text.print_ir(value)
    except TypeError:
        return None
found = {name: text._fields(cls) for name, cls in text._registry()[0].items()}
print(json.dumps({name: [(field.name, default(field)) for field in fields] for name, fields in found.items()}))
"""


def fields_before(base: Path) -> Fields:
    """What the classes of the revision before the change have."""
    environment = {**os.environ, "PYTHONPATH": str(base), "PYTHONSAFEPATH": "1"}
    done = subprocess.run([sys.executable, "-c", _ASK], env=environment, capture_output=True, text=True, check=True)
    found: Fields = json.loads(done.stdout)
    return found


class Mapping:
    """Both sides in one form; see the module's text."""

    def __init__(self, base: Path) -> None:
        self._fields = fields_before(base)

    def common(self, before: Texts, now: Texts) -> tuple[Texts, Texts]:
        """The texts of one program, by aspect, as far as the change touches them."""
        return self._side(before, named=False), self._side(now, named=True)

    def _side(self, texts: Texts, *, named: bool) -> Texts:
        found = dict(texts)
        for stage in STAGES:
            name = f"dump, {stage}"
            if name in texts:
                printed, mark, errors = texts[name].partition(_ERRORS)
                found[name] = self.plain(printed, named=named) + mark + errors
        for part in PARTS:
            if f"compile, {part}" in texts:
                found[f"compile, {part}"] = self.plain(texts[f"compile, {part}"], named=named)
        body = texts.get("compile, body", "")
        if body.startswith("{"):
            found["compile, body"] = _body(json.loads(body), texts, found, named=named)
            own = hashlib.sha256(body.encode()).hexdigest()
            found["compile"] = texts["compile"].replace(f"certificate {own}", "certificate OF THE BODY")
        return found

    def plain(self, text: str, *, named: bool) -> str:
        """A text form with every field in its place, a token a line; an empty text as it is."""
        if not text.strip():
            return text
        tokens = iter([*filter(None, _TOKEN.findall(text))])
        node = _node(next(tokens), tokens)
        rest = next(tokens, None)
        assert rest is None, rest
        return "\n".join(_flat(self._before(node) if named else node, ""))

    def _before(self, node: Any) -> Any:
        """A node with named fields as it printed before."""
        if not isinstance(node, list):
            return node
        head, *parts = node
        if head in ("[", "{") or parts[0] in ("columns", "LanguageRules"):
            return [head, *map(self._before, parts)]
        name, *words = parts
        stated = {word.removesuffix(":"): part for word, part in zip(words[::2], words[1::2], strict=True)}
        if name in _SETTINGS:
            return self._object(_SETTINGS[name] or "Controller", stated)
        if name == "Machine":
            settings = stated.pop("settings", ["(", "Settings"])
            stated["controller"] = self._controller(stated.get("controller", ["(", "Controller"]), settings)
        return self._object(name, stated)

    def _controller(self, controller: list[Any], settings: list[Any]) -> list[Any]:
        """A Controller as it was: with the settings in it."""
        stated = dict(zip(controller[2::2], controller[3::2], strict=True))
        kind, of = settings[1], dict(zip(settings[2::2], settings[3::2], strict=True))
        if kind == "EdingSettings":
            stated |= {f"{name}:": of.pop(f"{name}:") for name in _OF_EDING if f"{name}:" in of}
            assert not of, of
        elif _SETTINGS[kind]:
            stated[f"{_SETTINGS[kind].lower()}:"] = settings
        return ["(", "Controller", *(word for pair in stated.items() for word in pair)]

    def _object(self, name: str, stated: dict[str, Any]) -> list[Any]:
        out: list[Any] = ["(", name]
        for field, default in self._fields[name]:
            if field in stated:
                out.append(self._before(stated.pop(field)))
            else:
                assert default is not None, f"{name}.{field} is missing"
                tokens = iter([*filter(None, _TOKEN.findall(default))])
                out.append(_node(next(tokens), tokens))
        assert not stated, f"{name} has {sorted(stated)}"
        return out


def _node(token: str, tokens: Iterator[str]) -> Any:
    """A token, or a list of its opening bracket and what is in it."""
    if token not in ("(", "[", "{"):
        return token
    out: list[Any] = [token]
    for inner in tokens:
        if inner in (")", "]", "}"):
            return out
        out.append(_node(inner, tokens))
    raise ValueError("a text form ends too early")


def _flat(node: Any, indent: str) -> Iterator[str]:
    if not isinstance(node, list):
        yield indent + node
        return
    yield indent + node[0]
    if len(node) > 1 and node[1] == "columns":
        yield indent + " ".join(node[1:])
        return
    for part in node[1:]:
        yield from _flat(part, indent + " ")


def _body(body: dict[str, Any], texts: Texts, plain: Texts, *, named: bool) -> str:
    """The body with the hashes and sizes of its texts as they are in the common form, and the format of the change."""
    assert body["format"] == f"gproof-certificate/{4 if named else 3}"
    assert body.pop("schemas", None) == ({"machine": 1, "setup": 1, "stream": 1, "trace": 1} if named else None)
    body["format"] = "FORMAT"
    for part in PARTS:
        data, common = texts[f"compile, {part}"].encode(), plain[f"compile, {part}"].encode()
        assert body["members"][part] == hashlib.sha256(data).hexdigest() and body["sizes"][part] == len(data), part
        body["members"][part], body["sizes"][part] = hashlib.sha256(common).hexdigest(), len(common)
    return json.dumps(body, indent=1, sort_keys=True)
