"""Tabulated contact law, for any force that decreases with the separation, and the table of all laws."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.closed_form import (
    CONTACT_LOSS_THRESHOLD,
    ExponentialGap,
    GapLaw,
    HertzGap,
    LinearGap,
)
from sonolube.models.dynamics.kernels.contact_kernel import (
    LARGEST_LOG_FORCE,
    TABULATED,
    KernelLaw,
    log_forces,
    positions_of,
    table_cells,
)

_STEEPEST = 3.0  # slope over rise per cell up to which a cubic between two points is monotone (Fritsch and Carlson)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TabulatedGap:
    r"""Contact law from a table of force against separation, such as Gaussian summit heights or measured stiffness.

    One table serves every dead load: the load determines the equilibrium position on it.

    Parameters
    ----------
    separation : ndarray, shape (n,)
        Separations d, evenly spaced and increasing, at least four. [m]
    normal_force : ndarray, shape (n,)
        Force at these separations, decreasing. [N]
    normal_stiffness : ndarray, shape (n,)
        Stiffness -dF/dd at these separations. [N/m]
    force_damping : float
        Damping tau in proportion to the force, F (1 - tau x'). [s/m]
    cells : ndarray, shape (n + 1, 4)
        Interpolation coefficients, computed at construction: see `sonolube.models.dynamics.kernels.contact_kernel`.

    Raises
    ------
    InvalidInput
        If there are fewer than four points, their shapes differ, separations are not evenly spaced, the force does not
        decrease, or the stiffness is inconsistent with the force.

    Notes
    -----
    With the separation :math:`d_N` at which the force equals the dead load,

    .. math:: F = F(d_N + x), \qquad F(d_N) = F_N .

    Between points ln F is a monotone cubic of the given values and slopes [1]_: force and stiffness are continuous and
    the force decreases everywhere. Its relative error goes with the fourth power of the spacing. Beyond the ends the
    force continues exponentially with the decay it has there: it stays positive, and finite up to exp(700) N.

    References
    ----------
    .. [1] F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17, 238 (1980). doi:10.1137/0717021
    """

    kind: ClassVar[int] = TABULATED
    has_corner: ClassVar[bool] = False

    separation: Floats
    normal_force: Floats
    normal_stiffness: Floats
    force_damping: float = 0.0
    cells: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        s = require_finite(separation=self.separation)
        force = require_positive(normal_force=self.normal_force)
        k = require_positive(normal_stiffness=self.normal_stiffness)
        require_non_negative(force_damping=self.force_damping)
        if s.ndim != 1 or s.size < 4 or not s.shape == force.shape == k.shape:
            raise InvalidInput(
                "separation, normal_force and normal_stiffness must be rows of the same four or more points,"
                f" got shapes {s.shape}, {force.shape} and {k.shape}"
            )
        step = (s[-1] - s[0]) / (s.size - 1)
        if not (step > 0 and np.allclose(np.diff(s), step, rtol=1e-6, atol=0.0)):
            raise InvalidInput("separation must be evenly spaced and increasing")
        if not np.all(np.diff(force) < 0):
            raise InvalidInput(
                f"normal_force must decrease from point to point, but increases or stays after separation"
                f" {s[np.argmax(np.diff(force) >= 0)]:.6g} m"
            )
        rise, slope = np.diff(np.log(force)), -k / force * step
        steep = np.minimum(slope[:-1], slope[1:]) < _STEEPEST * rise
        if steep.any():
            raise InvalidInput(
                "normal_stiffness must be the decrease of normal_force per separation, but is more than three times as"
                f" steep after separation {s[np.argmax(steep)]:.6g} m: correct it, or tabulate more finely"
            )
        for name, values in {"separation": s, "normal_force": force, "normal_stiffness": k}.items():
            object.__setattr__(self, name, values)
        object.__setattr__(self, "cells", table_cells(np.log(force), slope))

    @property
    def kernel_parameter(self) -> float:
        """Cells of the table per metre."""
        return float((self.separation.size - 1) / (self.separation[-1] - self.separation[0]))

    def force(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Elastic contact force. [N]"""
        return self._force_and_decay(displacement, normal_load)[0]

    def stiffness(self, displacement: Floats, normal_load: Floats | float) -> Floats:
        """Contact stiffness -dF/dx. [N/m]"""
        force, decay = self._force_and_decay(displacement, normal_load)
        with np.errstate(over="ignore"):
            return np.asarray(force * decay)

    def loss_displacement(self, normal_load: Floats | float) -> Floats:
        """Displacement beyond which contact counts as lost. [m]"""
        load = np.asarray(normal_load)
        cells = self.equilibrium_coordinate(CONTACT_LOSS_THRESHOLD * load) - self.equilibrium_coordinate(load)
        return np.asarray(cells / self.kernel_parameter)

    def equilibrium_coordinate(self, normal_load: Floats | float) -> Floats:
        """Equilibrium position on the table under a dead load, in cells."""
        load = np.asarray(normal_load, dtype=np.float64)
        positions = np.empty(load.size)
        positions_of.for_points(load.size, most=64)(self.cells, np.log(load).ravel(), positions)
        return positions.reshape(load.shape)

    def force_derivatives(self, displacement: Floats, normal_load: float) -> dict[str, Floats]:
        """Derivative of the elastic force by the dead load; the table itself has no parameter."""
        at_rest = self.stiffness(np.zeros(()), normal_load)
        return {"normal_load": self.stiffness(displacement, normal_load) / at_rest}

    def _force_and_decay(self, displacement: Floats, normal_load: Floats | float) -> tuple[Floats, Floats]:
        """Force, in N, and its logarithmic decay per displacement, in 1/m."""
        position = self.equilibrium_coordinate(normal_load) + self.kernel_parameter * np.asarray(displacement)
        logs, slopes = np.empty((2, position.size))
        log_forces.for_points(position.size, most=2048)(self.cells, position.ravel(), logs, slopes)
        force = np.exp(np.clip(logs, -LARGEST_LOG_FORCE, LARGEST_LOG_FORCE))
        return force.reshape(position.shape), -self.kernel_parameter * slopes.reshape(position.shape)


_NO_CELLS = np.empty((0, 4))


GAP_LAWS: Mapping[str, type[GapLaw]] = MappingProxyType(
    {"exponential": ExponentialGap, "hertz": HertzGap, "linear": LinearGap, "tabulated": TabulatedGap}
)
"""The contact laws that the compiled kernels evaluate, by name."""


def kernel_law(gap_law: GapLaw) -> KernelLaw:
    """Contact law in the form that the compiled kernels take.

    What kernels are compiled for. Numbers that they take at run time.
    """
    if not is_compiled(gap_law):
        raise InvalidInput(
            f"gap_law must be one of {', '.join(law.__name__ for law in GAP_LAWS.values())}, got {gap_law!r};"
            " tabulate any other law as a TabulatedGap"
        )
    cells = gap_law.cells if isinstance(gap_law, TabulatedGap) else _NO_CELLS
    kind, damped = (0,) * gap_law.kind, (0,) * (gap_law.force_damping > 0)
    return KernelLaw(kind, damped, gap_law.kernel_parameter, gap_law.force_damping, cells)


def is_compiled(gap_law: GapLaw) -> bool:
    """Whether a contact law is one of `GAP_LAWS`, which the compiled kernels evaluate."""
    return isinstance(gap_law, tuple(GAP_LAWS.values()))
