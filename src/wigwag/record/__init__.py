"""A flight is written down as it happens, read back, and decided again."""
