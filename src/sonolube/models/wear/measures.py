"""Number of contacts made by a vibration."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive


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
