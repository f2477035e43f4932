"""Bodies of one temperature each, joined by conductances: transients without time steps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class ThermalNetwork:
    """Bodies that exchange heat with each other and with surroundings of constant temperature.

    Parameters
    ----------
    heat_capacity : tuple of float
        Heat that warms each body by a kelvin. [J/K]
    links : tuple of tuple
        First body, second body and the conductance between them in W/K, for each pair that is joined.
    losses : tuple of float
        Conductance from each body to the surroundings, in W/K.

    Raises
    ------
    InvalidInput
        If a capacity is not positive, a conductance negative, a link leads nowhere, or the numbers of bodies differ.
    """

    heat_capacity: tuple[float, ...]
    links: tuple[tuple[int, int, float], ...]
    losses: tuple[float, ...]

    def __post_init__(self) -> None:
        require_positive(heat_capacity=self.heat_capacity)
        count = len(self.heat_capacity)
        if len(self.losses) != count:
            raise InvalidInput(f"losses must be one to a body, got {len(self.losses)} for {count}")
        require_non_negative(thermal_conductance=[*self.losses, *[conductance for _, _, conductance in self.links]])
        for first, second, _ in self.links:
            if not (0 <= first < count and 0 <= second < count and first != second):
                raise InvalidInput(f"links must join two of {count} bodies counted from 0, got {first} and {second}")

    @property
    def conductance_matrix(self) -> Floats:
        """Heat that leaves each body per kelvin of each body's rise, in W/K."""
        matrix = np.diag(np.asarray(self.losses, dtype=np.float64))
        for first, second, conductance in self.links:
            matrix[[first, second], [first, second]] += conductance
            matrix[[first, second], [second, first]] -= conductance
        return matrix


def network_rise(network: ThermalNetwork, *, time: ArrayLike, heat_rate: ArrayLike) -> Floats:
    """Return the rise of every body in time, heated by steps, from the temperature of the surroundings. [K]

    Parameters
    ----------
    network : ThermalNetwork
    time : array_like, shape (n,)
        Rising times; the first is the start. [s]
    heat_rate : array_like, shape (n - 1, bodies)
        Heat into each body, constant from each time to the next. [W]

    Returns
    -------
    ndarray, shape (n, bodies)

    Raises
    ------
    InvalidInput
        If times do not rise, the heat does not fit times and bodies, or a value is not finite.

    Notes
    -----
    Exact at the given times, by the modes of the network.
    """
    t = require_finite(time=time)
    q = require_finite(heat_rate=heat_rate)
    count = len(network.heat_capacity)
    if t.ndim != 1 or t.size < 2 or np.any(np.diff(t) <= 0):
        raise InvalidInput("time must be two or more rising times")
    if q.shape != (t.size - 1, count):
        raise InvalidInput(f"heat_rate must have shape {(t.size - 1, count)}, got {q.shape}")
    root = np.sqrt(np.asarray(network.heat_capacity))
    rates, shapes = np.linalg.eigh(network.conductance_matrix / np.outer(root, root))
    rates = np.maximum(rates, 0.0)  # a network without losses has a rate of zero, of either sign by rounding
    drives = (q / root) @ shapes
    modal = np.zeros((t.size, count))
    for step, interval in enumerate(np.diff(t)):
        decay = np.exp(-rates * interval)
        modal[step + 1] = decay * modal[step] + _grown(rates, interval) * drives[step]
    return np.asarray(modal @ shapes.T / root)


def _grown(rates: Floats, interval: float) -> Floats:
    """Return (1 - exp(-rate interval))/rate, which is the interval where the rate is zero."""
    safe = np.where(rates > 0, rates, 1.0)
    return np.where(rates > 0, -np.expm1(-safe * interval) / safe, interval)
