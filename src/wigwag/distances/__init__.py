"""Sequences are compared: dynamic time warping."""
