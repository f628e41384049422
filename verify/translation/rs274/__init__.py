"""What a LinuxCNC or grbl program does, for the words that a translation has; read from the text alone."""

from __future__ import annotations
