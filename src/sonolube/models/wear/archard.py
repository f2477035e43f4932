"""Archard's law of wear, volume lost in proportion to load over hardness, and number of contacts by a vibration."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class ArchardWear:
    """Archard's law of wear for one pair of materials.

    Parameters
    ----------
    wear_coefficient : float
        Probability that a contact of two asperities sheds a wear particle, K. []
    hardness : float
        Indentation hardness of the softer body, H. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    Holds for steady wear in one regime: K changes by orders of magnitude at the transition from mild to severe
    wear [1]_.

    References
    ----------
    .. [1] J. F. Archard, J. Appl. Phys. 24, 981 (1953). doi:10.1063/1.1721448
    """

    wear_coefficient: float
    hardness: float

    def __post_init__(self) -> None:
        require_positive(wear_coefficient=self.wear_coefficient, hardness=self.hardness)


def archard_wear_rate(law: ArchardWear, *, normal_load: ArrayLike) -> Floats:
    r"""Volume lost per sliding distance by Archard's law. [m2]

    Parameters
    ----------
    law : ArchardWear
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.

    Notes
    -----
    .. math:: W = \frac{K F_N}{H} \tag{D 1.6}

    References
    ----------
    .. [1] D 1.6.

    Examples
    --------
    >>> from sonolube.models.wear import ArchardWear, archard_wear_rate
    >>> from sonolube.text.units import format_quantity
    >>> law = ArchardWear(wear_coefficient=1e-4, hardness=1e9)
    >>> format_quantity(float(archard_wear_rate(law, normal_load=10.0)), "wear_rate")  # 1e-4 10 N/1 GPa
    '0.001 mm3/m'
    """
    load = require_non_negative(normal_load=normal_load)
    return law.wear_coefficient * load / law.hardness  # D 1.6


def vibration_contact_count(*, frequency: ArrayLike, duration: ArrayLike) -> Floats:
    """Number of contacts made by a vibration, one per period. []

    Parameters
    ----------
    frequency : array_like
        Frequency of the vibration. [Hz]
    duration : array_like, broadcast against `frequency`
        Duration of the vibration. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a frequency is not positive, a duration negative, or a value not finite.

    Examples
    --------
    >>> from sonolube.models.wear import vibration_contact_count
    >>> f"{float(vibration_contact_count(frequency=22e3, duration=4 * 3600)):.3g}"  # as in D Table 2.5
    '3.17e+08'
    """
    return require_positive(frequency=frequency) * require_non_negative(duration=duration)
