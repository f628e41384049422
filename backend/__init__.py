"""Streams to boards and programs to dialect text."""
