"""What was found, in words. Nothing is decided here."""
