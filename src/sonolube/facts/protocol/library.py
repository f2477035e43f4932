"""Protocols of the dissertation's tests that come with the package, by name."""

from pathlib import Path
from typing import Final

from sonolube.errors import UnknownName
from sonolube.facts.protocol.record import Protocol
from sonolube.facts.protocol.text import read_protocol

_FOLDER: Final = Path(__file__).parent / "dissertation"


def protocol_names() -> tuple[str, ...]:
    """Names of the protocols that come with the package, such as map_test, in alphabetical order.

    Examples
    --------
    >>> from sonolube.facts.protocol import duration, protocol_by_name_or_file, protocol_names
    >>> "map_test" in protocol_names(), duration(protocol_by_name_or_file("map_test"))
    (True, 32.5)
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def protocol_path(name: str) -> Path:
    """File of a protocol that comes with the package, to be copied and changed.

    Parameters
    ----------
    name : str
        One of `protocol_names`.

    Returns
    -------
    Path

    Raises
    ------
    UnknownName
        If there is no such protocol.
    """
    if name not in protocol_names():
        raise UnknownName.among(protocol_names(), kind="protocol", name=name)
    return _FOLDER / f"{name}.toml"


def protocol_by_name_or_file(text: str) -> Protocol:
    """Protocol by its name, or by the path of its file.

    Parameters
    ----------
    text : str
        One of `protocol_names`, or the path of a TOML file.

    Returns
    -------
    Protocol

    Raises
    ------
    UnknownName
        If it is neither; the closest name is suggested.
    InvalidInput
        If the file has faults.
    """
    if text not in protocol_names() and (text.lower().endswith(".toml") or Path(text).exists()):
        return read_protocol(text)
    return read_protocol(protocol_path(text))
