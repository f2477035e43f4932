"""File formats of impedance spectra: their protocol and the ordered table of all of them.

A format is one class in a file of its own and one line of `IMPEDANCE_FORMATS`; detection and documentation derive from
the table.
"""

from pathlib import Path
from typing import Protocol

from sonolube.measurement.file_format import FileFormat
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.variants import VariantTable


class ImpedanceFormat(FileFormat, Protocol):
    """Reader of one text file format of impedance spectra."""

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """Sweeps of a file by name.

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


IMPEDANCE_FORMATS: VariantTable[ImpedanceFormat] = VariantTable(
    "impedance format",
    {
        "touchstone": "sonolube.measurement.impedance.touchstone:Touchstone",
        "HP 4294A": "sonolube.measurement.impedance.hp4294a:Hp4294A",
        "Keysight E4990A": "sonolube.measurement.impedance.keysight_e4990a:KeysightE4990A",
        "Zurich Instruments MFIA": "sonolube.measurement.impedance.mfia:Mfia",
        "table with named columns": "sonolube.measurement.impedance.named_columns:NamedColumns",
    },
    made=lambda known: known(),
)
"""File formats of impedance spectra in order of detection, the last as fallback; a new one takes a file and a line."""
