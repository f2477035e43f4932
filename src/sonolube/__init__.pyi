from . import design as design, published as published
from .prediction.rig_prediction import predict as predict
from .rig.file.reader import read_rig as read_rig
from .rig.record import Rig as Rig
from .workbench import measure as measure
from .workbench.figures import plot as plot
from .workbench.results import map as map, simulate as simulate, sweep as sweep

__version__: str
