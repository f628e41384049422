"""Feeds, spindles, what cuts where it should not."""
