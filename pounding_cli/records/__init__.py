"""Ground motions: reading, measuring, scaling, synthesizing, the catalogue.

Importing this package is cheap: scipy and yaml are imported by the functions that need them.
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
from pounding_cli.records.libraries import LIBRARIES, held, library_of, matching, read_held
from pounding_cli.records.motion import GRAVITY, Motion
from pounding_cli.records.readers import FORMATS, Reading, read_file, read_motion
from pounding_cli.records.scaling import (
    TargetSpectrum,
    arias_factor,
    pga_factor,
    pgv_factor,
    sa_factor,
    spectrum_factors,
)
from pounding_cli.records.suite import SpectrumMatch, spectrum_match
from pounding_cli.records.units import UNITS, acceleration_unit

__all__ = [
    "FORMATS",
    "GRAVITY",
    "LIBRARIES",
    "UNITS",
    "Entry",
    "Motion",
    "Reading",
    "SpectrumMatch",
    "TargetSpectrum",
    "acceleration_unit",
    "arias",
    "arias_factor",
    "catalogue",
    "cumulative_arias",
    "entry",
    "find",
    "held",
    "husid",
    "husid_times",
    "library_of",
    "locate",
    "matching",
    "names",
    "pga_factor",
    "pgv",
    "pgv_factor",
    "read_file",
    "read_held",
    "read_motion",
    "sa_factor",
    "significant_duration",
    "spectrum",
    "spectrum_factors",
    "spectrum_match",
]
