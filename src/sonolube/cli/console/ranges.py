"""Reading of KEY=VALUES options, such as drive.frequency=20kHz:24kHz:50: keys of a rig file with their values."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sonolube.design.ranges import ends_of, values_of
from sonolube.errors import InvalidInput

if TYPE_CHECKING:
    from sonolube.design.ranges import Values


def values_by_key(entries: Sequence[str] | None) -> "dict[str, Values]":
    """Values of each key of entries `KEY=first:last:count`, `KEY=first:last:count:log` or `KEY=one,two,...`.

    Parameters
    ----------
    entries : sequence of str or None
        As given by `--over`; None for none.

    Returns
    -------
    dict of str to ndarray
        Numbers in SI, or text for keys that are no quantity.

    Raises
    ------
    InvalidInput
        If an entry cannot be read.
    """
    return {key: values_of(key, text, option="--over") for key, text in _texts_by_key(entries).items()}


def ends_by_key(entries: Sequence[str] | None) -> dict[str, tuple[float, float]]:
    """Lowest and highest value of each key of entries `KEY=first:last`, in SI.

    Parameters
    ----------
    entries : sequence of str or None
        As given by `--over`; None for none.

    Returns
    -------
    dict of str to (float, float)

    Raises
    ------
    InvalidInput
        If an entry cannot be read.
    """
    return {key: ends_of(key, text, option="--over") for key, text in _texts_by_key(entries).items()}


def _texts_by_key(entries: Sequence[str] | None) -> dict[str, str]:
    """Text behind the equals sign of each entry, by key."""
    texts: dict[str, str] = {}
    for entry in entries or ():
        key, equals, text = (part.strip() for part in entry.partition("="))
        if not (key and equals and text):
            raise InvalidInput(f"--over {entry!r} must look like drive.frequency=20kHz:24kHz:50")
        if key in texts:
            raise InvalidInput(f"--over {key} was given twice")
        texts[key] = text
    return texts
