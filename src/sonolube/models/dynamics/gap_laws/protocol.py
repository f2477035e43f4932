r"""Interface of a contact law: normal contact force against the displacement from equilibrium under a dead load.

A law is a frozen record that evaluates force, stiffness and parameter derivatives in numpy; the compiled kernels take
one number of it (`kernel_parameter`). All laws are damped alike, in proportion to the force (Hunt and Crossley):

.. math:: F_n(x, \dot x) = F(x)\,\max(1 - \tau\dot x,\, 0)
"""

from typing import ClassVar, Protocol

import numpy as np

from sonolube.checks import Floats

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
