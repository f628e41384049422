"""Jobs as text of LinuxCNC."""

from __future__ import annotations
