"""What all controllers share: control flow, expressions, loops, state, rows of the Trace."""
