"""Fragility curves: how likely a limit is passed at an intensity. Statistics alone, of numbers from any source."""

from pounding_cli.fragility.bands import Bands, bands, median_ratio, resamples
from pounding_cli.fragility.cloud import Cloud, cloud
from pounding_cli.fragility.curve import Curve, Outcome
from pounding_cli.fragility.likelihood import Brackets, fit, of_counts

__all__ = [
    "Bands", "Brackets", "Cloud", "Curve", "Outcome", "bands", "cloud", "fit", "median_ratio", "of_counts", "resamples",
]  # fmt: skip
