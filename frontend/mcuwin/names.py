"""Names of labels and modules (McuWIN manual 4.15, 4.16, 5.1)."""

from __future__ import annotations

import re

LABEL = re.compile(r"[Ll][ \t]*([0-9]+)", re.ASCII)
NAME = re.compile(r"[A-Za-z0-9_]+", re.ASCII)


def label_name(text: str) -> str:
    """In lower case; of digits without leading zeros, so that ``L0114`` is ``L114``."""
    return str(int(text)) if text.isascii() and text.isdigit() and len(text) < 1000 else text.lower()


EXTENSIONS = (".pim", ".din", ".src", ".inc")
"""Of programs, and of files that they include."""
INCLUDE_FILES = (".inc",)
"""Extensions of files that are no jobs."""
