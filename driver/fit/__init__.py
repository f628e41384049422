"""Where a job's work zero may be."""
