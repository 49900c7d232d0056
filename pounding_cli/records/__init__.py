"""Ground motions: reading, measuring, scaling, the catalogue.

Importing this package is cheap: scipy and yaml are imported by the functions that need them.
"""

from pounding_cli.records.catalogue import (
    Entry,
    get_entry,
    list_names,
    load_catalogue,
    load_motion,
    locate_motion,
    save_motion,
    user_folder,
)
from pounding_cli.records.code_spectra import CODES, CodeSpectrum
from pounding_cli.records.declaration import BASELINES, SEPARATOR_NAMES, Declaration, write_file
from pounding_cli.records.motion import Motion, arias, displacement, pgv, significant_duration, spectrum
from pounding_cli.records.motion_sets import (
    INSTALL_COMMAND,
    MOTION_SETS,
    SOURCE_PREFIX,
    SetMotion,
    find_installed_version,
    find_set_name,
    get_set_motion,
    read_set_motion,
    select_set_motions,
)
from pounding_cli.records.proposal import Proposal, propose_file
from pounding_cli.records.reading import MOTION_FORMATS, PLAIN, Reading, read_file
from pounding_cli.records.scaling import SpectrumMatch, TargetSpectrum, arias_factor, scale_factor, spectrum_factors
from pounding_cli.records.sines import Sine
from pounding_cli.records.units import ACCELERATION_UNITS, USUAL_UNITS, find_acceleration_unit
from pounding_cli.units import GRAVITY
