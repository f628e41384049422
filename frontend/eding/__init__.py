"""The Eding CNC dialect: programs and controller files."""
