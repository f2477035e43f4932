"""Stick-slip of a rig's slider on an elastic holder, and its suppression by vibration."""

from dataclasses import dataclass

import numpy as np

from sonolube.design.control.control_design import ControlDesign
from sonolube.design.control.friction_characteristic import level_for_friction
from sonolube.design.control.stick_slip_oscillator import (
    StickSlipMotion,
    mass_on_belt,
    steady_sliding_damping,
    stick_slip_motion,
)
from sonolube.rig import CommandedQuantity, Rig

HOLDER_MASS = 0.05
"""Assumed mass that moves with the slider. [kg]"""

HOLDER_STIFFNESS = 2e4
"""Assumed stiffness of the holder. [N/m]"""

HOLDER_DAMPING_RATIO = 0.01
"""Assumed damping ratio of the holder. []"""

STATIC_FRICTION_FACTOR = 1.3
"""Assumed friction at rest over friction of sliding, both without vibration. []"""

_PERIODS = 80  # free periods of the holder that are integrated


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipSuppression:
    """Motion of a slider on an elastic holder without and with vibration.

    Parameters
    ----------
    still, vibrating : StickSlipMotion
        Without and with vibration.
    level : float
        Drive voltage or amplitude of `vibrating`, in V or m.
    quantity : CommandedQuantity
        Voltage or amplitude.
    damping : tuple of two float
        Damping of small motions about steady sliding, without and with vibration, in N s/m.
    """

    still: StickSlipMotion
    vibrating: StickSlipMotion
    level: float
    quantity: CommandedQuantity
    damping: tuple[float, float]


def stick_slip_suppression(rig: Rig, study: ControlDesign) -> StickSlipSuppression:
    r"""Stick-slip of a rig's slider without vibration and at the voltage or amplitude of the commanded friction.

    The holder has the mass, stiffness, damping ratio and static friction of the constants of this module, with

    .. math:: c = 2 \zeta \sqrt{m k}

    and friction that falls from its static value over the rig's sliding speed.

    See Also
    --------
    dragged_mass, dragged_motion, steady_sliding_damping
    """
    level = float(level_for_friction(study.plant, friction_force=study.friction_force))
    without, within = (
        mass_on_belt(
            rig,
            holder_mass=HOLDER_MASS,
            holder_stiffness=HOLDER_STIFFNESS,
            holder_damping=2 * HOLDER_DAMPING_RATIO * float(np.sqrt(HOLDER_MASS * HOLDER_STIFFNESS)),
            static_friction_force=STATIC_FRICTION_FACTOR * study.plant.highest_force,
            stribeck_velocity=rig.sliding_speed,
            level=each,
        )
        for each in (0.0, level)
    )
    return StickSlipSuppression(
        still=stick_slip_motion(without, duration=_PERIODS * without.period),
        vibrating=stick_slip_motion(within, duration=_PERIODS * within.period),
        level=level,
        quantity=study.plant.quantity,
        damping=(steady_sliding_damping(without), steady_sliding_damping(within)),
    )
