"""What is known of LinuxCNC: it is a target of translation, gproof does not read its programs."""
