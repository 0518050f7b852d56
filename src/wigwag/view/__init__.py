"""Seeing it: drawings, the report."""
