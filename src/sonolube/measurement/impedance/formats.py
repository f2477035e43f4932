"""File formats of impedance spectra: their protocol and the ordered table of all of them.

A format is one class in a file of its own and one entry of `IMPEDANCE_FORMATS`; detection and documentation derive from
the table.
"""

from pathlib import Path
from typing import Protocol

from sonolube.measurement.file_format import FileFormat
from sonolube.measurement.impedance.hp4294a import Hp4294A
from sonolube.measurement.impedance.keysight_e4990a import KeysightE4990A
from sonolube.measurement.impedance.mfia import Mfia
from sonolube.measurement.impedance.named_columns import NamedColumns
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.impedance.touchstone import Touchstone


class ImpedanceFormat(FileFormat, Protocol):
    """Reader of one text file format of impedance spectra."""

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """Return the sweeps of a file by name.

        Parameters
        ----------
        path : Path
            Of the file, for messages.
        lines : list of str
            All lines of the file.

        Returns
        -------
        dict of str to ImpedanceSweep
            The measured sweep is called "data" where the format also stores others; a single sweep may have an empty
            name.

        Raises
        ------
        InvalidInput
            Naming the file, the line and the reason, if the file cannot be read as impedance over frequency.
        """


IMPEDANCE_FORMATS: tuple[ImpedanceFormat, ...] = (
    Touchstone(),
    Hp4294A(),
    KeysightE4990A(),
    Mfia(),
    NamedColumns(),
)
"""File formats of impedance spectra in order of detection; the last one is the fallback."""
