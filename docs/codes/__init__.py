"""The page of every finding code, with programs that give it and programs that do not."""
