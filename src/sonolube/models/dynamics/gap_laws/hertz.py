"""Hertzian contact law of a smooth sphere."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.dynamics.gap_laws.protocol import CONTACT_LOSS_THRESHOLD
from sonolube.models.dynamics.kernels.contact_kernel import HERTZ


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzGap:
    r"""Hertzian contact of a smooth sphere on a plane, which can separate.

    Parameters
    ----------
    tip_radius : float
        Radius R of the sphere. [m]
    effective_modulus : float
        Effective contact modulus E* of both bodies. [Pa]
    force_damping : float
        Damping tau in proportion to the force, F (1 - tau x'). [s/m]

    Raises
    ------
    InvalidInput
        If the radius or the modulus is not positive, or the damping negative.

    Notes
    -----
    With the approach :math:`\delta_0` under the dead load,

    .. math:: F = \tfrac43 E^* \sqrt R\,\max(\delta_0 - x,\, 0)^{3/2}
    """

    kind: ClassVar[int] = HERTZ
    has_corner: ClassVar[bool] = True

    tip_radius: float
    effective_modulus: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(tip_radius=self.tip_radius, effective_modulus=self.effective_modulus)
        require_non_negative(force_damping=self.force_damping)

    @property
    def coefficient(self) -> float:
        """Force over approach to the power 3/2, 4/3 E* sqrt(R), in N/m^1.5."""
        return 4 / 3 * self.effective_modulus * math.sqrt(self.tip_radius)

    @property
    def kernel_parameter(self) -> float:
        """Hertz coefficient, in N/m^1.5."""
        return self.coefficient

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Elastic contact force. [N]"""
        return self.coefficient * self._approach(displacement, normal_load) ** 1.5

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Contact stiffness -dF/dx. [N/m]"""
        return 1.5 * self.coefficient * np.sqrt(self._approach(displacement, normal_load))

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Displacement beyond which contact counts as lost. [m]"""
        return np.asarray((normal_load / self.coefficient) ** (2 / 3) * (1 - CONTACT_LOSS_THRESHOLD ** (2 / 3)))

    def equilibrium_coordinate(self, normal_load: Floats | float) -> Floats:
        """Approach under the dead load, in m."""
        return np.asarray((normal_load / self.coefficient) ** (2 / 3))

    def force_derivatives(self, displacement: Floats, normal_load: float) -> dict[str, Floats]:
        """Derivatives of the elastic force by dead load, radius and modulus."""
        rest = (normal_load / self.coefficient) ** (2 / 3)
        approach = self._approach(displacement, normal_load)
        stiffness = 1.5 * self.coefficient * np.sqrt(approach)
        by_coefficient = approach**1.5 - stiffness * 2 / 3 * rest / self.coefficient
        return {
            "normal_load": stiffness * 2 / 3 * rest / normal_load,
            "tip_radius": by_coefficient * 0.5 * self.coefficient / self.tip_radius,
            "effective_modulus": by_coefficient * self.coefficient / self.effective_modulus,
        }

    def _approach(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        return np.maximum((normal_load / self.coefficient) ** (2 / 3) - displacement, 0.0)
