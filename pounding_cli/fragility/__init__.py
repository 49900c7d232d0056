"""Fragility curves: how likely a limit is passed at an intensity. Statistics alone, of numbers from any source."""

from pounding_cli.fragility.bands import CONFIDENCE, DRAWS, Bands, bands, draw, median_ratio, resamples
from pounding_cli.fragility.cloud import Cloud, cloud, cloud_draw
from pounding_cli.fragility.curve import Curve, Outcome
from pounding_cli.fragility.likelihood import Brackets, Fits, fit, of_counts

__all__ = [
    "CONFIDENCE", "DRAWS", "Bands", "Brackets", "Cloud", "Curve", "Fits", "Outcome", "bands", "cloud", "cloud_draw",
    "draw", "fit", "median_ratio", "of_counts", "resamples",
]  # fmt: skip
