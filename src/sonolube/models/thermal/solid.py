"""Thermal properties of a homogeneous, isotropic solid."""

from dataclasses import asdict, dataclass

from sonolube.checks import require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class ThermalSolid:
    """Conductivity, density and specific heat capacity of a homogeneous, isotropic solid.

    Parameters
    ----------
    thermal_conductivity : float
        Heat flux per temperature gradient, k. [W/(m K)]
    density : float
        Mass density, rho. [kg/m3]
    specific_heat_capacity : float
        Heat per mass and kelvin, c_p. [J/(kg K)]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    The properties do not depend on temperature, which holds for rises of some tens of kelvin.
    """

    thermal_conductivity: float
    density: float
    specific_heat_capacity: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))

    @property
    def thermal_diffusivity(self) -> float:
        """Thermal diffusivity, k/(rho c_p). [m2/s]"""
        return self.thermal_conductivity / (self.density * self.specific_heat_capacity)
