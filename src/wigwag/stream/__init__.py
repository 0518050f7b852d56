"""Poses without end become clips: segmentation by motion, and spotting."""
