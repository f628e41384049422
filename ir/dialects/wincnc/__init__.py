"""What is known of WinCNC: tables and settings."""
