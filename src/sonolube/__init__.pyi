from . import design as design
from .facts import published as published
from .measurement.measured_runs import read_runs as read_runs
from .prediction.live_prediction import LivePrediction as LivePrediction, predict as predict
from .rig.file.reader import read_rig as read_rig
from .rig.record import Rig as Rig
from .validation.runs_fit import fit_runs as fit_runs
from .workbench import measure as measure
from .workbench.figures import plot as plot
from .workbench.first_rig import new_rig as new_rig
from .workbench.part_modes import modes as modes
from .workbench.results import compare as compare, map as map, simulate as simulate, sweep as sweep

__version__: str
