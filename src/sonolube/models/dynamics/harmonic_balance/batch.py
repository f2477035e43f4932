"""Records of a batch of steady states: the problem, and the solution."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.protocol import GapLaw
from sonolube.models.dynamics.harmonic_balance.receptance import PoleResidueModel


class BatchProblem(NamedTuple):
    """Steady states to compute: one structure and contact law, p operating points, and options of the solver."""

    model: PoleResidueModel
    gap_law: GapLaw
    omega: Floats  # (p,) rad/s, angular frequency of the drive
    load: Floats  # (p,) N, dead load
    voltage: Complexes  # (p, K) V, harmonics of the drive
    static_displacement: Floats  # (p,) m, mean displacement without contact force
    minimum_harmonics: int  # least number of harmonics of the contact, fully coupled
    upper_branch: bool  # whether to return the larger of coexisting vibrations
    stability: bool  # whether to compute stability
    tolerance: float  # largest relative error of amplitude and force
    on_gpu: bool  # whether JAX solves on its GPU

    def select(self, points: NDArray[np.intp] | slice) -> "BatchProblem":
        """Problem of some of the points."""
        return self._replace(
            omega=self.omega[points],
            load=self.load[points],
            voltage=self.voltage[points],
            static_displacement=self.static_displacement[points],
        )


class BatchSolution(NamedTuple):
    """Steady states of a batch, one row of each array per point; NaN for a point without solution."""

    mean_displacement: Floats  # (p,) m
    harmonics: Complexes  # (p, H) m, of the displacement
    mean_normal_force: Floats  # (p,) N
    charge_harmonics: Complexes  # (p, K) C, of the charge on the stack
    vibration_amplitude: Floats  # (p,) m
    extremum_phases: Floats  # (p, 2) rad, of maximum and minimum displacement; NaN with more than two extrema
    lowest_displacement: Floats  # (p,) m
    highest_normal_force: Floats  # (p,) N
    lowest_normal_force: Floats  # (p,) N
    contact_loss_fraction: Floats  # (p,)
    unstable: NDArray[np.bool_]  # (p,)
    coexisting_amplitude: Floats  # (p,) m, of another stable steady state; NaN where none was found
    harmonic_count: Integers  # (p,)


def concatenate(parts: list[BatchSolution]) -> BatchSolution:
    """Solution of a batch from those of its consecutive chunks."""
    if len(parts) == 1:
        return parts[0]
    capacity = max(part.harmonics.shape[1] for part in parts)
    harmonics = np.zeros((sum(part.mean_displacement.size for part in parts), capacity), dtype=np.complex128)
    start = 0
    for part in parts:
        harmonics[start : start + part.mean_displacement.size, : part.harmonics.shape[1]] = part.harmonics
        start += part.mean_displacement.size
    narrow = (part._replace(harmonics=part.harmonics[:0, :1]) for part in parts)
    joined = BatchSolution(*(np.concatenate(columns) for columns in zip(*narrow, strict=True)))
    return joined._replace(harmonics=harmonics)
