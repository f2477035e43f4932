"""Friction averages of motions with any number of extrema, by quadrature exact for a piecewise linear velocity."""

import numpy as np

from sonolube.checks import Complexes, Floats, Integers
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.friction_average.elliptic_kernel import EQUILIBRIUM, LOAD, MEAN, OMEGA
from sonolube.models.dynamics.kernels.contact_kernel import CompileTimeInt, LawParameters, contact_force
from sonolube.models.dynamics.kernels.simd import ALLOCATING_KERNEL, INNER

_CELLS_PER_HARMONIC, _MIN_CELLS = 256, 4096


@kernel(**ALLOCATING_KERNEL)
def piecewise_linear_averages(
    kind: CompileTimeInt,
    damped: CompileTimeInt,
    law: LawParameters,
    settings: Floats,
    harmonics: Complexes,
    count: Integers,
    chosen: Integers,
    speeds: Floats,
    averages: Floats,
) -> None:
    """Write the averages of `elliptic_averages` for motions with any number of extrema.

    `harmonics` has shape (p, H).
    """
    rapidity = np.empty(speeds.size)
    for point in chosen:
        own = harmonics[point, : count[point]]
        averages[:, point] = 0.0
        omega, load, mean = settings[point, OMEGA], settings[point, LOAD], settings[point, MEAN]
        equilibrium = settings[point, EQUILIBRIUM]
        plain, weighted = averages[0, point], averages[1, point]
        _average(kind, damped, law, omega, load, equilibrium, mean, own, speeds, rapidity, plain, weighted)


@kernel(**INNER)
def _average(
    kind: CompileTimeInt,
    damped: CompileTimeInt,
    law: LawParameters,
    omega: float,
    load: float,
    equilibrium: float,
    mean: float,
    own: Complexes,
    speeds: Floats,
    last_rapidity: Floats,
    plain: Floats,
    weighted: Floats,
) -> None:
    r"""Write the averages of one motion.

    Notes
    -----
    Over a cell in which the velocity changes linearly from :math:`v_1` to :math:`v_2`, the mean is

    .. math::
        \left\langle\frac{v_r}{\sqrt{v_r^2 + v^2}}\right\rangle
        = \frac{v_r}{v_2 - v_1} \left(\mathrm{arsinh}\frac{v_2}{v_r} - \mathrm{arsinh}\frac{v_1}{v_r}\right) .
    """
    cells = max(_CELLS_PER_HARMONIC * own.size, _MIN_CELLS)
    last_velocity, last_force = 0.0, 0.0
    for j in range(cells + 1):
        x, slope = _displacement_and_slope(own, 2 * np.pi * j / cells)
        velocity = omega * slope
        force = contact_force(kind, damped, law, load, equilibrium, mean + x, velocity) / load
        if j == 0:
            for s in range(speeds.size):
                last_rapidity[s] = np.arcsinh(velocity / speeds[s])
        else:
            for s in range(speeds.size):
                speed, rise, rapidity = speeds[s], velocity - last_velocity, np.arcsinh(velocity / speeds[s])
                if abs(rise) > 1e-6 * speed:
                    ratio = speed * (rapidity - last_rapidity[s]) / rise
                else:
                    ratio = speed / np.sqrt(speed * speed + velocity * velocity)
                last_rapidity[s] = rapidity
                plain[s] += ratio / cells
                weighted[s] += 0.5 * (force + last_force) * ratio / cells
        last_velocity, last_force = velocity, force


@kernel(**INNER)
def _displacement_and_slope(own: Complexes, phase: float) -> tuple[float, float]:
    """Displacement about the mean and its derivative by phase."""
    cosine, sine = np.cos(phase), np.sin(phase)
    c, s, x, slope = 1.0, 0.0, 0.0, 0.0
    for k in range(1, own.size + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = own[k - 1].real * c - own[k - 1].imag * s, own[k - 1].real * s + own[k - 1].imag * c
        x += real
        slope -= k * imaginary
    return x, slope
