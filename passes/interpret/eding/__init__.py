"""What Eding CNC decides (RS274NGC)."""
