"""Independent checkers and the certificate; shares code only with the IR."""
