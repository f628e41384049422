"""What is left of the stock, and what is cut too deep."""
