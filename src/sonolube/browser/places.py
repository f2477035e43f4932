"""Files of this computer that requests may name."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

OPENED: Final = "tribometer"
"""Name of the example that the first page shows."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Places:
    """Files of this computer that requests may name.

    Parameters
    ----------
    rigs : mapping of str to str
        Paths of rig files by name, beside those of the examples.
    uploads : str
        Folder of the files that were uploaded; empty for none.
    """

    rigs: Mapping[str, str]
    uploads: str = ""
