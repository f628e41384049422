"""The package of a stream: what was proved of which bytes, by whom, and whether it holds here and now."""
