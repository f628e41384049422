"""What is known of grbl 1.1: it is a target of translation, gproof does not read its programs."""
