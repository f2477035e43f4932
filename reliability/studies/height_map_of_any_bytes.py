"""Random bytes in place of a surface file."""

import random
import tempfile
from collections.abc import Sequence
from pathlib import Path

from reliability.study import Measure, Record, Study
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import read_height_map

_SUFFIXES = (".opd", ".xyz", ".npy", ".sur", ".x3p")


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"input{rng.choice(_SUFFIXES)}"
        path.write_bytes(rng.randbytes(rng.randrange(2000)))
        try:
            read_height_map(path)
        except InvalidInput as refused:
            message = str(refused)
            clear = message.startswith(f"{path}: ") and "\n" not in message
            return {"outcome": "refused" if clear else message}
    return {"outcome": "read"}


def _measures(records: Sequence[Record]) -> list[Measure]:
    refused = sum(record["outcome"] == "refused" for record in records)
    return [
        Measure(
            label="files refused in one line",
            value=f"{refused} of {len(records)}",
            bar="all",
            holds=refused == len(records),
        )
    ]


STUDY = Study(
    title="Random bytes as a surface file",
    question="A file of random bytes with the suffix of a surface format is refused in one line that names it.",
    sources=("measurement/surface_files/*.py",),
    trials=5000,
    sample=50,
    trial=_trial,
    measures=_measures,
)
