"""Mean friction ratio of a smooth contact that a squeeze film of air carries in part (partial levitation)."""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.rough import RoughContact, normal_force, separation, separation_range
from sonolube.models.contact.squeeze_film import (
    AIR_VISCOSITY,
    STANDARD_ATMOSPHERE,
    leakage_factor,
    squeeze_film_pressure,
    squeeze_number,
)
from sonolube.models.friction.models.model import FrictionModel, parameter

_HALVINGS = 90  # of the interval of the rise
_THICKEST = 0.1  # of the radius of the face, beyond which the film is no thin one


class PartialLevitation(NamedTuple):
    """Load of a vibrating contact shared between an air film and the asperities.

    Parameters
    ----------
    film_load_fraction : float
        Share of the load on the film. []
    film_thickness : float
        Mean gap. [m]
    squeeze_number : float
        At that gap. []
    """

    film_load_fraction: float
    film_thickness: float
    squeeze_number: float


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class SqueezeFilm(FrictionModel):
    r"""Air film and asperities share the load; friction is that of the asperities alone (partial levitation).

    Parameters
    ----------
    following_fraction : float
        Fraction of the motion of the face that the other surface follows, from 0 to 1: the gap vibrates by the rest. []
    ambient_pressure : float
        Pressure of the gas around the face. [Pa]
    viscosity : float
        Dynamic viscosity of the gas. [Pa s]

    Raises
    ------
    InvalidInput
        If a value is out of range.

    Notes
    -----
    The mean gap h settles where film and asperities carry the load,

    .. math::

        A\, p_a \left[ \sqrt{\frac{1 + \frac32 (a/h)^2}{1 - (a/h)^2}} - 1 \right] g(\sigma)
        + \langle F_n(h + x) \rangle = F_N, \qquad
        \frac{F_1}{F_0} = \frac{\langle F_n(h + x) \rangle}{F_N}

    with the force F_n of the rough contact at a separation, the vibration x of amplitude a, a circular face of the
    nominal area A and the leakage g at the rim. Asperities rub with Coulomb's friction at every instant: that they
    stick, deform along the sliding and bounce is left out, which reduces friction as well and which the other models
    are of.
    Asperities much stiffer than the film touch at the lowest point of the period alone: the gap is that at rest and the
    amplitude, and friction is 0 from the amplitude on that carries the load at it.

    See Also
    --------
    sonolube.models.contact.levitation_amplitude : Amplitude that carries a load at a gap.

    References
    ----------
    .. [1] E. O. J. Salbu, J. Basic Eng. 86, 355 (1964). doi:10.1115/1.3653080
    .. [2] M. Wiertlewski, R. Fenton Friesen and J. E. Colgate, Proc. Natl. Acad. Sci. USA 113, 9210 (2016): the load is
       shared between the asperities of the skin and a squeeze film of air. doi:10.1073/pnas.1603908113
    """

    name: ClassVar[str] = "squeeze_film"
    citation: ClassVar[str] = "E. O. J. Salbu, J. Basic Eng. 86, 355 (1964), load shared as by Wiertlewski (2016)"
    needs_open_gap: ClassVar[bool] = False
    for_soft_bodies: ClassVar[bool] = True
    tested: ClassVar[str] = (
        "theory alone: compared with no experiment, since no friction of a finger or a plate is published with all its"
        " conditions; of the sign of two statements, up to 95 % less friction of a finger on glass (Wiertlewski 2016)"
        " and markedly less of that in a 98 % vacuum (Friesen 2017); bouncing, sticking skin is left out"
    )

    following_fraction: float = parameter(0.0)
    ambient_pressure: float = parameter(STANDARD_ATMOSPHERE, positive=True)
    viscosity: float = parameter(AIR_VISCOSITY, positive=True)

    def __post_init__(self) -> None:
        FrictionModel.__post_init__(self)
        if not 0 <= self.following_fraction <= 1:
            raise InvalidInput(f"following_fraction must lie between 0 and 1, got {self.following_fraction!r}")

    def levitation(self, contact: RoughContact, motion: ContactMotion) -> PartialLevitation:
        """Share of the load on the film under a motion, and the mean gap.

        Parameters
        ----------
        contact : RoughContact
        motion : ContactMotion
            Its mean has no effect: the mean gap follows from the load.

        Returns
        -------
        PartialLevitation

        Raises
        ------
        OutsideRange
            If the film would be thicker than a tenth of the radius of the face.
        """
        radius = math.sqrt(contact.nominal_area / math.pi)
        x = (1 - self.following_fraction) * (motion.displacement - motion.displacement.mean())
        a = float(np.ptp(x)) / 2
        rest = float(separation(contact, normal_load=motion.normal_load))
        if a == 0:
            return PartialLevitation(0.0, rest, self._squeeze_number(radius, rest, motion.frequency))

        def shares(gap: float) -> tuple[float, float]:
            excess = squeeze_film_pressure(
                vibration_amplitude=a, film_thickness=gap, ambient_pressure=self.ambient_pressure
            )
            leaking = leakage_factor(squeeze_number=self._squeeze_number(radius, gap, motion.frequency))
            film = float(excess * leaking) * contact.nominal_area / motion.normal_load
            return film, _mean_contact_force(contact, gap + x) / motion.normal_load

        low, high = a * (1 + 1e-12), max(a, rest) * 1.01
        while sum(shares(high)) > 1:
            high *= 2
            if high > _THICKEST * radius:
                raise OutsideRange(
                    f"the air film under {motion.normal_load:.3g} N would be thicker than a tenth of the radius of the"
                    f" face, {radius:.3g} m: it flies, and squeeze_film does not hold; raise the load"
                )
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if sum(shares(middle)) > 1 else (low, middle)
        film, _ = shares(high)
        return PartialLevitation(min(film, 1.0), high, self._squeeze_number(radius, high, motion.frequency))

    def mechanism(self, contact: RoughContact, motion: ContactMotion) -> str:
        """Share of the load on the film, mean gap and squeeze number."""
        found = self.levitation(contact, motion)
        return (
            f"the air film carries {100 * found.film_load_fraction:.3g} % of the load at a mean gap of"
            f" {1e6 * found.film_thickness:.3g} um, squeeze number {found.squeeze_number:.3g}"
        )

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        return np.full(v_r.shape, 1 - self.levitation(contact, motion).film_load_fraction)

    def _squeeze_number(self, radius: float, gap: float, frequency: float) -> float:
        return float(
            squeeze_number(
                face_radius=radius,
                film_thickness=gap,
                frequency=frequency,
                viscosity=self.viscosity,
                ambient_pressure=self.ambient_pressure,
            )
        )


def _mean_contact_force(contact: RoughContact, gap: Floats) -> float:
    """Mean force of the asperities over a period of the separation; none beyond the range of their heights. [N]"""
    _, highest = separation_range(contact)
    near = gap < highest
    return float(np.sum(normal_force(contact, separation=gap[near]))) / gap.size if near.any() else 0.0
