"""Sequences are compared: dynamic time warping, and the nearest of many references."""

from wigwag.distances.dtw import dtw, dtw_pairwise
from wigwag.distances.gallery import Gallery
from wigwag.distances.nearest import NearestSequences
from wigwag.distances.packed import PackedSequences
from wigwag.distances.path import dtw_path

__all__ = ["Gallery", "NearestSequences", "PackedSequences", "dtw", "dtw_pairwise", "dtw_path"]
