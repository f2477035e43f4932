"""Mean friction ratio of a vibrated contact by one bristle on an elastic holder, with normal and in-plane vibration."""

import math
from dataclasses import dataclass, fields
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, warn_of_range
from sonolube.models.contact.contact_motion import ContactMotion, delayed_oscillation, require_open_gap
from sonolube.models.contact.period_mean import richardson_period_mean
from sonolube.models.contact.rough import RoughContact
from sonolube.models.contact.tangential_stiffness import mindlin_tangential_stiffness
from sonolube.models.friction.bristle import (
    MAXIMUM_PERIODS,
    Holder,
    holder_propagators,
    mean_force_inertial_holder,
    mean_force_massless_holder,
)
from sonolube.models.friction.models.model import FrictionModel, parameter
from sonolube.models.friction.models.planar_stick_slip import planar_bristle_force


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class BristleWithHolder(FrictionModel):
    r"""One bristle with Mindlin's tangential stiffness, continuous through the period, on a rigid or elastic holder.

    Parameters
    ----------
    holder_stiffness : float
        Stiffness of the holder along the sliding direction; infinite for a rigid one. [N/m]
    holder_mass : float
        Mass that moves with the slider; zero for a spring alone. [kg]
    holder_damping : float
        Damping between slider and ground; requires a mass. [N s/m]
    in_plane_fraction : float
        Amplitude along the sliding direction over that along the normal. []
    in_plane_phase : float
        Lag of the in-plane motion behind the normal one. [rad]
    dahl_exponent : float
        Approach to the friction limit: 0 elastic up to it, as spring and slider in series; 1 gradual, after Dahl. []

    Raises
    ------
    InvalidInput
        If the stiffness is not positive, another value negative or not finite, the exponent neither 0 nor 1, or a
        holder without mass is damped or one with mass rigid.

    Notes
    -----
    .. math:: \frac{dF}{dt} = k_t(t) \, v \left(1 - \mathrm{sgn}(v) \frac{F}{\mu F_n}\right)^i,
              \qquad |F| \le \mu F_n(t)

    with the relative velocity :math:`v = v_r + \dot u - \dot y`, the in-plane motion u and that of the holder y,
    :math:`m \ddot y + c \dot y + K y = F`. The force grows with the increment of the deformation; a stiffness that
    multiplies the whole deformation, F = k_t(t) delta, would not reduce friction where k_t is in proportion to F_n.

    With a rigid holder, exponent 0 and a load-balanced sine the ratio is exactly 1 from v_r = mu omega a k_n/k_t on,
    and exp(-beta)/I0(beta) in the limit of slow sliding, with beta = a/l: the smallest ratio by vibration along the
    normal alone. An elastic holder without mass is a spring in series with the bristle.

    Under vibration across the sliding, on a rigid holder alone, the force is a vector within the plane: with exponent 0
    it follows the slide up to the limit and then a tractrix, as in `combined_oscillation_ratio`; with exponent 1 it is
    Dahl's law for bristles that yield alike in every direction,
    :math:`\dot{\boldsymbol F} = k_t (\boldsymbol v - |\boldsymbol v| \boldsymbol F/\mu F_n)`.

    The bristle is continuous while parts of the contact open and close. With in-plane motion in phase with the normal
    one its varying stiffness therefore increases the force; in `AsperityStickSlip`, where the force of every asperity
    restarts at each contact, it does not.

    See Also
    --------
    sonolube.models.friction.models.asperity_stick_slip.AsperityStickSlip : A population of asperities with loss of
    contact.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    .. [2] P. R. Dahl, AIAA J. 14, 1675 (1976). doi:10.2514/3.61511
    """

    name: ClassVar[str] = "bristle_with_holder"
    citation: ClassVar[str] = "M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017)"

    directions: ClassVar[frozenset[str]] = frozenset({"normal", "along", "across"})

    holder_stiffness: float = parameter(math.inf, positive=True)
    holder_mass: float = parameter(0.0, lowest=0.0)
    holder_damping: float = parameter(0.0, lowest=0.0)
    in_plane_fraction: float = parameter(0.0, lowest=0.0)
    in_plane_phase: float = parameter(0.0)
    dahl_exponent: float = parameter(0.0, lowest=0.0)

    def __post_init__(self) -> None:
        FrictionModel.__post_init__(self)
        if self.dahl_exponent not in (0, 1):
            raise InvalidInput(f"dahl_exponent must be 0 or 1, got {self.dahl_exponent!r}")
        _ = self.holder

    @property
    def holder(self) -> Holder:
        """Holder of the slider along the sliding direction."""
        return Holder(**{field.name: getattr(self, field.name) for field in fields(Holder)})

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        if mu is None:
            raise InvalidInput(f"{self.name} requires a friction_coefficient, which limits the force of the bristle")
        coefficient = float(require_positive(friction_coefficient=mu))
        if motion.across is not None and math.isfinite(self.holder_stiffness):
            raise InvalidInput(
                f"holder_stiffness: {self.name} has no law for a vibration across the sliding on an elastic holder;"
                " leave friction.holder_stiffness out for a rigid one"
            )
        d = require_open_gap(contact, motion)
        settled = True

        def normalized_friction(sampled: ContactMotion) -> Floats:
            nonlocal settled
            order = np.roll(np.arange(sampled.displacement.size), -int(np.argmin(sampled.normal_force)))
            limit = coefficient * sampled.normal_force[order]
            k = mindlin_tangential_stiffness(contact, separation=d + sampled.displacement[order])
            u = self._along(sampled)[order]
            step = 1 / (motion.frequency * order.size)
            slides = np.roll(u, -1) - u, v_r * step
            if sampled.across is not None:
                w = sampled.across[order]
                planar = slides[0], np.roll(w, -1) - w, slides[1], float(self.dahl_exponent)
                return planar_bristle_force(k, limit, *planar) / (coefficient * motion.normal_load)
            forces, settled = self._mean_force(k, limit, slides, step)
            return forces / (coefficient * motion.normal_load)

        ratio = richardson_period_mean(normalized_friction, motion)
        if not settled:
            warn_of_range(
                f"slider and holder reach no steady period within {MAXIMUM_PERIODS}; the mean over the last ones is"
                " returned. Increase holder_damping",
                stacklevel=3,
            )
        return ratio

    def _along(self, motion: ContactMotion) -> Floats:
        """Displacement along the sliding: that of the motion, else the fraction of its normal part. [m]"""
        if motion.along is not None:
            return motion.along
        return self.in_plane_fraction * delayed_oscillation(motion.displacement, phase=self.in_plane_phase)

    def _mean_force(self, k: Floats, limit: Floats, slides: tuple[Floats, Floats], step: float) -> tuple[Floats, bool]:
        """Mean force at each sliding speed, in N, and whether a steady period was reached."""
        exponent, stiffness = float(self.dahl_exponent), self.holder_stiffness
        if self.holder_mass == 0:
            return mean_force_massless_holder(k / (1 + k / stiffness), limit, *slides, exponent), True
        deflection = mean_force_massless_holder(k, limit, *slides, exponent) / stiffness
        matrices = holder_propagators(self.holder, step)
        forces, settled = mean_force_inertial_holder(k, limit, *slides, step, exponent, matrices, deflection)
        return forces, bool(settled)
