"""Formats of recordings: a format is one file and one entry of the table."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from pytest import approx, mark

from sonolube.measurement.impedance.spectrum import IMPEDANCE_FORMATS
from sonolube.measurement.measured_files import FileFormat
from sonolube.measurement.recordings.reader import RECORDING_FORMATS
from sonolube.measurement.surface_files.reader import SURFACE_FORMATS

PAGE = (Path(__file__).parents[3] / "docs" / "reference" / "measurement.md").read_text(encoding="utf-8")
TABLES: dict[str, Mapping[str, FileFormat]] = {
    "recordings": RECORDING_FORMATS,
    "impedance": IMPEDANCE_FORMATS,
    "surface_files": SURFACE_FORMATS,
}

TOY_FORMAT = '''
"""Toy recordings: a signature, the sample rate in Hz, then one friction force in N per line."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable


@dataclass(frozen=True, slots=True)
class Toy:
    """Toy recordings."""

    name: ClassVar[str] = "toy"
    suffixes: ClassVar[tuple[str, ...]] = (".toy",)

    def recognises(self, head: bytes, path: Path) -> bool:
        return head.startswith(b"TOY")

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        _, rate, *forces = path.read_text().split()
        values = np.array(forces, dtype=float)
        force = RawColumn(label="friction_force", unit="N", values=values, interval=1 / float(rate))
        return RawTable(columns=(force,), format_name=self.name)
'''


@mark.parametrize("room", TABLES)
def test_names_of_formats_are_unique_and_their_suffixes_are_lower_case(room: str) -> None:
    assert [one.name for one in TABLES[room].values()] == list(TABLES[room])
    suffixes = [suffix for one in TABLES[room].values() for suffix in one.suffixes]
    assert all(suffix.startswith(".") and suffix == suffix.lower() for suffix in suffixes)


@mark.parametrize("table", ["recording_formats", "impedance_formats", "surface_formats"])
def test_the_reference_shows_the_table_of_formats(table: str) -> None:
    assert f"\n<!-- table: {table} -->\n" in PAGE


def test_a_format_is_added_by_one_file_and_one_line_of_the_table(copied_package: Path, tmp_path: Path) -> None:
    recordings = copied_package / "measurement" / "recordings"
    (recordings / "toy.py").write_text(TOY_FORMAT)
    table = (recordings / "reader.py").read_text()
    line = '        "TDMS": "sonolube.measurement.recordings.tdms:Tdms",\n'
    assert line in table
    table = table.replace(line, line + '        "toy": "sonolube.measurement.recordings.toy:Toy",\n')
    (recordings / "reader.py").write_text(table)
    recording = tmp_path / "test.dat"
    recording.write_text("TOY\n400\n" + "\n".join(f"{1 + 0.25 * (-1) ** n}" for n in range(4000)))
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "OPENBLAS_NUM_THREADS": "1"}

    read = (
        "import sonolube\n"
        "from pathlib import Path\n"
        "from sonolube.measurement.recordings.reader import read_recording\n"
        f"recording = read_recording(Path({str(recording)!r}))\n"
        "print(sonolube.__file__, recording.attrs['file_format'], recording.attrs['sample_rate'], sep='\\n')"
    )
    answer = subprocess.run(
        [sys.executable, "-c", read], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    place, file_format, rate = answer.stdout.splitlines()
    assert Path(place).parent == copied_package
    assert file_format == "toy"
    assert float(rate) == approx(400.0)

    measure = f"from sonolube.cli import main; main(['measure', 'friction', {str(recording)!r}, '--json'])"
    answer = subprocess.run(
        [sys.executable, "-c", measure], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    (result,) = json.loads(answer.stdout)["results"]
    assert result["source"]["format"] == "toy"
    assert result["values"]["mean_force"]["value"] == approx(1.0)
