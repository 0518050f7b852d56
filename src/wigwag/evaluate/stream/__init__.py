"""Streams of poses become commands: assembled truth, metrics, what is judged, and how it is disturbed."""
