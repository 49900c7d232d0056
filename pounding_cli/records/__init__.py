"""Ground motions: reading, measuring, scaling, synthesizing, the catalogue.

Importing this room is cheap: scipy and yaml are imported by the functions that need them.
"""

from pounding_cli.records.catalogue import Entry, catalogue, entry, find, locate, names
from pounding_cli.records.intensity import (
    arias,
    cumulative_arias,
    husid,
    husid_times,
    pgv,
    significant_duration,
    spectrum,
)
from pounding_cli.records.motion import GRAVITY, Motion
from pounding_cli.records.readers import FORMATS, UNITS, read_motion
from pounding_cli.records.scaling import arias_factor, pga_factor

__all__ = [
    "FORMATS",
    "GRAVITY",
    "UNITS",
    "Entry",
    "Motion",
    "arias",
    "arias_factor",
    "catalogue",
    "cumulative_arias",
    "entry",
    "find",
    "husid",
    "husid_times",
    "locate",
    "names",
    "pga_factor",
    "pgv",
    "read_motion",
    "significant_duration",
    "spectrum",
]
