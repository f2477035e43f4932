"""Mean friction ratio by Dahl's law with the tangential stiffness of the cube, as the dissertation adopts it."""

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.contact_motion import ContactMotion, require_open_gap
from sonolube.models.contact.period_mean import richardson_period_mean
from sonolube.models.contact.rough import RoughContact
from sonolube.models.contact.tangential_stiffness import cube_tangential_stiffness
from sonolube.models.friction.laws.steady_period_kernel import steady_period_mean_force
from sonolube.models.friction.models.model import FrictionModel


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class Dahl(FrictionModel):
    r"""One bristle that approaches its limit gradually, with the stiffness of the cube and any motion of the contact.

    Notes
    -----
    .. math::

        \frac{\mathrm{d}\boldsymbol\delta}{\mathrm{d}t} = \boldsymbol v - \frac{k_t(t) |\boldsymbol v|}{\mu F_n(t)}\,
        \boldsymbol\delta, \qquad \boldsymbol F = k_t(t)\, \boldsymbol\delta

    with the stiffness D 3.9 of the cube at each gap. The force is that of the whole deformation: where stiffness and
    limit rise together the deformation they allow does not change, and vibration along the normal alone changes
    friction only as far as the cube stiffens more than the load, with its area squared. Nothing is fitted. Under a
    harmonic motion it is `dahl_under_vibration`. Relative error 1e-4.

    See Also
    --------
    LuGre : Bristles of constant stiffness, with the Stribeck effect.
    BristleWithHolder : A bristle whose force grows with the increment of the deformation, with `dahl_exponent` 1.

    References
    ----------
    .. [1] D 3.9 to 3.11, with the vibration within the plane in v_rel.
    .. [2] P. R. Dahl, AIAA J. 14, 1675 (1976). doi:10.2514/3.61511
    """

    name: ClassVar[str] = "dahl"
    citation: ClassVar[str] = "D 3.9 to 3.11, after P. R. Dahl 1976"

    range_note: ClassVar[str] = (
        "the cube stiffens faster than its load under this vibration, and the whole deformation is carried along; lower"
        " the amplitude, or use asperity_stick_slip"
    )
    directions: ClassVar[frozenset[str]] = frozenset({"normal", "along", "across"})

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        if mu is None:
            raise InvalidInput(f"{self.name} requires a friction_coefficient, which limits the force of the bristle")
        coefficient = float(require_positive(friction_coefficient=mu))
        d = require_open_gap(contact, motion)

        def normalized_friction(sampled: ContactMotion) -> Floats:
            n = sampled.displacement.size
            amid = [(values + np.roll(values, -1)) / 2 for values in (sampled.displacement, sampled.normal_force)]
            stiffness = cube_tangential_stiffness(contact, separation=d + amid[0])
            limit = np.maximum(coefficient * amid[1], np.finfo(np.float64).tiny)  # where contact is lost
            along, across = (
                np.zeros(n) if each is None else np.roll(each, -1) - each for each in (sampled.along, sampled.across)
            )
            slides = along + v_r[:, np.newaxis] / (motion.frequency * n)
            rows, limits = (np.broadcast_to(each, slides.shape).copy() for each in (stiffness, limit))
            paths, weights = np.hypot(slides, across), np.full(slides.shape, 1 / n)
            forces = steady_period_mean_force(rows, limits, slides, paths, weights)
            return np.asarray(forces / (coefficient * motion.normal_load))

        return richardson_period_mean(normalized_friction, motion)
