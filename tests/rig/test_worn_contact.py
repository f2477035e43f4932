"""Decay length of worn contacts: the caveat against one by roughness, with friction by closed forms."""

import re
import tomllib
from dataclasses import replace
from math import exp, log
from pathlib import Path

import pytest
from pytest import approx, raises
from scipy.special import i0
from scipy.stats import norm

from sonolube.errors import InvalidInput
from sonolube.models.contact import GaussianHeights
from sonolube.rig import (
    PUBLISHED_DECAY_LENGTH,
    DecayLengthPopulation,
    Rig,
    contact_point,
    decay_length_caveat,
    friction_point,
    operating_caveats,
    read_rig,
    rig_from,
    simulate,
    wear_point,
)

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
AMPLITUDE = 0.4e-6
FILE = """
title = "a"
source = "b"
[contact]
normal_load = "6 N"
nominal_area = "7 mm2"
[contact.roughness]
rms_height = "0.6 um"
summit_radius = "10 um"
summit_density = "5e9 /m2"
[contact.pair]
effective_modulus = "80 GPa"
poisson_ratio = 0.3
yield_strength = "0.5 GPa"
[friction]
friction_coefficient = 0.4
[sliding]
sliding_speed = "1 nm/s"
[drive]
frequency = "20 kHz"
[vibration]
vibration_amplitude = "0.4 um"
"""


def smooth_rig(rms_height: str = "0.6 um", *, model: str = "asperity_stick_slip") -> Rig:
    """Rig of a stated amplitude whose roughness was measured before wear; it slides very slowly."""
    rig = rig_from(tomllib.loads(FILE.replace("0.6 um", rms_height)))
    return rig.replace("friction.model", model)


def numbers(caveat: str | None) -> list[float]:
    assert caveat is not None
    return [float(each) for each in re.findall(r"(?<![/\d])\d+\.\d+", caveat)]


def slow_ratio(length: float) -> float:
    """Friction ratio of slow sliding, the least normal force of a load-balanced sine over the load."""
    beta = AMPLITUDE / length
    return float(exp(-beta) / i0(beta))


def test_the_caveat_has_both_lengths_and_both_friction_ratios() -> None:
    median = PUBLISHED_DECAY_LENGTH.median
    caveat = decay_length_caveat(smooth_rig())
    own, low, high, first, second = numbers(caveat)
    assert own == approx(0.2)  # 0.6 um over 3
    width = norm.ppf(0.975) * PUBLISHED_DECAY_LENGTH.log_spread
    assert (log(low * 1e-6 / median), log(high * 1e-6 / median)) == approx((-width, width), abs=0.05)
    assert (first, second) == approx((slow_ratio(0.2e-6), slow_ratio(median)), abs=0.006)
    assert "give contact.decay_length or contact.normal_stiffness" in str(caveat)


@pytest.mark.parametrize("rms_height", [0.1, 1.4, 1.6, 6.0, 15.0, 16.5, 40.0])
def test_the_caveat_is_of_rigs_outside_the_central_range_of_the_population(rms_height: float) -> None:
    width = norm.ppf(0.975) * PUBLISHED_DECAY_LENGTH.log_spread
    outside = abs(log(rms_height * 1e-6 / 3 / PUBLISHED_DECAY_LENGTH.median)) > width
    assert (decay_length_caveat(smooth_rig(f"{rms_height} um")) is not None) == outside


def test_a_rig_that_states_its_decay_length_gets_no_caveat() -> None:
    rig = smooth_rig()
    assert decay_length_caveat(replace(rig, contact=replace(rig.contact, decay_length=0.2e-6))) is None


def test_heights_whose_decay_length_varies_get_no_caveat() -> None:
    rig = smooth_rig()
    assert decay_length_caveat(replace(rig, contact=replace(rig.contact, heights=GaussianHeights()))) is None


@pytest.mark.parametrize("path", sorted(RIGS.glob("*.toml")), ids=lambda path: path.stem)
def test_rigs_of_the_dissertation_get_no_caveat(path: Path) -> None:
    assert decay_length_caveat(read_rig(path)) is None


def test_contact_friction_wear_simulation_and_sweeps_carry_the_same_caveat() -> None:
    rig = smooth_rig()
    caveat = decay_length_caveat(rig)
    results = (contact_point(rig), friction_point(rig), wear_point(rig), simulate(rig))
    assert all(caveat in result.caveats for result in results)
    assert caveat in operating_caveats(rig)


def test_a_model_without_a_ratio_at_the_amplitude_is_said_in_place_of_its_number() -> None:
    # of a sine about the gap at rest, which 3 um exceed on the smooth surfaces, and 90 um on worn ones too
    rig = smooth_rig("0.3 um", model="dong_2015_full_period")
    caveat = str(decay_length_caveat(rig, vibration_amplitude=3e-6))
    assert "friction ratio none by the model with the first, 0." in caveat
    assert "friction ratio" not in str(decay_length_caveat(rig, vibration_amplitude=90e-6))


def test_the_population_has_the_quantiles_of_a_lognormal_distribution() -> None:
    population = DecayLengthPopulation(median=2e-6, log_spread=0.5)
    assert population.central_range(share=0.6827) == approx((2e-6 * exp(-0.5), 2e-6 * exp(0.5)), rel=1e-4)
    assert population.factor == approx(exp(0.5))
    with raises(InvalidInput, match="log_spread must be positive"):
        DecayLengthPopulation(median=2e-6, log_spread=0.0)
