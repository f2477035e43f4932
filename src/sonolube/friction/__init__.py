"""Friction: its laws, and what vibration makes of them."""

from sonolube.friction.bristle import Holder, coupled
from sonolube.friction.closures import (
    FRICTION_CLOSURES,
    as_published,
    kinematic,
    load_balanced,
    separating_half_period,
)
from sonolube.friction.coulomb import CoulombFriction, coulomb_friction, friction_coefficient
from sonolube.friction.cube import as_published_ratio, separating_half_period_ratio, steady_deformation
from sonolube.friction.dahl import DahlFriction, dahl_friction, dahl_friction_history
from sonolube.friction.lugre import LuGreFriction, LuGreHistory, lugre_friction_history, lugre_steady_friction
from sonolube.friction.stick_slip import mindlin_memory_length, stick_slip, stick_slip_ratio
from sonolube.friction.vibrated_dahl import dahl_under_vibration

__all__ = [
    "FRICTION_CLOSURES",
    "CoulombFriction",
    "DahlFriction",
    "Holder",
    "LuGreFriction",
    "LuGreHistory",
    "as_published",
    "as_published_ratio",
    "coulomb_friction",
    "coupled",
    "dahl_friction",
    "dahl_friction_history",
    "dahl_under_vibration",
    "friction_coefficient",
    "kinematic",
    "load_balanced",
    "lugre_friction_history",
    "lugre_steady_friction",
    "mindlin_memory_length",
    "separating_half_period",
    "separating_half_period_ratio",
    "steady_deformation",
    "stick_slip",
    "stick_slip_ratio",
]
