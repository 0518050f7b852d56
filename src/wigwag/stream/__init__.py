"""Poses without end become gestures: spotting, early decision, and what is no gesture."""
