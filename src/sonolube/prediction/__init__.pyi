from .calibration import Calibration as Calibration, calibrations as calibrations
from .figures import calibration_figure as calibration_figure, prediction_chart as prediction_chart
from .live_prediction import LivePrediction as LivePrediction, predict as predict
from .posterior import learned as learned
from .rig_statement import interval as interval, statement as statement
