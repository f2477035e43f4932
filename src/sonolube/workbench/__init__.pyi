from . import measure as measure
from .figures import FIGURES as FIGURES, plot as plot
from .results import map as map, simulate as simulate, sweep as sweep
