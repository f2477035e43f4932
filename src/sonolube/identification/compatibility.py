"""Which demands can be met together: the smallest conflicts among them and the largest sets without any."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sonolube.errors import InvalidInput

_MOST_DEMANDS = 16  # all subsets are looked through


@dataclass(frozen=True, kw_only=True, slots=True)
class Compatibility:
    """What holds together among a set of demands.

    Parameters
    ----------
    conflicts : tuple of frozenset of str
        Smallest sets that cannot be met together: any one member left out, the others can.
    compatible : tuple of frozenset of str
        Largest sets that can be met together, larger first: any further demand breaks them.
    """

    conflicts: tuple[frozenset[str], ...]
    compatible: tuple[frozenset[str], ...]


def compatibility(names: Sequence[str], can_be_met: Callable[[frozenset[str]], bool]) -> Compatibility:
    """Return all smallest conflicts and all largest compatible sets.

    Parameters
    ----------
    names : sequence of str
        The demands, at most 16.
    can_be_met : callable
        Whether a set of demands can be met at once; a part of a set that can be met can be met too.

    Returns
    -------
    Compatibility

    Raises
    ------
    InvalidInput
        If there are more than 16 demands.

    Notes
    -----
    Sets are looked at from the largest down, those within a compatible set or around a conflict passed over, and each
    that fails is reduced to a smallest conflict by leaving out one member after another; so only about as many sets are
    tried as there are conflicts and compatible sets, times the demands.
    """
    if len(names) > _MOST_DEMANDS:
        raise InvalidInput(f"at most {_MOST_DEMANDS} facts can be weighed against each other, got {len(names)}")
    conflicts: list[frozenset[str]] = []
    compatible: list[frozenset[str]] = []
    for candidate in _subsets_largest_first(names):
        if any(candidate <= known for known in compatible) or any(known <= candidate for known in conflicts):
            continue
        if can_be_met(candidate):
            compatible.append(candidate)
        else:
            conflicts.append(_smallest_conflict(candidate, names, can_be_met))
    return Compatibility(conflicts=tuple(conflicts), compatible=tuple(compatible))


def _subsets_largest_first(names: Sequence[str]) -> list[frozenset[str]]:
    masks = sorted(range(2 ** len(names)), key=lambda mask: (-mask.bit_count(), mask))
    return [frozenset(name for bit, name in enumerate(names) if mask >> bit & 1) for mask in masks]


def _smallest_conflict(
    failing: frozenset[str], names: Sequence[str], can_be_met: Callable[[frozenset[str]], bool]
) -> frozenset[str]:
    for name in names:
        if name in failing and not can_be_met(failing - {name}):
            failing -= {name}
    return failing
