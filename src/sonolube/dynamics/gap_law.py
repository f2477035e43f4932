"""The contact force as a function of the gap's change, for dynamics: one law to a class, one number to the kernels."""

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive


class GapLaw(Protocol):
    """Contact force under a dead load, against the displacement from rest under it, positive for wider gaps.

    Attributes
    ----------
    kind : int
        Which branch of the compiled kernels evaluates the law.
    """

    kind: ClassVar[int]

    @property
    def force_damping(self) -> float:
        """Damping tau of the contact in proportion to its force, F_n (1 - tau x'). [s/m]"""

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return the elastic contact force, never negative. [N]"""

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return its fall per displacement. [N/m]"""


@dataclass(frozen=True, kw_only=True, slots=True)
class ExponentialGap:
    """F_n = F_N exp(-x/l): rough surfaces with exponential heights, whatever their asperities.

    Parameters
    ----------
    decay_length : float
        Length l over which the force falls by a factor of e, Rq/lambda. [m]
    force_damping : float
        Damping tau in proportion to the force, F_n (1 - tau x'). [s/m]
    """

    kind: ClassVar[int] = 0

    decay_length: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(decay_length=self.decay_length)
        require_non_negative(force_damping=self.force_damping)

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return the elastic contact force. [N]"""
        return normal_load * np.exp(-displacement / self.decay_length)

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return its fall per displacement. [N/m]"""
        return self.force(displacement, normal_load) / self.decay_length


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzGap:
    """F_n = 4/3 E* sqrt(R) (delta_0 - x)^(3/2) while touching: a smooth sphere, delta_0 its approach at rest.

    Parameters
    ----------
    tip_radius : float
        Radius of the sphere. [m]
    combined_modulus : float
        Combined modulus of both bodies. [Pa]
    force_damping : float
        Damping tau in proportion to the force, F_n (1 - tau x'). [s/m]
    """

    kind: ClassVar[int] = 1

    tip_radius: float
    combined_modulus: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(tip_radius=self.tip_radius, combined_modulus=self.combined_modulus)
        require_non_negative(force_damping=self.force_damping)

    @property
    def coefficient(self) -> float:
        """Force over approach to the power 3/2, in N/m^1.5."""
        return 4 / 3 * self.combined_modulus * math.sqrt(self.tip_radius)

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return the elastic contact force. [N]"""
        return self.coefficient * self._approach(displacement, normal_load) ** 1.5

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return its fall per displacement. [N/m]"""
        return 1.5 * self.coefficient * np.sqrt(self._approach(displacement, normal_load))

    def _approach(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        return np.maximum((normal_load / self.coefficient) ** (2 / 3) - displacement, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class LinearGap:
    """F_n = F_N - k x while touching: the axial stiffness k_1 of the cube, or any constant one.

    Parameters
    ----------
    normal_stiffness : float
        Stiffness of the contact. [N/m]
    force_damping : float
        Damping tau in proportion to the force, F_n (1 - tau x'). [s/m]
    """

    kind: ClassVar[int] = 2

    normal_stiffness: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_non_negative(normal_stiffness=self.normal_stiffness, force_damping=self.force_damping)

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return the elastic contact force. [N]"""
        return np.maximum(normal_load - self.normal_stiffness * displacement, 0.0)

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return its fall per displacement. [N/m]"""
        return np.where(self.force(displacement, normal_load) > 0, self.normal_stiffness, 0.0)
