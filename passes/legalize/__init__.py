"""Job -> a Job that a target can print: patterns rewrite what it does not have, or the job is refused."""
