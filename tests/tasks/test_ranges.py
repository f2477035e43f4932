"""Values of keys of a rig: ranges, even ratios, lists and words as text, and numbers in SI."""

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.tasks.own_tables import ends_by_key, values_by_key


def test_a_range_has_both_ends_and_even_steps() -> None:
    values = values_by_key({"drive.frequency": "20kHz:24kHz:5"})["drive.frequency"]
    assert values == approx([20e3, 21e3, 22e3, 23e3, 24e3])


def test_a_logarithmic_range_has_even_ratios() -> None:
    values = values_by_key({"sliding.sliding_speed": "1mm/s:1m/s:4:log"})["sliding.sliding_speed"].astype(float)
    assert np.diff(np.log10(values)) == approx([1, 1, 1])


def test_a_list_of_quantities_is_in_si_and_a_list_of_names_is_text() -> None:
    values = values_by_key({"drive.frequency": "1kHz, 2kHz", "drive.waveform": "sine,square"})
    assert values["drive.frequency"] == approx([1e3, 2e3])
    assert values["drive.waveform"].tolist() == ["sine", "square"]


def test_numbers_are_in_si_already() -> None:
    assert values_by_key({"drive.frequency": [1e3, 2e3]}) == {"drive.frequency": [1e3, 2e3]}
    assert ends_by_key({"structure.tip_mass": (0.05, 0.15)}) == {"structure.tip_mass": (0.05, 0.15)}


def test_ends_are_read_alone() -> None:
    assert ends_by_key({"structure.tip_mass": "50g:150g"})["structure.tip_mass"] == approx((0.05, 0.15))
    for more in ("50g:150g:3", [0.05, 0.1, 0.15]):
        with raises(InvalidInput, match="points are drawn between two ends"):
            ends_by_key({"structure.tip_mass": more})
