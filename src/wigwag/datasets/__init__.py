"""Recorded gestures on disk: UTD-MHAD and the user's own clips."""
