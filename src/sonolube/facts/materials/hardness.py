"""Tabor's relation between the indentation hardness and the yield strength of metals."""

from dataclasses import dataclass

from sonolube.checks import require_positive

_TABOR_FACTOR = 3.0
_MIN_FACTOR, _LARGEST_FACTOR = 2.0, 6.0
_SOURCE = "D. Tabor, The Hardness and Strength of Metals, J. Inst. Met. 79, 1 (1951): H = c Y, c = 2.8 to 3.2"


@dataclass(frozen=True, kw_only=True, slots=True)
class YieldStrengthEstimate:
    """Yield strength of a metal estimated from its hardness, with the range of the relation.

    Parameters
    ----------
    yield_strength : float
        Estimate, a third of the hardness. [Pa]
    low, high : float
        Range that holds the 0.2 % proof stress of nearly all metals of this hardness, in pascals.
    source : str
        Source of the relation.
    reason : str
        Why the range is as wide as it is.
    """

    yield_strength: float
    low: float
    high: float
    source: str = _SOURCE
    reason: str = (
        "indentation strains the metal by about 8 %: what hardens by work is weaker at first yield, down to a sixth"
    )


def yield_strength_from_hardness(*, hardness: float) -> YieldStrengthEstimate:
    r"""Yield strength of a metal from its indentation hardness by Tabor's relation.

    Parameters
    ----------
    hardness : float
        Vickers or Brinell hardness as a pressure. [Pa]

    Returns
    -------
    YieldStrengthEstimate

    Raises
    ------
    InvalidInput
        If the hardness is not positive and finite.

    Notes
    -----
    .. math:: H = c\,Y

    with c = 2.8 to 3.2 for the flow stress at a strain of 0.08, the strain of a Vickers indentation. [1]_ [2]_ Over the
    0.2 % proof stress the factor is 2 to 6: metals that harden by work yield early. Not for ceramics or polymers.

    References
    ----------
    .. [1] D. Tabor, J. Inst. Met. 79, 1 (1951).
    .. [2] E. J. Pavlina and C. J. Van Tyne, J. Mater. Eng. Perform. 17, 888 (2008). doi:10.1007/s11665-008-9225-5

    Examples
    --------
    >>> from sonolube.facts.materials import yield_strength_from_hardness
    >>> from sonolube.text.units import format_si
    >>> format_si(yield_strength_from_hardness(hardness=1.2e9).yield_strength, "Pa")  # a third
    '400 MPa'
    """
    pressure = float(require_positive(hardness=hardness))
    return YieldStrengthEstimate(
        yield_strength=pressure / _TABOR_FACTOR, low=pressure / _LARGEST_FACTOR, high=pressure / _MIN_FACTOR
    )
