"""Exponential contact law of rough surfaces."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.dynamics.gap_laws.protocol import CONTACT_LOSS_THRESHOLD
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL


@dataclass(frozen=True, kw_only=True, slots=True)
class ExponentialGap:
    r"""Exponential contact law: rough surfaces with exponentially distributed summit heights, for any asperity law.

    Parameters
    ----------
    decay_length : float
        Length l over which the force falls by a factor of e, Rq/lambda. [m]
    force_damping : float
        Damping tau in proportion to the force, F (1 - tau x'). [s/m]

    Raises
    ------
    InvalidInput
        If the decay length is not positive or the damping negative.

    Notes
    -----
    .. math:: F = F_N\,e^{-x/l}

    References
    ----------
    .. [1] D 3.3 with its exponential height distribution.
    """

    kind: ClassVar[int] = EXPONENTIAL
    has_corner: ClassVar[bool] = False

    decay_length: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(decay_length=self.decay_length)
        require_non_negative(force_damping=self.force_damping)

    @property
    def kernel_parameter(self) -> float:
        """Decay length l, in m."""
        return self.decay_length

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Elastic contact force. [N]"""
        return normal_load * np.exp(-displacement / self.decay_length)

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Contact stiffness -dF/dx. [N/m]"""
        return self.force(displacement, normal_load) / self.decay_length

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Displacement beyond which contact counts as lost. [m]"""
        return np.full(np.shape(normal_load), -self.decay_length * math.log(CONTACT_LOSS_THRESHOLD))

    def equilibrium_coordinate(self, normal_load: Floats | float) -> Floats:
        """Zero: displacements count from equilibrium."""
        return np.zeros(np.shape(normal_load))

    def force_derivatives(self, displacement: Floats, normal_load: float) -> dict[str, Floats]:
        """Derivatives of the elastic force by dead load and decay length."""
        elastic = self.force(displacement, normal_load)
        return {"normal_load": elastic / normal_load, "decay_length": elastic * displacement / self.decay_length**2}
