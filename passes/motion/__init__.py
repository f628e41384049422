"""From Trace to steps: plans, streams, height compensation."""
