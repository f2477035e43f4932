"""Tables of numbers in CSV files without header."""

import io
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.storage.input_files import input_text

if TYPE_CHECKING:
    from sonolube.checks import Floats


def number_table(path: Path) -> "Floats":
    """Numbers of a CSV file without header, comments behind #, shape (rows, columns).

    Raises
    ------
    InvalidInput
        If the file is no table of numbers.
    """
    import numpy as np

    try:
        return np.loadtxt(io.StringIO(input_text(path)), delimiter=",", comments="#", ndmin=2, dtype=np.float64)
    except (OSError, ValueError) as failure:
        raise InvalidInput(f"{path}: is no table of numbers with commas between: {failure}") from None
