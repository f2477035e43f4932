"""The contact force as a function of the gap's change, for dynamics: one law to a class, one number to the kernels."""

import math
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.dynamics.kernels.force_table import log_forces, positions_of, table_cells
from sonolube.errors import InvalidInput

LOST = 0.01
"""Share of the dead load below which contact counts as lost. []"""
LARGEST_EXPONENT = 700.0
"""Largest logarithm of a force in N, and minus the smallest, that laws by a table give. []"""
_STEEPEST = 3.0  # slope over rise per cell up to which a cubic between two points is monotone (Fritsch and Carlson)


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

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Return the displacement beyond which contact counts as lost. [m]"""


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

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Return the displacement beyond which contact counts as lost. [m]"""
        return np.full(np.shape(normal_load), -self.decay_length * math.log(LOST))


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzGap:
    """F_n = 4/3 E* sqrt(R) (delta_0 - x)^(3/2) while touching: a smooth sphere, delta_0 its approach at rest.

    Parameters
    ----------
    tip_radius : float
        Radius of the sphere. [m]
    effective_modulus : float
        Combined modulus of both bodies. [Pa]
    force_damping : float
        Damping tau in proportion to the force, F_n (1 - tau x'). [s/m]
    """

    kind: ClassVar[int] = 1

    tip_radius: float
    effective_modulus: float
    force_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(tip_radius=self.tip_radius, effective_modulus=self.effective_modulus)
        require_non_negative(force_damping=self.force_damping)

    @property
    def coefficient(self) -> float:
        """Force over approach to the power 3/2, in N/m^1.5."""
        return 4 / 3 * self.effective_modulus * math.sqrt(self.tip_radius)

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return the elastic contact force. [N]"""
        return self.coefficient * self._approach(displacement, normal_load) ** 1.5

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return its fall per displacement. [N/m]"""
        return 1.5 * self.coefficient * np.sqrt(self._approach(displacement, normal_load))

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Return the displacement beyond which contact counts as lost. [m]"""
        return np.asarray((normal_load / self.coefficient) ** (2 / 3) * (1 - LOST ** (2 / 3)))

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

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Return the displacement beyond which contact counts as lost, infinite without stiffness. [m]"""
        with np.errstate(divide="ignore"):
            return np.divide((1 - LOST) * np.asarray(normal_load), self.normal_stiffness)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TabulatedGap:
    """Any contact whose force falls with the separation, by a table: Gaussian heights, or measured stiffness.

    One table serves every dead load, which says where on it the contact rests.

    Parameters
    ----------
    separation : ndarray, shape (n,)
        Separations, evenly spaced and rising, at least four. [m]
    normal_force : ndarray, shape (n,)
        Force there, falling. [N]
    normal_stiffness : ndarray, shape (n,)
        Its fall per separation. [N/m]
    force_damping : float
        Damping tau in proportion to the force, F_n (1 - tau x'). [s/m]
    cells : ndarray, shape (n + 1, 4)
        Written at construction: see `sonolube.dynamics.kernels.force_table`.

    Raises
    ------
    InvalidInput
        If there are fewer than four points, their shapes differ, separations are not evenly spaced, the force does not
        fall, or the stiffness belongs to another force.

    Notes
    -----
    Between points the logarithm of the force is a cubic of the given values and slopes: force and stiffness are
    continuous and the force falls everywhere. Its relative error goes with the fourth power of the spacing. Beyond the
    ends the force goes on exponentially with the decay it has there: it stays positive, and finite up to exp(700) N.

    References
    ----------
    .. [1] F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17, 238 (1980). doi:10.1137/0717021
    """

    kind: ClassVar[int] = 3

    separation: Floats
    normal_force: Floats
    normal_stiffness: Floats
    force_damping: float = 0.0
    cells: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        s = require_finite(separation=self.separation)
        force, k = (
            require_positive(normal_force=self.normal_force),
            require_positive(normal_stiffness=self.normal_stiffness),
        )
        require_non_negative(force_damping=self.force_damping)
        if s.ndim != 1 or s.size < 4 or not s.shape == force.shape == k.shape:
            raise InvalidInput(
                "separation, normal_force and normal_stiffness must be rows of the same four or more points,"
                f" got shapes {s.shape}, {force.shape} and {k.shape}"
            )
        step = (s[-1] - s[0]) / (s.size - 1)
        if not (step > 0 and np.allclose(np.diff(s), step, rtol=1e-6, atol=0.0)):
            raise InvalidInput("separation must be evenly spaced and rising")
        if not np.all(np.diff(force) < 0):
            raise InvalidInput(
                f"normal_force must fall from point to point, but rises or stays after separation"
                f" {s[np.argmax(np.diff(force) >= 0)]:.6g} m"
            )
        rise, slope = np.diff(np.log(force)), -k / force * step
        steep = np.minimum(slope[:-1], slope[1:]) < _STEEPEST * rise
        if steep.any():
            raise InvalidInput(
                "normal_stiffness must be the fall of normal_force per separation, but is more than three times as"
                f" steep after separation {s[np.argmax(steep)]:.6g} m: correct it, or tabulate more finely"
            )
        for name, values in {"separation": s, "normal_force": force, "normal_stiffness": k}.items():
            object.__setattr__(self, name, values)
        object.__setattr__(self, "cells", table_cells(np.log(force), slope))

    @property
    def cells_per_length(self) -> float:
        """Cells of the table per metre."""
        return float((self.separation.size - 1) / (self.separation[-1] - self.separation[0]))

    def rest_position(self, normal_load: Floats | float) -> Floats:
        """Return where on the table the contact rests under a dead load, in cells."""
        load = np.asarray(normal_load, dtype=np.float64)
        positions = np.empty(load.size)
        positions_of(self.cells, np.log(load).ravel(), positions)
        return positions.reshape(load.shape)

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return the elastic contact force. [N]"""
        return self._force_and_decay(displacement, normal_load)[0]

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Return its fall per displacement. [N/m]"""
        force, decay = self._force_and_decay(displacement, normal_load)
        with np.errstate(over="ignore"):
            return np.asarray(force * decay)

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Return the displacement beyond which contact counts as lost. [m]"""
        load = np.asarray(normal_load)
        return np.asarray((self.rest_position(LOST * load) - self.rest_position(load)) / self.cells_per_length)

    def _force_and_decay(self, displacement: Floats, normal_load: Floats | float) -> tuple[Floats, Floats]:
        position = self.rest_position(normal_load) + self.cells_per_length * np.asarray(displacement)
        logs, slopes = np.empty((2, position.size))
        log_forces(self.cells, position.ravel(), logs, slopes)
        force = np.exp(np.clip(logs, -LARGEST_EXPONENT, LARGEST_EXPONENT))
        return force.reshape(position.shape), -self.cells_per_length * slopes.reshape(position.shape)


def length_of_change(gap_law: GapLaw, load: Floats | float) -> Floats:
    """Return the length over which the force at rest changes, infinite without stiffness, in m.

    Parameters
    ----------
    gap_law : GapLaw
    load : ndarray or float
        Dead load in N.
    """
    rest = np.zeros(np.shape(load))
    with np.errstate(divide="ignore"):
        return np.divide(load, gap_law.stiffness(rest, load))
