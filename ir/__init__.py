"""The data every stage takes and gives, with invariants and text forms."""
