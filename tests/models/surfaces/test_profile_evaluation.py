"""Evaluation of profiles by ISO 21920-3 against closed forms of waves and the filter's transmission."""

import math

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import evaluate_profile
from sonolube.models.surfaces.profile_evaluation import SETTING_CLASSES

SPACING = 0.5e-6
ALPHA = math.sqrt(math.log(2) / math.pi)


def wave(amplitude: float, wavelength: float, *, length: float, spacing: float = SPACING) -> np.ndarray:
    x = spacing * np.arange(round(length / spacing))
    return np.asarray(amplitude * np.sin(2 * math.pi * x / wavelength + 0.3))


def low_pass(cutoff: float, wavelength: float) -> float:
    """Transmission of the Gaussian filter of ISO 16610-21."""
    return math.exp(-math.pi * (ALPHA * cutoff / wavelength) ** 2)


@mark.parametrize(
    ("amplitude", "name", "cutoff"), [(0.05e-6, "Sc1", 0.08e-3), (0.2e-6, "Sc2", 0.25e-3), (2e-6, "Sc3", 0.8e-3)]
)
def test_a_tilted_sine_has_the_parameters_of_a_sine_in_the_class_of_its_height(
    amplitude: float, name: str, cutoff: float
) -> None:
    z = wave(amplitude, 20e-6, length=8e-3)
    found = evaluate_profile(height=z + 1e-3 * SPACING * np.arange(z.size) + 1e-4, spacing=SPACING)
    passed = low_pass(2.5e-6, 20e-6) * (1 - low_pass(cutoff, 20e-6)) * amplitude
    parameters = found.parameters
    assert (found.setting_class, found.section_count, found.caveats) == (name, 5, ())
    assert parameters.arithmetic_mean_height == approx(2 * passed / math.pi, rel=2e-3)
    assert parameters.rms_height == approx(passed / math.sqrt(2), rel=2e-3)
    assert parameters.mean_section_height == approx(2 * passed, rel=5e-3)
    assert parameters.mean_section_peak_height == approx(passed, rel=5e-3)
    assert parameters.mean_section_pit_depth == approx(passed, rel=5e-3)
    assert parameters.skewness == approx(0, abs=2e-3)
    assert parameters.kurtosis == approx(1.5, rel=2e-3)
    assert parameters.mean_profile_element_spacing == approx(20e-6, rel=1e-4)


def test_a_triangle_has_a_quarter_and_a_root_of_a_third_of_its_height() -> None:
    x = SPACING * np.arange(12000)
    z = 4e-6 * np.abs((x / 40e-6) % 1 - 0.5) - 1e-6  # amplitude 1 um
    found = evaluate_profile(
        height=z, spacing=SPACING, short_cutoff_length=2.5e-6, long_cutoff_length=0.8e-3
    ).parameters
    assert found.arithmetic_mean_height == approx(0.5e-6, rel=0.01)
    assert found.rms_height == approx(1e-6 / math.sqrt(3), rel=0.01)
    assert found.kurtosis == approx(9 / 5, rel=0.01)
    assert found.mean_profile_element_spacing == approx(40e-6, rel=1e-4)


def test_a_wave_of_the_cutoff_keeps_half_its_height() -> None:
    z = wave(1e-6, 0.8e-3, length=8e-3)
    found = evaluate_profile(height=z, spacing=SPACING, degree=0, long_cutoff_length=0.8e-3)
    assert found.parameters.rms_height == approx(0.5e-6 / math.sqrt(2), rel=0.01)
    assert found.setting_class == ""


def test_waviness_and_noise_are_filtered_off() -> None:
    z = wave(1e-6, 50e-6, length=8e-3)
    disturbed = z + wave(4e-6, 8e-3, length=8e-3) + 5e-6 * (-1.0) ** np.arange(z.size)
    found = evaluate_profile(height=disturbed, spacing=SPACING)
    assert found.parameters.rms_height == approx(1e-6 / math.sqrt(2), rel=0.02)


def test_a_short_profile_is_evaluated_on_the_sections_it_has_or_without_an_l_filter() -> None:
    two = evaluate_profile(height=wave(1e-6, 10e-6, length=0.17e-3), spacing=SPACING)
    assert (two.setting_class, two.section_count) == ("Sc1", 2)
    assert any("2 of the standard's 5 sections of 80 um" in caveat for caveat in two.caveats)
    assert any("beyond Sc1, the highest setting class" in caveat for caveat in two.caveats)
    none = evaluate_profile(height=wave(1e-6, 10e-6, length=0.05e-3), spacing=SPACING)
    assert none.long_cutoff_length is None
    assert none.caveats[-1].startswith("no L-filter: the profile of 50 um")


def test_coarse_steps_leave_out_the_s_filter_with_a_caveat() -> None:
    found = evaluate_profile(height=wave(1e-6, 50e-6, length=8e-3, spacing=1e-6), spacing=1e-6)
    assert found.short_cutoff_length is None
    assert found.caveats == ("no S-filter: steps of 1 um are too coarse for its cutoff of 2.5 um",)


def test_the_five_sections_lie_in_the_middle() -> None:
    found = evaluate_profile(height=wave(1e-6, 50e-6, length=8e-3), spacing=SPACING)
    assert found.evaluated.size * SPACING == approx(4e-3)
    assert found.start * SPACING == approx(2e-3)


def test_the_setting_classes_are_those_of_the_standard() -> None:
    # ISO 21920-3:2021: section lengths of 0.08 to 8 mm, and Rz up to 0.16, 0.8, 16 and 80 um.
    assert [each.long_cutoff_length for each in SETTING_CLASSES] == approx([0.08e-3, 0.25e-3, 0.8e-3, 2.5e-3, 8e-3])
    assert [each.largest_height for each in SETTING_CLASSES[:-1]] == approx([0.16e-6, 0.8e-6, 16e-6, 80e-6])


@mark.parametrize(
    ("arguments", "said"),
    [
        ({"long_cutoff_length": 9e-3}, "long_cutoff_length must be from 5 points to the length of the profile"),
        ({"long_cutoff_length": 1e-6}, "long_cutoff_length must be from 5 points"),
        ({"long_cutoff_length": 1e-4, "short_cutoff_length": 2e-4}, "must be less than long_cutoff_length"),
    ],
)
def test_cutoffs_that_do_not_fit_are_refused(arguments: dict[str, float], said: str) -> None:
    with raises(InvalidInput, match=said):
        evaluate_profile(height=wave(1e-6, 50e-6, length=8e-3), spacing=SPACING, **arguments)  # type: ignore[arg-type]
