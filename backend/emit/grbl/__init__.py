"""Jobs as text of grbl 1.1."""

from __future__ import annotations
