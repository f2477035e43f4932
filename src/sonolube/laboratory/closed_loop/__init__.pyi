from .loop import (
    HoldMetrics as HoldMetrics,
    held_friction_chart as held_friction_chart,
    held_friction_dataset as held_friction_dataset,
    hold_friction as hold_friction,
    hold_metrics as hold_metrics,
    require_holdable as require_holdable,
)
from .plan import (
    FrictionHold as FrictionHold,
    HeldFriction as HeldFriction,
    SpeedStep as SpeedStep,
    hold_protocol as hold_protocol,
    planned_hold as planned_hold,
    recorded_channels as recorded_channels,
)
