"""Measures of wear: specific wear rate, mass loss, and number of contacts made by a vibration."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive


def specific_wear_rate(*, wear_rate: ArrayLike, normal_load: ArrayLike) -> Floats:
    r"""Specific wear rate: volume lost per sliding distance and load. [m2/N]

    Parameters
    ----------
    wear_rate : array_like
        Volume lost per sliding distance. [m2]
    normal_load : array_like, broadcast against `wear_rate`
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a rate is negative, a load not positive, or a value not finite.

    Notes
    -----
    .. math:: k = \frac{W}{F_N}

    Examples
    --------
    >>> from sonolube.models.wear import specific_wear_rate
    >>> rate = specific_wear_rate(wear_rate=2.4e-11, normal_load=3.0)
    >>> round(1e9 * float(rate), 6)  # mm3/(N m)
    0.008
    """
    return require_non_negative(wear_rate=wear_rate) / require_positive(normal_load=normal_load)


def mass_loss(*, wear_volume: ArrayLike, density: ArrayLike) -> Floats:
    """Mass of a worn volume. [kg]

    Parameters
    ----------
    wear_volume : array_like
        Volume worn away. [m3]
    density : array_like, broadcast against `wear_volume`
        Mass density of the body that lost it. [kg/m3]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a volume is negative, a density not positive, or a value not finite.

    Examples
    --------
    >>> from sonolube.models.wear import mass_loss
    >>> from sonolube.text.units import format_si
    >>> format_si(float(mass_loss(wear_volume=2e-9, density=2700.0)), "kg")  # 2 mm3 of aluminium
    '5.4 mg'
    """
    return require_non_negative(wear_volume=wear_volume) * require_positive(density=density)


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
