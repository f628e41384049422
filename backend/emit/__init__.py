"""Programs as text of a dialect."""
