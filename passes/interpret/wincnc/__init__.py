"""What WinCNC decides."""
