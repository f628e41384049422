"""What is known of McuWIN: tables and settings."""
