"""Roughness of the statistical contact models: spherical summits of one radius with distributed heights."""

from dataclasses import asdict, dataclass

from sonolube.checks import require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class Roughness:
    """Equivalent roughness of two surfaces in contact, as one rough surface against a smooth one.

    Parameters
    ----------
    rms_height : float
        Standard deviation of asperity heights, Rq. [m]
    summit_radius : float
        Mean radius of asperity summits, Rs. [m]
    summit_density : float
        Areal density of asperity summits. [1/m2]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    """

    rms_height: float
    summit_radius: float
    summit_density: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))

    @property
    def roughness_parameter(self) -> float:
        """Roughness parameter beta: density times standard deviation times radius; 0.03 to 0.05 for most surfaces."""
        return self.summit_density * self.rms_height * self.summit_radius
