"""Contact laws: normal contact force against the displacement from equilibrium under a dead load.

A law is a frozen record that evaluates force, stiffness and parameter derivatives in numpy; the compiled kernels take
one number of it (`kernel_parameter`). All laws are damped alike, in proportion to the force (Hunt and Crossley)::

    F_n(x, v) = F(x) max(1 - tau v, 0)

Here are the interface and the laws in closed form: exponential, of rough surfaces; linear, of constant stiffness; and
that of Hertz, of a smooth sphere.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL, HERTZ, LINEAR

CONTACT_LOSS_THRESHOLD = 0.01
"""Fraction of the dead load below which contact counts as lost. []"""


class GapLaw(Protocol):
    """Contact force under a dead load against the displacement x from equilibrium, positive for wider gaps.

    Attributes
    ----------
    kind : int
        Branch of the compiled kernels that evaluates the law.
    has_corner : bool
        Whether the slope of the force jumps where contact is lost.
    """

    kind: ClassVar[int]
    has_corner: ClassVar[bool]

    @property
    def force_damping(self) -> float:
        """Damping tau in proportion to the force, F (1 - tau x'). [s/m]"""

    @property
    def kernel_parameter(self) -> float:
        """The one parameter that the compiled kernels take: see `KernelLaw`."""

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Elastic contact force F, never negative. [N]"""

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Contact stiffness -dF/dx. [N/m]"""

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Displacement beyond which contact counts as lost, F < 0.01 F_N. [m]"""

    def equilibrium_coordinate(self, normal_load: Floats | float) -> Floats:
        """Law's own coordinate at equilibrium: approach in m, position on the table in cells, or zero."""

    def force_derivatives(self, displacement: Floats, normal_load: float) -> dict[str, Floats]:
        """Derivatives of the elastic force by the dead load and by each parameter, named as these."""


def damped_force(gap_law: GapLaw, x: Floats, v: Floats, load: Floats | float) -> Floats:
    r"""Contact force with damping, in N.

    .. math:: F_n = F(x)\,\max(1 - \tau v,\, 0)
    """
    return gap_law.force(x, load) * np.maximum(1 - gap_law.force_damping * v, 0.0)


def force_decay_length(gap_law: GapLaw, load: Floats | float) -> Floats:
    r"""Decay length of the contact force at equilibrium: force over stiffness, in m.

    Parameters
    ----------
    gap_law : GapLaw
    load : ndarray or float
        Dead load, in N.

    Returns
    -------
    ndarray
        Infinite without stiffness.

    Notes
    -----
    .. math:: l = \frac{F_N}{-F'(0)}

    Examples
    --------
    >>> from sonolube.models.dynamics import HertzGap, force_decay_length
    >>> ball = HertzGap(tip_radius=5e-3, effective_modulus=60e9)
    >>> round(1e6 * float(force_decay_length(ball, 10.0)), 2)  # two thirds of the approach of 1.46 um
    0.97
    """
    rest = np.zeros(np.shape(load))
    with np.errstate(divide="ignore"):
        return np.divide(load, gap_law.stiffness(rest, load))


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
    def kernel_parameter(self) -> float:
        """Force over approach to the power 3/2, 4/3 E* sqrt(R), in N/m^1.5."""
        return 4 / 3 * self.effective_modulus * math.sqrt(self.tip_radius)

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Elastic contact force. [N]"""
        return self.kernel_parameter * self._approach(displacement, normal_load) ** 1.5

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Contact stiffness -dF/dx. [N/m]"""
        return 1.5 * self.kernel_parameter * np.sqrt(self._approach(displacement, normal_load))

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Displacement beyond which contact counts as lost. [m]"""
        return np.asarray((normal_load / self.kernel_parameter) ** (2 / 3) * (1 - CONTACT_LOSS_THRESHOLD ** (2 / 3)))

    def equilibrium_coordinate(self, normal_load: Floats | float) -> Floats:
        """Approach under the dead load, in m."""
        return np.asarray((normal_load / self.kernel_parameter) ** (2 / 3))

    def force_derivatives(self, displacement: Floats, normal_load: float) -> dict[str, Floats]:
        """Derivatives of the elastic force by dead load, radius and modulus."""
        rest = (normal_load / self.kernel_parameter) ** (2 / 3)
        approach = self._approach(displacement, normal_load)
        stiffness = 1.5 * self.kernel_parameter * np.sqrt(approach)
        by_coefficient = approach**1.5 - stiffness * 2 / 3 * rest / self.kernel_parameter
        return {
            "normal_load": stiffness * 2 / 3 * rest / normal_load,
            "tip_radius": by_coefficient * 0.5 * self.kernel_parameter / self.tip_radius,
            "effective_modulus": by_coefficient * self.kernel_parameter / self.effective_modulus,
        }

    def _approach(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        return np.maximum((normal_load / self.kernel_parameter) ** (2 / 3) - displacement, 0.0)
