"""Tools, holders and bodies that must not meet."""
