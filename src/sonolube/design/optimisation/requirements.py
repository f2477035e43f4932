"""Objectives and limits of a design: stack, preload bolt, contact, horn, temperature and amplifier."""

from dataclasses import dataclass
from math import inf

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput

OBJECTIVES = ("power", "heat", "voltage")
"""Objectives that can be minimised: amplifier power (D 1.9), heat in the actuator, peak-to-peak drive voltage."""


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
