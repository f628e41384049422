"""Pictures of jobs (SVG)."""
