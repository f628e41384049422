"""Patterns, a file for each kind of construct; ``registry.py`` lists them."""
