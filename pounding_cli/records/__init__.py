"""Ground motions: reading, measuring, scaling, the catalogue.

Importing this package is cheap: scipy and yaml are imported by the functions that need them.
"""

from pounding_cli.records.catalogue import Entry, catalogue, entry, find, keep, locate, names, user_folder
from pounding_cli.records.motion import GRAVITY, Motion, arias, displacement, pgv, significant_duration, spectrum
from pounding_cli.records.reading import FORMATS, Reading, read_file
from pounding_cli.records.scaling import SpectrumMatch, TargetSpectrum, arias_factor, scale_factor, spectrum_factors
from pounding_cli.records.text import Doubt
from pounding_cli.records.units import UNITS, acceleration_unit
