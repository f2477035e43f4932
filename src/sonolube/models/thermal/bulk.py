"""Bulk temperature rise: a pin as a fin in closed form, and networks of lumped bodies exactly by their modes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.models.thermal.source import ThermalSolid


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedPin:
    """A cylindrical pin heated uniformly at its end face and cooled by convection along its side: a fin.

    Parameters
    ----------
    solid : ThermalSolid
    pin_radius : float
        Radius of the pin, r. [m]
    length : float
        Length of the pin, L. [m]
    convection_coefficient : float
        Heat transfer coefficient from the side to the air, h. [W/(m2 K)]

    Raises
    ------
    InvalidInput
        If a length is not positive, the convection negative, or a value not finite.

    Notes
    -----
    The temperature is uniform over the cross section, which holds for Biot numbers h r/k well below 0.1.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 4.5.
    """

    solid: ThermalSolid
    pin_radius: float
    length: float
    convection_coefficient: float

    def __post_init__(self) -> None:
        require_positive(pin_radius=self.pin_radius, length=self.length)
        require_non_negative(convection_coefficient=self.convection_coefficient)

    @property
    def cross_section(self) -> float:
        """Area of the heated face. [m2]"""
        return float(np.pi * self.pin_radius**2)

    @property
    def heat_capacity(self) -> float:
        """Heat that raises the temperature of the whole pin by one kelvin. [J/K]"""
        return self.cross_section * self.length * self.solid.density * self.solid.specific_heat_capacity

    @property
    def fin_parameter(self) -> float:
        """Dimensionless fin parameter m L with m = sqrt(2 h/(k r)). []"""
        h, k = self.convection_coefficient, self.solid.thermal_conductivity
        return float(np.sqrt(2 * h / (k * self.pin_radius)) * self.length)


def pin_rise(pin: HeatedPin, *, heat_rate: ArrayLike, depth: ArrayLike = 0.0) -> Floats:
    r"""Steady temperature rise along a pin, a fin whose far end is held at the temperature of the air. [K]

    Parameters
    ----------
    pin : HeatedPin
    heat_rate : array_like
        Heat into the end face per time. [W]
    depth : array_like, broadcast against `heat_rate`
        Distance from the heated face. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a heat is negative, a depth lies outside the pin, or a value is not finite.

    Notes
    -----
    With :math:`m = \sqrt{2h/(k r)}`,

    .. math:: \Delta T = \frac{Q}{k \pi r^2 m} \frac{\sinh m(L - z)}{\cosh m L} .
    """
    x = require_within(0.0, pin.length, depth=depth) / pin.length
    m = max(pin.fin_parameter, 1e-8)  # below this value convection is negligible and the profile linear
    profile = -np.expm1(-2 * m * (1 - x)) * np.exp(-m * x) / (1 + np.exp(-2 * m))  # sinh m(1-x) over cosh m
    gradient = require_non_negative(heat_rate=heat_rate) / (pin.solid.thermal_conductivity * pin.cross_section)
    return np.asarray(gradient * pin.length / m * profile)


def pin_conductance(pin: HeatedPin) -> float:
    """Steady thermal conductance of a pin: heat into its face per kelvin of rise of that face. [W/K]

    Parameters
    ----------
    pin : HeatedPin
        Its far end is held at the temperature of the air, as in `pin_rise`.

    Returns
    -------
    float
    """
    return 1 / float(pin_rise(pin, heat_rate=1.0))


@dataclass(frozen=True, kw_only=True, slots=True)
class ThermalNetwork:
    """Lumped heat capacities joined by thermal conductances to each other and to surroundings of constant temperature.

    Parameters
    ----------
    heat_capacity : tuple of float
        Heat capacity of each body, C. [J/K]
    links : tuple of tuple
        First body, second body and the conductance between them in W/K, for each pair that is joined.
    losses : tuple of float
        Conductance from each body to the surroundings, in W/K.

    Raises
    ------
    InvalidInput
        If a capacity is not positive, a conductance negative, a link names a body that does not exist, or the numbers
        of bodies differ.
    """

    heat_capacity: tuple[float, ...]
    links: tuple[tuple[int, int, float], ...]
    losses: tuple[float, ...]

    def __post_init__(self) -> None:
        require_positive(heat_capacity=self.heat_capacity)
        count = len(self.heat_capacity)
        if len(self.losses) != count:
            raise InvalidInput(f"losses must hold one conductance for each of {count} bodies, got {len(self.losses)}")
        require_non_negative(thermal_conductance=[*self.losses, *[conductance for _, _, conductance in self.links]])
        for first, second, _ in self.links:
            if not (0 <= first < count and 0 <= second < count and first != second):
                raise InvalidInput(f"links must join two of {count} bodies counted from 0, got {first} and {second}")

    @property
    def conductance_matrix(self) -> Floats:
        """Conductance matrix G: heat that leaves each body per kelvin of each body's rise, in W/K."""
        matrix = np.diag(np.asarray(self.losses, dtype=np.float64))
        for first, second, conductance in self.links:
            matrix[[first, second], [first, second]] += conductance
            matrix[[first, second], [second, first]] -= conductance
        return matrix


def network_rise(network: ThermalNetwork, *, time: ArrayLike, heat_rate: ArrayLike) -> Floats:
    r"""Transient temperature rise of every body of a network under stepwise constant heat input. [K]

    Parameters
    ----------
    network : ThermalNetwork
        At the first time all bodies are at the temperature of the surroundings.
    time : array_like, shape (n,)
        Increasing times; the first is the start. [s]
    heat_rate : array_like, shape (n - 1, bodies)
        Heat into each body, constant from each time to the next. [W]

    Returns
    -------
    ndarray, shape (n, bodies)

    Raises
    ------
    InvalidInput
        If times do not increase, the heat does not fit times and bodies, or a value is not finite.

    Notes
    -----
    Exact at the given times. The balance

    .. math:: \mathrm{diag}(C)\, \dot{T} + G\, T = Q

    is decoupled by the eigenvectors of :math:`C^{-1/2} G C^{-1/2}`; over an interval h a mode of rate
    :math:`\lambda` under the constant modal load p goes from a to
    :math:`a e^{-\lambda h} + p (1 - e^{-\lambda h})/\lambda`.
    """
    t = require_finite(time=time)
    q = require_finite(heat_rate=heat_rate)
    count = len(network.heat_capacity)
    if t.ndim != 1 or t.size < 2 or np.any(np.diff(t) <= 0):
        raise InvalidInput("time must be two or more increasing times")
    if q.shape != (t.size - 1, count):
        raise InvalidInput(f"heat_rate must have shape {(t.size - 1, count)}, got {q.shape}")
    root = np.sqrt(np.asarray(network.heat_capacity))
    rates, modes = np.linalg.eigh(network.conductance_matrix / np.outer(root, root))
    rates = np.maximum(rates, 0.0)  # a network without losses has a rate of zero, of either sign by rounding
    modal_loads = (q / root) @ modes
    modal = np.zeros((t.size, count))
    for step, interval in enumerate(np.diff(t)):
        decay = np.exp(-rates * interval)
        modal[step + 1] = decay * modal[step] + _step_response(rates, interval) * modal_loads[step]
    return np.asarray(modal @ modes.T / root)


def _step_response(rates: Floats, interval: float) -> Floats:
    """(1 - exp(-rate interval))/rate, in its limit the interval where the rate is zero."""
    safe = np.where(rates > 0, rates, 1.0)
    return np.where(rates > 0, -np.expm1(-safe * interval) / safe, interval)
