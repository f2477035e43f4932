from .figure import held_friction_figure as held_friction_figure
from .loop import hold_friction as hold_friction
from .metrics import HoldMetrics as HoldMetrics, hold_metrics as hold_metrics
from .record import FrictionHold as FrictionHold, HeldFriction as HeldFriction, SpeedStep as SpeedStep
