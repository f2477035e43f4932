"""Material constants of a contact pair: effective modulus, yield strength and Mindlin's stiffness ratio."""

from dataclasses import dataclass

from sonolube.checks import require_positive, require_within
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class ElasticBody:
    """Elastic constants of one linearly elastic, isotropic body.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio : float
        Poisson's ratio, from 0 to 0.5. []

    Raises
    ------
    InvalidInput
        If the modulus is not positive, or Poisson's ratio outside 0 to 0.5.
    """

    youngs_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        require_positive(youngs_modulus=self.youngs_modulus)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus, E/(2 (1 + nu)). [Pa]"""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactPair:
    r"""Combined elastic constants of two bodies in contact, and the plastic constants of the softer one.

    Parameters
    ----------
    effective_modulus : float
        Effective contact modulus E*. [Pa]
    poisson_ratio : float
        Poisson's ratio of the softer body. []
    yield_strength : float
        Yield strength of the softer body; infinite for bodies without yielding. [Pa]
    mindlin_ratio : float
        Tangential over normal stiffness of a sticking elastic contact, 4 G*/E*. []

    Raises
    ------
    InvalidInput
        If a modulus, strength or ratio is not positive, or Poisson's ratio outside 0 to 0.5.

    Notes
    -----
    .. math::

        \frac1{E^*} = \frac{1 - \nu_1^2}{E_1} + \frac{1 - \nu_2^2}{E_2}, \qquad
        \frac1{G^*} = \frac{2 - \nu_1}{G_1} + \frac{2 - \nu_2}{G_2}, \qquad
        \frac{k_t}{k_n} = \frac{4 G^*}{E^*}

    See Also
    --------
    contact_pair : The pair of two bodies.

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


def identical_materials_mindlin_ratio(*, poisson_ratio: float) -> float:
    r"""Mindlin's ratio of tangential to normal contact stiffness for two bodies of one material. []

    Parameters
    ----------
    poisson_ratio : float
        Poisson's ratio of both bodies, from 0 to 0.5. []

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If Poisson's ratio is outside 0 to 0.5.

    Notes
    -----
    .. math:: \frac{k_t}{k_n} = \frac{2 (1 - \nu)}{2 - \nu}

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949).
    """
    require_within(0.0, 0.5, poisson_ratio=poisson_ratio)
    return 2 * (1 - poisson_ratio) / (2 - poisson_ratio)


def contact_pair(*, softer: ElasticBody, harder: ElasticBody, yield_strength: float) -> ContactPair:
    """Combined constants of two bodies in contact.

    Parameters
    ----------
    softer, harder : ElasticBody
    yield_strength : float
        Yield strength of the softer body. [Pa]

    Returns
    -------
    ContactPair

    Raises
    ------
    InvalidInput
        If the yield strength is not positive.

    Examples
    --------
    >>> from sonolube.models.contact import ElasticBody, contact_pair
    >>> from sonolube.text.units import format_si
    >>> aluminium = ElasticBody(youngs_modulus=73e9, poisson_ratio=0.33)
    >>> steel = ElasticBody(youngs_modulus=193e9, poisson_ratio=0.29)
    >>> pair = contact_pair(softer=aluminium, harder=steel, yield_strength=410e6)
    >>> format_si(pair.effective_modulus, "Pa")
    '59 GPa'
    """
    effective_modulus = 1 / sum((1 - body.poisson_ratio**2) / body.youngs_modulus for body in (softer, harder))
    effective_shear_modulus = 1 / sum((2 - body.poisson_ratio) / body.shear_modulus for body in (softer, harder))
    return ContactPair(
        effective_modulus=effective_modulus,
        poisson_ratio=softer.poisson_ratio,
        yield_strength=yield_strength,
        mindlin_ratio=4 * effective_shear_modulus / effective_modulus,
    )
