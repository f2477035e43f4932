"""Extremes of ranges of a signal, against those of its samples."""

from itertools import pairwise

import numpy as np
from hypothesis import given, strategies as st
from numpy.testing import assert_array_equal
from pytest import raises
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.pyramid import block_sizes, extremes, extremes_of_range


@st.composite
def ranges(draw: st.DrawFn) -> tuple[np.ndarray, int, int, int]:
    """A signal with spikes and gaps, a range of it, and a number of parts."""
    size = draw(st.integers(1, 9000))
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    values = rng.standard_normal(size)
    values[rng.random(size) < draw(st.sampled_from([0.0, 0.01, 0.9, 1.0]))] = np.nan
    values[rng.integers(0, size, 3)] = rng.choice([1e9, -1e9, np.nan], 3)
    first = draw(st.integers(0, size - 1))
    return values, first, draw(st.integers(first + 1, size)), draw(st.integers(3, 400))


@examples(300)
@given(ranges())
def test_no_extreme_of_a_range_is_lost_and_each_part_has_those_of_its_samples(
    drawn: tuple[np.ndarray, int, int, int],
) -> None:
    values, first, last, bins = drawn
    edges, (low, high) = extremes_of_range(values, extremes(values), first=first, last=last, bins=bins)
    assert (edges[0], edges[-1]) == (first, last)
    assert np.all(np.diff(edges) > 0)
    assert len(edges) - 1 <= bins
    parts = [values[a:b] for a, b in pairwise(edges)]
    assert_array_equal(low, [np.fmin.reduce(part) for part in parts])
    assert_array_equal(high, [np.fmax.reduce(part) for part in parts])
    assert_array_equal(np.fmin.reduce(low), np.fmin.reduce(values[first:last]))
    assert_array_equal(np.fmax.reduce(high), np.fmax.reduce(values[first:last]))


def test_a_range_of_a_long_signal_is_answered_from_few_numbers() -> None:
    values = np.zeros(2_000_000)
    values[1_234_567] = 7.0
    blocks = extremes(values)
    assert blocks.shape[1] < values.size / 10
    assert block_sizes(values.size)[:3] == [16, 64, 256]
    edges, (_, high) = extremes_of_range(values, blocks, first=0, last=values.size, bins=2000)
    at = int(np.argmax(high))
    assert high[at] == 7.0
    assert edges[at] <= 1_234_567 < edges[at + 1]


def test_a_range_beyond_the_signal_is_refused() -> None:
    values = np.arange(10.0)
    for first, last in ((5, 5), (-1, 3), (3, 11)):
        with raises(InvalidInput, match="none of 10"):
            extremes_of_range(values, extremes(values), first=first, last=last, bins=5)
    with raises(InvalidInput, match="at least 3"):
        extremes_of_range(values, extremes(values), first=0, last=5, bins=2)
