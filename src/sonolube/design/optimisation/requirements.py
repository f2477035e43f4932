"""Requirements on a design: objectives, limits of its parts, preload bolt, and manufacturing tolerances."""

import re
from dataclasses import dataclass
from itertools import product
from math import inf

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.models.actuator import PreloadBolt
from sonolube.text.units import to_si

OBJECTIVES = ("power", "heat", "voltage")
"""Objectives that can be minimised: power to supply, heat in the actuator, peak-to-peak drive voltage."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Aim:
    """Objective to minimise, and a second one with its upper bound.

    Parameters
    ----------
    minimise : str
        Objective to minimise, of `OBJECTIVES`.
    second_objective : str, optional
        Another objective, which is constrained.
    bound : float
        Upper bound of the second objective.
    """

    minimise: str
    second_objective: str | None = None
    bound: float = inf


@dataclass(frozen=True, kw_only=True, slots=True)
class HalfWaveHorn:
    r"""Prismatic half-wave horn between stack and contact, whose end moves as the tip does.

    Parameters
    ----------
    density : float
        Mass density. [kg/m3]
    youngs_modulus : float
        Young's modulus. [Pa]
    stress_limit : float
        Admissible stress amplitude. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive.

    Notes
    -----
    The stress amplitude at the displacement node of a half-wave bar whose end has the velocity amplitude :math:`\hat v`
    is

    .. math:: \hat\sigma = \rho c_0 \hat v = \sqrt{\rho E}\, \hat v
    """

    density: float
    youngs_modulus: float
    stress_limit: float

    def __post_init__(self) -> None:
        require_positive(density=self.density, youngs_modulus=self.youngs_modulus, stress_limit=self.stress_limit)


@dataclass(frozen=True, kw_only=True, slots=True)
class Limits:
    """Limits of a design beyond those of the stack itself; None for no limit.

    Parameters
    ----------
    voltage_maximum : float or None
        Highest absolute voltage of the amplifier. [V]
    current_maximum : float or None
        Highest current of the amplifier. [A]
    slew_rate_maximum : float or None
        Slew rate of the amplifier. [V/s]
    nominal_pressure : float or None
        Admissible nominal pressure of the contact at its highest normal force. [Pa]
    temperature_rise : float or None
        Admissible temperature rise of the actuator. [K]
    thermal_conductance : float or None
        Heat flow from the actuator to the surroundings per kelvin. [W/K]
    loss_tangent : float
        Dielectric loss tangent of the ceramic. []
    fatigue_safety : float
        Required safety factor of the bolt against fatigue. []
    yield_safety : float
        Required safety factor of the bolt against yielding. []
    horn : HalfWaveHorn or None
        Horn between stack and contact.

    Raises
    ------
    InvalidInput
        If a limit is not positive, or the temperature rise is limited without a thermal conductance.
    """

    voltage_maximum: float | None = None
    current_maximum: float | None = None
    slew_rate_maximum: float | None = None
    nominal_pressure: float | None = None
    temperature_rise: float | None = None
    thermal_conductance: float | None = None
    loss_tangent: float = 0.02
    fatigue_safety: float = 1.2
    yield_safety: float = 1.1
    horn: HalfWaveHorn | None = None

    def __post_init__(self) -> None:
        names = ("voltage_maximum", "current_maximum", "slew_rate_maximum", "nominal_pressure", "temperature_rise")
        given = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        require_positive(**given, fatigue_safety=self.fatigue_safety, yield_safety=self.yield_safety)
        require_non_negative(loss_tangent=self.loss_tangent)
        if self.thermal_conductance is not None:
            require_positive(thermal_conductance=self.thermal_conductance)
        if self.temperature_rise is not None and self.thermal_conductance is None:
            raise InvalidInput(
                "temperature_rise needs thermal_conductance, the heat flow to the surroundings per kelvin"
            )


_SAMPLES = 32
_TRUNCATION = 3  # standard deviations at which the sampled deviations are cut off


@dataclass(frozen=True, kw_only=True, slots=True)
class Deviation:
    """Factors between the parameters of a built rig and those of its nominal design.

    Parameters
    ----------
    stiffness : float
        Factor of the stack's stiffness, at its nominal coupling factor.
    mass : float
        Factor of all masses of the structure.
    gain : float
        Factor of the stroke per volt, and reciprocal factor of the damping.
    """

    stiffness: float = 1.0
    mass: float = 1.0
    gain: float = 1.0


NOMINAL = Deviation()
"""No deviation: the nominal design."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """Relative tolerance of stiffness, masses and gain, and the criterion over the deviations within it.

    Parameters
    ----------
    manufacturing_tolerance : float
        Largest relative deviation for the worst case, standard deviation for a quantile. []
    quantile : float or None
        Fraction of manufactured rigs that must meet the requirements; None for the worst case. []
    seed : int
        Seed of the sampled deviations of a quantile.

    Raises
    ------
    InvalidInput
        If the tolerance lies outside 0 to 0.3, or the quantile outside 0.5 to 1.
    """

    manufacturing_tolerance: float
    quantile: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        require_within(0.0, 0.3, manufacturing_tolerance=self.manufacturing_tolerance)
        if self.quantile is not None:
            require_within(0.5, 1.0, quantile=self.quantile)


def deviations(tolerance: Tolerance | None) -> tuple[Deviation, ...]:
    """Deviations at which a design is evaluated, the nominal one first.

    Parameters
    ----------
    tolerance : Tolerance or None
        None for the nominal design alone.

    Returns
    -------
    tuple of Deviation

    See Also
    --------
    worst_or_quantile

    Notes
    -----
    Worst case: four corners. Higher stiffness with lower masses raises the resonance frequency most, the reverse lowers
    it most; low gain requires the highest voltage, high gain causes the largest tension. Quantile: 32 deviations from
    independent normal distributions, truncated at three standard deviations.
    """
    if tolerance is None:
        return (NOMINAL,)
    t = tolerance.manufacturing_tolerance
    if tolerance.quantile is None:
        corners = [
            Deviation(stiffness=1 + shift * t, mass=1 - shift * t, gain=1 + gain * t)
            for shift, gain in product((-1, 1), (-1, 1))
        ]
        return (NOMINAL, *corners)
    sample = np.random.default_rng(tolerance.seed).standard_normal((_SAMPLES, 3)).clip(-_TRUNCATION, _TRUNCATION) * t
    return (NOMINAL, *[Deviation(stiffness=1 + k, mass=1 + m, gain=1 + g) for k, m, g in sample])


def worst_or_quantile(values: Floats, tolerance: Tolerance | None) -> Floats:
    """Maximum of values over the deviations, or their quantile over the sampled deviations.

    Parameters
    ----------
    values : ndarray, shape (deviations, ...)
        By the deviations of `deviations`, of which larger is worse; infinite where there is no result.
    tolerance : Tolerance or None

    Returns
    -------
    ndarray, shape (...)

    See Also
    --------
    deviations
    """
    if tolerance is None or tolerance.quantile is None:
        return np.asarray(values.max(axis=0))
    return np.asarray(np.quantile(values[1:], tolerance.quantile, axis=0, method="higher"))


_THREAD = re.compile(r"M(\d+(?:\.\d+)?)x(.+)")
_STEEL = 205e9  # Pa, Young's modulus of bolts


def preload_bolt(thread: str, *, preload: float, yield_strength: float, name: str) -> PreloadBolt:
    """Steel bolt by its thread and the length that stretches."""
    found = _THREAD.fullmatch(thread.strip())
    if not found:
        raise InvalidInput(f"{name} {thread} must look like M6x40mm: thread and length that stretches")
    return PreloadBolt(
        thread_diameter=1e-3 * float(found[1]),
        length=to_si(found[2], unit="m", name=name),
        youngs_modulus=_STEEL,
        yield_strength=yield_strength,
        preload=preload,
    )
