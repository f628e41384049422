"""Where an axis, a motor or the tool may be: extents, height maps, pitch, backlash."""
