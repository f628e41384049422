"""Words of RS274/NGC, which Eding CNC, LinuxCNC and grbl share."""
