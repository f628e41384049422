"""Parsers of lark, kept between runs: what lark works out of a grammar takes longer than to read it from a file."""

from __future__ import annotations

import hashlib
import io
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.ir.kernel_cache import write_whole
from gproof.ir.kernel_copies import cache_root
from gproof.ir.private_folder import read_own

if TYPE_CHECKING:
    from lark import Lark

_DIGEST_BYTES = 32


def parser(grammar: Path, start: Sequence[str], transformer: Any) -> Lark:
    """The LALR parser of a grammar, letters of either case; transformer: an object whose methods are its actions.

    A file of the cache is named by what it was made from and holds its own digest; whatever does not fit counts as
    not there, and the parser is made again.
    """
    import lark

    text = grammar.read_text("utf-8")
    # What is kept names the class of the actions by its module.
    actions = f"{type(transformer).__module__}.{type(transformer).__qualname__}"
    made_from = repr((text, tuple(start), actions, lark.__version__, sys.version))
    kept = cache_root() / "grammars" / f"{hashlib.sha256(made_from.encode()).hexdigest()[:32]}.lark"
    content = _read(kept)
    if content is not None:
        # As a stand-alone parser loads itself, which is how lark lets a loaded parser have actions.
        return lark.Lark.__new__(lark.Lark)._load(io.BytesIO(content), transformer=transformer)
    made = lark.Lark(
        text,
        parser="lalr",
        lexer="contextual",
        start=list(start),
        g_regex_flags=re.IGNORECASE | re.ASCII,
        maybe_placeholders=False,
        transformer=transformer,
    )
    saved = io.BytesIO()
    made.save(saved)
    content = saved.getvalue()
    write_whole(kept, hashlib.sha256(content).digest() + content)
    return made


def _read(path: Path) -> bytes | None:
    data = read_own(path)
    if data is None:
        return None
    digest, content = data[:_DIGEST_BYTES], data[_DIGEST_BYTES:]
    return content if content and hashlib.sha256(content).digest() == digest else None
