"""Damaged surface files are read or refused with one line that names the file."""

import gc
import random
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from hypothesis import given, strategies as st
from pytest import mark
from reliability.damage import mutated
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import read_height_map

CORPUS = Path(__file__).parent / "corpus"
SUFFIXES = (".opd", ".xyz", ".npy")


def seeds(suffix: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted(CORPUS.glob(f"*{suffix}"))]


def outcome(content: bytes, path: Path) -> str:
    """Read the content as a file; anything but a map or a refusal that names the file is a failure."""
    path.write_bytes(content)
    steps = {} if path.suffix == ".xyz" else {"spacing_x": 1e-6, "spacing_y": 1e-6}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for given_steps in (steps, {}):
            try:
                found = read_height_map(path, length_unit="um" if path.suffix == ".xyz" else None, **given_steps)
            except InvalidInput as refused:
                refusal = str(refused)
            else:
                assert found.height.size <= 20 * len(content)
                return "read"
            assert refusal.startswith(f"{path}: ")
            assert "\n" not in refusal
    return "refused"


def fuzz(suffix: str, inputs: int, folder: Path, seed: int = 0) -> Counter[str]:
    rng = random.Random(seed)
    corpus = seeds(suffix)
    counts: Counter[str] = Counter()
    for _ in range(inputs):
        counts[outcome(mutated(rng.choice(corpus), rng, others=corpus), folder / f"input{suffix}")] += 1
    return counts


@mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_surface_file_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    counts = fuzz(suffix, 800, tmp_path)
    assert counts["read"] > 0
    assert counts["refused"] > 0


@mark.parametrize("suffix", SUFFIXES)
def test_every_small_file_of_the_corpus_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    outcomes = {outcome(content, tmp_path / f"input{suffix}") for content in seeds(suffix)}
    assert "read" in outcomes


@examples(200)
@given(content=st.binary(max_size=300), suffix=st.sampled_from(SUFFIXES))
def test_any_bytes_are_read_or_refused_as_a_surface(content: bytes, suffix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        outcome(content, Path(folder) / f"input{suffix}")


@examples(200)
@given(text=st.text(alphabet="0123456789.-+e nai,;#\n\t", max_size=200))
def test_any_text_is_read_or_refused(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        outcome(text.encode(), Path(folder) / "input.xyz")


def test_an_archive_under_the_name_of_a_matrix_is_refused_and_closed(tmp_path: Path) -> None:
    path = tmp_path / "input.npy"
    for content in (b"PK\x03\x04 is the beginning of an archive", b"PK\x05\x06" + bytes(18)):
        assert outcome(content, path) == "refused"
    np.savez(tmp_path / "input.npz", heights=np.eye(3))
    assert outcome((tmp_path / "input.npz").read_bytes(), path) == "refused"
    gc.collect()  # what was left open would be told now
