"""Tools: their shapes, and where their tips are."""
