from . import measure as measure
from .figures import FIGURES as FIGURES, plot as plot
from .first_rig import new_rig as new_rig
from .part_modes import modes as modes
from .results import compare as compare, map as map, simulate as simulate, sweep as sweep
