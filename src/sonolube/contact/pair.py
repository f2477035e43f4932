"""The two bodies of a contact, as the asperity models see them."""

from dataclasses import dataclass

from sonolube.checks import require_positive, require_within
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class ElasticBody:
    """One linearly elastic, isotropic body.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio : float
        Poisson's ratio, from 0 to 0.5. []
    """

    youngs_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        require_positive(youngs_modulus=self.youngs_modulus)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus. [Pa]"""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactPair:
    """Two bodies in contact, of which the softer yields first.

    Parameters
    ----------
    effective_modulus : float
        1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2. [Pa]
    poisson_ratio : float
        Poisson's ratio of the softer body. []
    yield_strength : float
        Yield strength of the softer body; infinite for bodies that never yield. [Pa]
    mindlin_ratio : float
        Tangential over normal stiffness of a sticking elastic contact, 4 G*/E*, 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2. []

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 7.2. doi:10.1017/CBO9781139171731
    """

    effective_modulus: float
    poisson_ratio: float
    yield_strength: float
    mindlin_ratio: float

    def __post_init__(self) -> None:
        require_positive(effective_modulus=self.effective_modulus, mindlin_ratio=self.mindlin_ratio)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)
        if not self.yield_strength > 0:
            raise InvalidInput(f"yield_strength must be positive, got {self.yield_strength!r} Pa")


def like_bodies_mindlin_ratio(*, poisson_ratio: float) -> float:
    """Return tangential over normal stiffness of two bodies of one material, 2 (1 - nu)/(2 - nu). []

    Parameters
    ----------
    poisson_ratio : float
        Poisson's ratio of both. []

    Returns
    -------
    float

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949).
    """
    require_within(0.0, 0.5, poisson_ratio=poisson_ratio)
    return 2 * (1 - poisson_ratio) / (2 - poisson_ratio)


def contact_pair(*, softer: ElasticBody, harder: ElasticBody, yield_strength: float) -> ContactPair:
    """Return the pair that two bodies form.

    Parameters
    ----------
    softer, harder : ElasticBody
    yield_strength : float
        Yield strength of the softer body. [Pa]

    Returns
    -------
    ContactPair
    """
    combined = 1 / sum((1 - body.poisson_ratio**2) / body.youngs_modulus for body in (softer, harder))
    combined_shear = 1 / sum((2 - body.poisson_ratio) / body.shear_modulus for body in (softer, harder))
    return ContactPair(
        effective_modulus=combined,
        poisson_ratio=softer.poisson_ratio,
        yield_strength=yield_strength,
        mindlin_ratio=4 * combined_shear / combined,
    )
