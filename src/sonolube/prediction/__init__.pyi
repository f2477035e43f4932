from .calibration import Calibration as Calibration, calibrations as calibrations
from .figures import calibration_figure as calibration_figure, prediction_figure as prediction_figure
from .posterior import learned as learned
from .rig_prediction import interval as interval, predict as predict, statement as statement
