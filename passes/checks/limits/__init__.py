"""Travel limits and work boundaries."""
