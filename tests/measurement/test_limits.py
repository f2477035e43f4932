"""Files that state more than they hold are refused in one line before anything is allocated; what is stored is read."""

import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import MAX_CHANNELS, MAX_VALUES, ClippedReader, require_values
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.surface_files.reader import read_height_map


def hdf5(path: Path, fill: Callable[[Any], object], *, userblock: int = 0) -> Path:
    with h5py.File(path, "w", userblock_size=userblock) as file:
        file.attrs["sample_rate"] = 1000.0
        fill(file)
    return path


def twice_deflated(file: Any) -> None:
    settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    settings.set_chunk((1000,))
    settings.set_deflate(9)
    settings.set_deflate(9)
    h5py.h5d.create(file.id, b"x", h5py.h5t.NATIVE_DOUBLE, h5py.h5s.create_simple((1000,)), settings)


def chunk_bomb(file: Any) -> None:
    dataset = file.create_dataset("x", (1000,), "f8", chunks=(1000,), compression=1)
    dataset.id.write_direct_chunk((0,), zlib.compress(bytes(10**8), 1))


def virtual(file: Any) -> None:
    layout = h5py.VirtualLayout((10,), "f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", (10,))
    file.create_virtual_dataset("x", layout)


def deep(file: Any) -> None:
    for _ in range(100):
        file = file.create_group("g")


HOSTILE: dict[str, tuple[Callable[[Any], object], str]] = {
    "shape": (lambda f: f.create_dataset("x", (2 * 10**9,), "f8"), "dataset 'x': states 2000000000 values"),
    "chunks": (lambda f: f.create_dataset("x", (10**7,), "f8", chunks=(1,)), "states 10000000 chunks"),
    "one chunk": (lambda f: f.create_dataset("x", (9,), "f8", chunks=(10**8,), maxshape=(None,)), "one chunk: states"),
    "zeros": (lambda f: f.create_dataset("x", data=np.zeros(MAX_VALUES + 1, "i1"), compression=1), "states 20000001"),
    "deflated twice": (twice_deflated, "compressed twice over"),
    "chunk bomb": (chunk_bomb, "the chunk from value 0 unpacks to more than it states"),
    "virtual": (virtual, "'x' is virtual"),
    "external storage": (
        lambda f: f.create_dataset("x", (10,), "i1", external=[("/etc/passwd", 0, 10)]),
        "'x' has its values in another file",
    ),
    "external link": (lambda f: f.__setitem__("x", h5py.ExternalLink("/etc/passwd", "y")), "'x' is a link to another"),
    "depth": (deep, "groups more than 64 deep"),
}


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_an_hdf5_file_that_is_not_what_it_states_is_refused(name: str, suffix: str, tmp_path: Path) -> None:
    fill, reason = HOSTILE[name]
    path = hdf5(tmp_path / f"a{suffix}", fill, userblock=512 if suffix == ".mat" else 0)
    if suffix == ".mat":
        with path.open("r+b") as stream:
            stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
    with pytest.raises(InvalidInput, match=reason) as refused:
        read_recording(path)
    assert str(refused.value).startswith(f"{path}: ")
    assert "\n" not in str(refused.value)


def test_three_thousand_channels_are_read(tmp_path: Path) -> None:
    path = hdf5(tmp_path / "many.h5", lambda f: [f.create_dataset(f"c{at}", data=[1.0, 2.0]) for at in range(3000)])
    assert len(read_recording(path)) == 3000


def test_compressed_values_cyclic_and_soft_links_are_read_once(tmp_path: Path) -> None:
    def fill(file: Any) -> None:
        file.create_dataset("group/x", data=np.arange(1000.0), compression=9, shuffle=True, fletcher32=True)
        file["group/up"] = file["/"]
        file["again"] = h5py.SoftLink("/group/x")

    found = read_recording(hdf5(tmp_path / "a.h5", fill))
    assert list(found) == ["group_x"]
    assert found["group_x"].to_numpy() == pytest.approx(np.arange(1000.0))


@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_a_time_of_another_length_than_its_channel_is_refused(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    arrays = {"time": np.arange(5.0), "force": np.arange(4.0)}
    if suffix == ".mat":
        savemat(path, arrays)
    else:
        hdf5(path, lambda f: [f.create_dataset(name, data=values) for name, values in arrays.items()])
    with pytest.raises(InvalidInput, match=r"different numbers of samples \(time 5, force 4\)"):
        read_recording(path)


@pytest.mark.parametrize("form", ["4", "5", "5 compressed"])
def test_vectors_that_scipy_wrote_are_read_to_the_last_bit(form: str, tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    values = np.random.default_rng(0).standard_normal(100)
    arrays: dict[str, Any] = {"time": np.arange(100.0), "force": values, "matrix": np.eye(3), "z": 1j * values}
    if form != "4":
        arrays |= {"s": {"speed": values.astype("f4"), "text": "no"}, "cell": np.array([{"a": 1}], dtype=object)}
    savemat(path, arrays, format=form[0], do_compression="compressed" in form)
    found = read_recording(path)
    assert np.array_equal(found["force"], values)
    assert set(found) == ({"force"} if form == "4" else {"force", "s_speed"})


def matlab(path: Path, *, size: int, held: int) -> Path:
    head = struct.pack("<4I2I2i2I", 6, 8, 6, 0, 5, 8, 1, size, 1, 1) + b"x".ljust(8, b"\0")
    content = head + struct.pack("<2I", 9, 8 * size & 0xFFFFFFFF) + bytes(8 * held)
    packed = zlib.compress(struct.pack("<2I", 14, len(content)) + content, 1)
    path.write_bytes(b"MATLAB 5.0".ljust(124) + b"\0\1IM" + struct.pack("<2I", 15, len(packed)) + packed)
    return path


def test_a_matlab_variable_that_states_or_unpacks_to_too_much_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="'x' states 1000000000 values and holds 10"):
        read_recording(matlab(tmp_path / "states.mat", size=10**9, held=10))
    with pytest.raises(InvalidInput, match="variable 'x': unpacks to 160000001 bytes or more"):
        read_recording(matlab(tmp_path / "bomb.mat", size=MAX_VALUES + 9, held=MAX_VALUES + 9))


def test_values_that_are_stored_without_compression_are_within_the_limit(tmp_path: Path) -> None:
    path = tmp_path / "large"
    with path.open("wb") as stream:
        stream.truncate(10**10)  # sparse
    require_values(10**10, path)
    with pytest.raises(InvalidInput, match="save it in parts or without compression"):
        require_values(2 * 10**10 + 1, path)


def test_a_clipped_reader_allocates_no_more_than_the_file(tmp_path: Path) -> None:
    path = tmp_path / "short"
    path.write_bytes(b"abc")
    with ClippedReader(path) as stream:
        assert stream.read(1 << 62) == b"abc"
        assert stream.read() == b""


def test_an_archive_of_zeros_and_one_of_elements_are_refused(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    for name, content, reason in (
        ("bindata/data.bin", bytes(170_000_000), "unpacks to 17"),
        ("main.xml", b"<b/>" * 1_100_000, "is an XML document of 4400000 bytes"),
    ):
        path = tmp_path / "a.x3p"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            archive.writestr(name, content)
        with pytest.raises(InvalidInput, match=reason):
            read_height_map(path)


@pytest.mark.parametrize("content", [b"\n" * 300_000, b"# a = b\n" * 100_000, b"1\n" * 1_100_000, b"x" * 10**6])
def test_text_without_end_is_no_surface(content: bytes, tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "a.asc"
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match="as text no table of heights"):
        read_height_map(path)


def test_bytes_of_a_square_number_are_no_height_map_unless_their_suffix_says_so(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "a.dat"
    path.write_bytes(np.random.default_rng(0).bytes(2 * 200 * 200))  # HGT has no signature
    with pytest.raises(InvalidInput, match="of no format of SurfaceTopography"):
        read_height_map(path)


def test_more_columns_than_channels_may_be_are_refused(tmp_path: Path) -> None:
    from sonolube.measurement.impedance.spectrum import read_impedance

    path = tmp_path / "wide.csv"
    path.write_text("f," * (MAX_CHANNELS + 1) + "\n1")
    with pytest.raises(InvalidInput, match="has 10002 columns or more"):
        read_impedance(path)
