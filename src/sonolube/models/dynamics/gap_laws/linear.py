"""Linear contact law with loss of contact."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sonolube.checks import Floats, require_non_negative
from sonolube.models.dynamics.gap_laws.protocol import CONTACT_LOSS_THRESHOLD
from sonolube.models.dynamics.kernels.contact_kernel import LINEAR


@dataclass(frozen=True, kw_only=True, slots=True)
class LinearGap:
    r"""Contact of constant stiffness, which can separate: the axial stiffness k_1 of the cube model, or any other.

    Parameters
    ----------
    normal_stiffness : float
        Stiffness k of the contact. [N/m]
    force_damping : float
        Damping tau in proportion to the force, F (1 - tau x'). [s/m]

    Raises
    ------
    InvalidInput
        If the stiffness or the damping is negative.

    Notes
    -----
    .. math:: F = \max(F_N - k x,\, 0)
    """

    kind: ClassVar[int] = LINEAR
    has_corner: ClassVar[bool] = True

    normal_stiffness: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_non_negative(normal_stiffness=self.normal_stiffness, force_damping=self.force_damping)

    @property
    def kernel_parameter(self) -> float:
        """Stiffness k, in N/m."""
        return self.normal_stiffness

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Elastic contact force. [N]"""
        return np.maximum(normal_load - self.normal_stiffness * displacement, 0.0)

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Contact stiffness -dF/dx. [N/m]"""
        return np.where(self.force(displacement, normal_load) > 0, self.normal_stiffness, 0.0)

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Displacement beyond which contact counts as lost, infinite without stiffness. [m]"""
        with np.errstate(divide="ignore"):
            return np.divide((1 - CONTACT_LOSS_THRESHOLD) * np.asarray(normal_load), self.normal_stiffness)

    def equilibrium_coordinate(self, normal_load: Floats | float) -> Floats:
        """Zero: displacements count from equilibrium."""
        return np.zeros(np.shape(normal_load))

    def force_derivatives(self, displacement: Floats, normal_load: float) -> dict[str, Floats]:
        """Derivatives of the elastic force by dead load and stiffness."""
        touching = np.asarray(self.force(displacement, normal_load) > 0, dtype=np.float64)
        return {"normal_load": touching, "normal_stiffness": -displacement * touching}
