"""From a command to a judgement: what every front end of gproof shares (command line, and later an editor)."""
