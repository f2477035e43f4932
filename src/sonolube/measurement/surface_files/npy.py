"""NPY files of numpy: a matrix of heights without unit or spacing."""

import warnings
from pathlib import Path
from typing import BinaryIO, ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.surface_reading import SurfaceReading

_SIGNATURE = b"\x93NUMPY"


@final
class Npy:
    """NPY files of numpy that hold a matrix of heights, in metres unless a unit is given."""

    name: ClassVar[str] = "NPY"
    suffixes: ClassVar[tuple[str, ...]] = (".npy",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with the signature of NPY."""
        return head.startswith(_SIGNATURE)

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of an NPY file.

        Without spacing and unit, which the format does not hold.
        """
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about headers of old versions
                mapped = np.load(path, mmap_mode="r", allow_pickle=False)
                is_matrix = mapped.ndim == 2 and mapped.dtype.kind in "fiu"
                height = np.array(mapped, dtype=np.float64) if is_matrix else None
        except Exception as failure:  # numpy evaluates the header, which raises exceptions of any type
            raise InvalidInput(f"{path}: not a whole NPY file: {' '.join(str(failure).split())[:200]}") from None
        if height is None:
            raise InvalidInput(f"{path}: heights are a matrix of numbers, got shape {mapped.shape} of {mapped.dtype}")
        return SurfaceReading(height=height, format_name=self.name, states_unit=False, metres_by_default=True)
