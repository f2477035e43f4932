"""Queries of the catalogue, as text: material=brass,load=3N..6N,since=2026-01-01,tag=map."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.text.units import to_si

Range = tuple[float, float]

QUERY_KEYS: Final = ("material", "load", "speed", "since", "until", "tag", "text", "outcome")
"""Conditions by which runs are searched."""

_TOLERANCE: Final = 0.01  # of a load or speed that is no range


@dataclass(frozen=True, kw_only=True, slots=True)
class RunQuery:
    """Conditions that a run must meet, all of them.

    Parameters
    ----------
    materials : tuple of str
        Of pin or disc, by a part of the name.
    normal_load : (float, float) or None
        Lowest and highest. [N]
    sliding_speed : (float, float) or None
        Lowest and highest. [m/s]
    since, until : float or None
        Of the begin, in s since 1970.
    tags : tuple of str
    texts : tuple of str
        Each found anywhere in title, facts, protocol and notes.
    outcome : str
        Empty for any.
    """

    materials: tuple[str, ...] = ()
    normal_load: Range | None = None
    sliding_speed: Range | None = None
    since: float | None = None
    until: float | None = None
    tags: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    outcome: str = ""


def query_from(values: Mapping[str, Sequence[str]]) -> RunQuery:
    """Query by the texts of its conditions.

    Parameters
    ----------
    values : mapping of str to sequence of str
        By the names in `QUERY_KEYS`; material, tag and text may have several.

    Returns
    -------
    RunQuery

    Raises
    ------
    UnknownName
        If there is no such condition.
    InvalidInput
        If a value cannot be read, or a condition that may be given once is given again.
    """
    for key, texts in values.items():
        if key not in QUERY_KEYS:
            raise UnknownName.among(QUERY_KEYS, kind="condition of runs", name=key)
        if len(texts) > 1 and key not in ("material", "tag", "text"):
            raise InvalidInput(f"{key} is given {len(texts)} times; give it once")
    one = {key: texts[0] for key, texts in values.items() if texts}
    return RunQuery(
        materials=tuple(values.get("material", ())),
        normal_load=_range(one.get("load"), unit="N", name="load"),
        sliding_speed=_range(one.get("speed"), unit="m/s", name="speed"),
        since=_time(one.get("since"), name="since"),
        until=_time(one.get("until"), name="until"),
        tags=tuple(values.get("tag", ())),
        texts=tuple(values.get("text", ())),
        outcome=one.get("outcome", ""),
    )


def _range(text: str | None, *, unit: str, name: str) -> Range | None:
    """Range of a text such as 3N..6N, 3N.., or 5N, which allows one percent."""
    if text is None:
        return None
    low, dots, high = (part.strip() for part in text.partition(".."))
    if not dots:
        value = to_si(text, unit=unit, name=name)
        return value * (1 - _TOLERANCE), value * (1 + _TOLERANCE)
    found = (
        to_si(low, unit=unit, name=name) if low else float("-inf"),
        to_si(high, unit=unit, name=name) if high else float("inf"),
    )
    if not found[0] <= found[1]:
        raise InvalidInput(f"{name} {text} must lead from the lower to the higher value")
    return found


def _time(text: str | None, *, name: str) -> float | None:
    """Time of a date, in UTC where it names no zone. [s]"""
    if text is None:
        return None
    try:
        found = datetime.fromisoformat(text.strip())
        return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        raise InvalidInput(f"{name} {text[:40]!r} must be a date, such as 2026-01-31 or 2026-01-31T14:00") from None
