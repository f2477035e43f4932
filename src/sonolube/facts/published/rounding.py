"""Propagation of the rounding intervals of printed inputs to a computed value, by evaluation at their corners."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

from sonolube.facts.published.printed_number import PrintedNumber
from sonolube.facts.published.values import published_number


@dataclass(frozen=True, kw_only=True, slots=True)
class ComputedValue:
    """Value computed from printed inputs, with the interval that their rounding leaves; in SI.

    Parameters
    ----------
    value : float
        Value at the printed inputs.
    low, high : float
        Limits of the interval.

    Notes
    -----
    Computed values are ordered by `value`, so that `max` and `min` select the largest and the smallest one.
    """

    value: float
    low: float
    high: float

    def __lt__(self, other: "ComputedValue") -> bool:
        return self.value < other.value


def propagate_rounding(function: Callable[..., float], *inputs: PrintedNumber | str) -> ComputedValue:
    r"""Function of printed numbers with the interval that their rounding leaves.

    Parameters
    ----------
    function : callable
        Function of as many numbers in SI as there are inputs; monotonic in each over its rounding interval.
    *inputs : PrintedNumber or str
        Printed numbers, or ids of published ones as in `published_number`.

    Returns
    -------
    ComputedValue

    See Also
    --------
    as_exact, as_setting : Printed numbers without a rounding interval.

    Notes
    -----
    .. math:: \left[\min_s f(x_1 + s_1 h_1, \dots), \max_s f(x_1 + s_1 h_1, \dots)\right], \qquad s_i = \pm 1

    with the printed values x and the half-widths h of their rounding intervals. The corners of the box of inputs bound
    a function that is monotonic in each input.

    Examples
    --------
    >>> from sonolube.facts.published import parse_printed, propagate_rounding
    >>> forces = [parse_printed(text, "N", quantity="friction_force") for text in ("1.02", "0.36")]
    >>> reduction = propagate_rounding(lambda without, under: 1 - under / without, *forces)
    >>> round(reduction.low, 3), round(reduction.high, 3)  # 1 - 0.365/1.015, 1 - 0.355/1.025
    (0.64, 0.654)
    """
    numbers = [published_number(number) if isinstance(number, str) else number for number in inputs]
    intervals = [
        (number.value - number.rounding_half_width, number.value + number.rounding_half_width) for number in numbers
    ]
    values = [float(function(*corner)) for corner in product(*intervals)]
    return ComputedValue(
        value=float(function(*[number.value for number in numbers])), low=min(values), high=max(values)
    )


def as_exact(id: str) -> PrintedNumber:  # noqa: A002 - the field's own word
    """Published number without a rounding interval: that of a nominal setting."""
    number = published_number(id)
    return replace(number, low=number.value, high=number.value, rounding_half_width=0.0)


def as_setting(id: str) -> PrintedNumber:  # noqa: A002 - the field's own word
    """Published setting: exact if printed as a whole number, such as 11 turns or 4 h, else rounded."""
    return published_number(id) if "." in published_number(id).text else as_exact(id)
