"""Boards that speak Klipper's micro-controller protocol, by a serial line: unmodified firmware, or ours."""
