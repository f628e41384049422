"""Programs executed: from Program to Trace."""
