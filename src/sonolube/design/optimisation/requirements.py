"""What a design must keep to: limits of stack, bolt, contact, horn, temperature and amplifier."""

from dataclasses import dataclass

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput

OBJECTIVES = ("power", "heat", "voltage")
"""What can be made least: amplifier power (D 1.9), heat in the actuator, or swing of the drive."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Horn:
    """A prismatic half-wave horn between stack and contact, whose end moves as the tip does.

    Parameters
    ----------
    density : float
        Mass density. [kg/m3]
    youngs_modulus : float
        Young's modulus. [Pa]
    stress_limit : float
        Amplitude of the stress that it bears. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive.

    Notes
    -----
    The stress at the node is rho c times the velocity of the end, with c the root of E/rho.
    """

    density: float
    youngs_modulus: float
    stress_limit: float

    def __post_init__(self) -> None:
        require_positive(density=self.density, youngs_modulus=self.youngs_modulus, stress_limit=self.stress_limit)


@dataclass(frozen=True, kw_only=True, slots=True)
class Limits:
    """Limits beyond those of the stack; what is None is not judged.

    Parameters
    ----------
    voltage_maximum : float or None
        Highest voltage of the amplifier, either way. [V]
    current_maximum : float or None
        Highest current of the amplifier. [A]
    slew_rate_maximum : float or None
        Fastest change of the amplifier's voltage. [V/s]
    nominal_pressure : float or None
        Most that the contact bears at its highest force, over its nominal area. [Pa]
    temperature_rise : float or None
        Most that the actuator may warm. [K]
    thermal_conductance : float or None
        Heat that leaves the actuator per kelvin. [W/K]
    loss_tangent : float
        Dielectric loss tangent of the ceramic. []
    fatigue_safety : float
        Least safety of the bolt against fatigue. []
    yield_safety : float
        Least safety of the bolt against yielding. []
    horn : Horn or None
        Between stack and contact.

    Raises
    ------
    InvalidInput
        If a limit is not positive, or a temperature is to be kept without a conductance.
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
    horn: Horn | None = None

    def __post_init__(self) -> None:
        names = ("voltage_maximum", "current_maximum", "slew_rate_maximum", "nominal_pressure", "temperature_rise")
        given = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        require_positive(**given, fatigue_safety=self.fatigue_safety, yield_safety=self.yield_safety)
        require_non_negative(loss_tangent=self.loss_tangent)
        if self.thermal_conductance is not None:
            require_positive(thermal_conductance=self.thermal_conductance)
        if self.temperature_rise is not None and self.thermal_conductance is None:
            raise InvalidInput("temperature_rise needs thermal_conductance, the heat that leaves per kelvin")
