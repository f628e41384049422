"""A board in a process of its own that speaks the board's side of Klipper's protocol; shares no code with the host."""
