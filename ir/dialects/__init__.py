"""Facts about controller dialects that several parts need, as data."""
