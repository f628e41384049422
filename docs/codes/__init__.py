"""The explanation of every finding code, with a program that gives it and one that does not."""
