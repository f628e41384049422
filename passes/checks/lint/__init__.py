"""What is legal and yet looks wrong."""
