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
    device_map : str
        Path of the map of the rig's devices; empty for the virtual tribometer.
    runs : str
        Folder of all runs of the laboratory; empty for none.
    """

    rigs: Mapping[str, str]
    uploads: str = ""
    device_map: str = ""
    runs: str = ""
