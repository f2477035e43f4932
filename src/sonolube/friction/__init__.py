"""Friction: its laws, and what vibration makes of them."""

from sonolube.friction.coulomb import CoulombFriction, coulomb_friction, friction_coefficient
from sonolube.friction.cube import as_published_ratio, separating_half_period_ratio, steady_deformation
from sonolube.friction.dahl import DahlFriction, dahl_friction, dahl_friction_history
from sonolube.friction.lugre import LuGreFriction, LuGreHistory, lugre_friction_history, lugre_steady_friction
from sonolube.friction.vibrated_dahl import dahl_under_vibration

__all__ = [
    "CoulombFriction",
    "DahlFriction",
    "LuGreFriction",
    "LuGreHistory",
    "as_published_ratio",
    "coulomb_friction",
    "dahl_friction",
    "dahl_friction_history",
    "dahl_under_vibration",
    "friction_coefficient",
    "lugre_friction_history",
    "lugre_steady_friction",
    "separating_half_period_ratio",
    "steady_deformation",
]
