"""File formats of surfaces: their protocol and the ordered table of all of them.

A format is one class in a file of its own and one line of `SURFACE_FORMATS`; detection and documentation derive from
the table.
"""

from pathlib import Path
from typing import BinaryIO, Protocol

from sonolube.measurement.file_format import FileFormat
from sonolube.measurement.surface_files.surface_reading import SurfaceReading
from sonolube.variants import VariantTable


class SurfaceFormat(FileFormat, Protocol):
    """Reader of one file format of surfaces."""

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of a surface file and what else it states.

        Parameters
        ----------
        stream : binary file
            The file, open for reading; seekable.
        path : Path
            Of the file, for messages, and for libraries that open it themselves.

        Returns
        -------
        SurfaceReading

        Raises
        ------
        InvalidInput
            Naming the file, the byte where known, and the reason, if the file cannot be read.
        """


SURFACE_FORMATS: VariantTable[SurfaceFormat] = VariantTable(
    "surface format",
    {
        "Wyko OPD": "sonolube.measurement.surface_files.wyko:WykoOpd",
        "NanoFocus NMS": "sonolube.measurement.surface_files.nms:NanoFocusNms",
        "NPY": "sonolube.measurement.surface_files.npy:Npy",
        "XYZ text": "sonolube.measurement.surface_files.xyz:XyzText",
        "SurfaceTopography": "sonolube.measurement.surface_files.surface_topography:SurfaceTopographyFormats",
    },
    made=lambda known: known(),
)
"""File formats of surfaces in order of detection, the last one as fallback; a new one takes its file and one line."""
