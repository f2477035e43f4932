"""LuGre friction: elastic bristles with a Stribeck curve as slip limit, bristle damping and viscous friction."""

from dataclasses import dataclass

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class LuGreFriction:
    r"""LuGre law of friction for one contact at a constant normal load.

    Parameters
    ----------
    coulomb_friction_force : float
        Friction force of fast sliding without viscous friction, F_c. [N]
    static_friction_force : float
        Friction force of slow sliding, F_s, at least F_c. [N]
    stribeck_velocity : float
        Velocity of the transition between both, v_s. [m/s]
    bristle_stiffness : float
        Stiffness of all bristles, sigma_0. [N/m]
    bristle_damping : float
        Damping of the bristle deflection, sigma_1. [N s/m]
    viscous_coefficient : float
        Coefficient of viscous friction, sigma_2. [N s/m]

    Raises
    ------
    InvalidInput
        If a force, velocity or stiffness is not positive, a damping negative, or F_s below F_c.

    Notes
    -----
    .. math::

        \frac{\mathrm{d}z}{\mathrm{d}t} &= v - \frac{|v|}{g(v)}\, z, \qquad
        \sigma_0\, g(v) = F_c + (F_s - F_c)\, e^{-(v/v_s)^2} \tag{D 1.4} \\
        F &= \sigma_0 z + \sigma_1 \frac{\mathrm{d}z}{\mathrm{d}t} + \sigma_2 v \tag{D 1.5}

    with the mean bristle deflection z and the sliding velocity v, whose modulus D 1.4 omits. Without damping, viscous
    friction and Stribeck effect this is Dahl's law.

    See Also
    --------
    DahlFriction : The law without Stribeck effect and damping.

    References
    ----------
    .. [1] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995).
       doi:10.1109/9.376053
    """

    coulomb_friction_force: float
    static_friction_force: float
    stribeck_velocity: float
    bristle_stiffness: float
    bristle_damping: float
    viscous_coefficient: float

    def __post_init__(self) -> None:
        require_positive(
            coulomb_friction_force=self.coulomb_friction_force,
            static_friction_force=self.static_friction_force,
            stribeck_velocity=self.stribeck_velocity,
            bristle_stiffness=self.bristle_stiffness,
        )
        require_non_negative(bristle_damping=self.bristle_damping, viscous_coefficient=self.viscous_coefficient)
        if self.static_friction_force < self.coulomb_friction_force:
            raise InvalidInput(
                f"static_friction_force must be at least coulomb_friction_force, {self.coulomb_friction_force!r} N,"
                f" got {self.static_friction_force!r} N"
            )
