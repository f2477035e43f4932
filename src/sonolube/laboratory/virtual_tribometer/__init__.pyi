from .disturbances import UNDISTURBED as UNDISTURBED, Disturbances as Disturbances
from .pace import ExpectedTime as ExpectedTime, expected_time as expected_time
from .tribometer import (
    GROOVE_DIAMETER as GROOVE_DIAMETER,
    VirtualTribometer as VirtualTribometer,
    virtual_tribometer as virtual_tribometer,
)
from .truth import FrictionDraw as FrictionDraw, FrictionLevel as FrictionLevel
