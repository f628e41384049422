"""Modelled boards: what controllers' manuals promise, with the pins; their wire protocols are not public."""
