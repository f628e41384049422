"""WinCNC: its machine file, its macro file, its programs."""
