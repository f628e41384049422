"""Whether the Trace of a target program means the same as the Trace of its source; shares no code with translation."""
