"""What is known of Eding CNC: tables and settings."""
