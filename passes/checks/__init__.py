"""Properties that are proved or refuted."""
