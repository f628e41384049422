"""Zones to keep out of, and tool change areas."""
