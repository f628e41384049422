"""What a board says that it executed, derived again from the stream. Imports ``ir`` only."""
