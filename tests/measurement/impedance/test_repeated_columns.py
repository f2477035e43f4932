"""Two columns of one quantity are refused; none of them is taken silently."""

from pathlib import Path

from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.resonance_spectrum import read_resonance_spectrum
from sonolube.measurement.impedance.spectrum import read_impedance
from sonolube.rig.file.modes_file import read_modes


def written(folder: Path, text: str, name: str = "test.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@mark.parametrize("heading", ["f (Hz),R (ohm),X (ohm),R (ohm)", "f (Hz),R (ohm),X (ohm),Re(Z) (kohm)"])
def test_a_table_with_two_resistances_that_differ_is_refused(tmp_path: Path, heading: str) -> None:
    path = written(tmp_path, f"{heading}\n1000,5,-3,7\n2000,5,-3,7\n")
    with raises(InvalidInput, match=r"line 1: columns 2 and 4 are all of R and differ; keep one of them"):
        read_impedance(path)


def test_a_frequency_that_is_repeated_for_every_trace_is_read(tmp_path: Path) -> None:
    path = written(tmp_path, "f (Hz),R (ohm),f (kHz),X (ohm)\n1000,5,1,-3\n2000,5,2,-4\n")
    assert read_impedance(path).impedance == approx([5 - 3j, 5 - 4j])


def test_a_chunk_of_an_mfia_with_a_field_twice_is_refused(tmp_path: Path) -> None:
    lines = ["chunk;timestamp;size;fieldname", "0;1;2;frequency;1000;2000", "0;1;2;realz;5;5", "0;1;2;imagz;-3;-3"]
    with raises(InvalidInput, match="line 5: chunk '0' has realz a second time, after line 3"):
        read_impedance(written(tmp_path, "\n".join([*lines, "0;1;2;realz;7;7"]) + "\n"))


@mark.parametrize(
    ("heading", "named"),
    [
        ("frequency (Hz),velocity (mm/s),velocity (mm/s)", "columns 2 and 3 are of velocity"),
        ("frequency (Hz),velocity (mm/s),frequency (kHz)", "columns 1 and 3 are of frequency"),
    ],
)
def test_a_table_of_vibration_with_two_columns_of_one_quantity_is_refused(
    tmp_path: Path, heading: str, named: str
) -> None:
    rows = "".join(f"{at},1,2\n" for at in range(1, 30))
    with raises(InvalidInput, match=f"line 1: {named}; keep one"):
        read_resonance_spectrum(written(tmp_path, f"{heading}\n{rows}"))


def test_a_file_of_modes_with_a_column_twice_is_refused_by_its_name(tmp_path: Path) -> None:
    names = "natural_frequency [kHz],damping_ratio,damping_ratio,drive_participation [N/V],contact_participation"
    with raises(InvalidInput, match="two columns are named damping_ratio; keep one of them"):
        read_modes(written(tmp_path, f"{names}\n20,0.01,0.02,1,1\n"))
