from .figure import held_friction_chart as held_friction_chart
from .hold_plan import planned_hold as planned_hold
from .loop import hold_friction as hold_friction, require_holdable as require_holdable
from .metrics import HoldMetrics as HoldMetrics, hold_metrics as hold_metrics
from .plan import hold_protocol as hold_protocol, recorded_channels as recorded_channels
from .record import FrictionHold as FrictionHold, HeldFriction as HeldFriction, SpeedStep as SpeedStep
from .results import held_friction_dataset as held_friction_dataset
