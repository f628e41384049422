"""What each finding code means, with a program that gives it and one that does not."""
