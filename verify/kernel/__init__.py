"""What must be trusted of a proof: the stream followed along the traced path, by its own arithmetic."""
