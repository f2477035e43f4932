"""Distributions of a rig file: the laws of scipy, cut off at what a parameter can be, and words that are refused."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy import stats

from sonolube.errors import InvalidInput
from sonolube.rig import Distribution, LogNormal, Normal, Uniform, read_rig, rig_from
from sonolube.text.units import to_si

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = (RIGS / "tribometer.toml").read_text(encoding="utf-8")
SHARES = np.linspace(0.001, 0.999, 41)


def known(entry: str) -> Distribution:
    (law,) = rig_from(tomllib.loads(f"{TRIBOMETER}\n[uncertainty]\n{entry}")).uncertainty.values()
    return law


def test_a_normal_distribution_cut_off_is_scipys() -> None:
    law = Distribution(law=Normal(middle=1.0, deviation=0.8), lowest=0.0, highest=2.5)
    judge = stats.truncnorm(-1 / 0.8, 1.5 / 0.8, loc=1.0, scale=0.8)
    assert law.quantile(SHARES) == approx(judge.ppf(SHARES))
    assert law.truncated_fraction == approx(stats.norm.cdf(-1 / 0.8) + stats.norm.sf(1.5 / 0.8))


def test_a_lognormal_distribution_is_scipys() -> None:
    law = Distribution(law=LogNormal(median=3.0, factor=1.7), lowest=0.0)
    assert law.quantile(SHARES) == approx(stats.lognorm(np.log(1.7), scale=3.0).ppf(SHARES))
    assert law.truncated_fraction == 0


def test_a_uniform_distribution_cut_off_is_the_uniform_one_of_what_is_left() -> None:
    law = Distribution(law=Uniform(low=-1.0, high=3.0), lowest=0.0)
    assert law.quantile(SHARES) == approx(stats.uniform(0, 3).ppf(SHARES))
    assert law.truncated_fraction == approx(0.25)


@given(st.floats(0.01, 10), st.floats(0.01, 10), st.floats(0, 1), st.floats(0, 1))
def test_quantiles_rise_and_stay_within_the_possible(middle: float, deviation: float, one: float, other: float) -> None:
    law = Distribution(law=Normal(middle=middle, deviation=deviation), lowest=0.0, highest=100.0)
    low, high = law.quantile(sorted((one, other)))
    assert 0 <= low <= high <= 100


@pytest.mark.parametrize(
    ("text", "law"),
    [
        ("normal 0.2 N", Normal(middle=3.0, deviation=0.2)),
        ("normal 3 %", Normal(middle=3.0, deviation=0.09)),
        ("uniform 10 %", Uniform(low=2.7, high=3.3)),
        ("uniform 300 mN", Uniform(low=2.7, high=3.3)),
        ("uniform 2 N to 0.005 kN", Uniform(low=2.0, high=5.0)),
        ("lognormal 20 %", LogNormal(median=3.0, factor=1.2)),
        ("lognormal factor 2", LogNormal(median=3.0, factor=2.0)),
    ],
)
def test_words_become_the_law_that_an_engineer_reads(text: str, law: Normal) -> None:
    found = known(f'"contact.normal_load" = "{text}"')
    assert type(found.law) is type(law)
    assert found.quantile(SHARES) == approx(law.quantile(SHARES))


def test_a_change_of_the_rig_moves_the_distribution_about_it(tmp_path: Path) -> None:
    rig = read_rig(RIGS / "tribometer_uncertain.toml", changes=["contact.normal_load=5N"])
    assert rig.uncertainty["contact.normal_load"].quantile([0.5]) == approx([5.0])
    assert "5 N +- 100 mN" in rig.uncertainty["contact.normal_load"].text


def test_what_can_be_of_either_sign_is_not_cut_off() -> None:
    assert known('"drive.voltage_offset" = "normal 20 V"').truncated_fraction == 0
    assert known('"contact.normal_load" = "normal 2 N"').truncated_fraction == approx(stats.norm.cdf(-1.5))
    assert known('"contact.pair.poisson_ratio" = "normal 0.1"').highest == 0.5


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ('"contact.normal_lod" = "normal 3 %"', "did you mean contact.normal_load?"),
        ('"rms_height" = "normal 3 %"', "did you mean contact.roughness.rms_height?"),
        ('"friction.model" = "normal 3 %"', "no number of a rig file"),
        ('contact.normal_load = "normal 3 %"', 'put the whole key in quotes, such as "contact.normal_load"'),
        ('"contact.normal_load" = "gauss 3 %"', "is no distribution; write it like normal 0.5 um"),
        ('"contact.normal_load" = "normal 3 mm"', "is a length; expected a force"),
        ('"contact.normal_load" = "normal 3"', "has no unit"),
        ('"contact.normal_load" = "normal 0 %"', "is no width"),
        ('"contact.normal_load" = "uniform 5 N to 2 N"', "must lie below"),
        ('"contact.normal_load" = "uniform -5 N to 2 N"', "71% lies outside 0 to inf"),
        ('"contact.normal_load" = "lognormal 3 N"', "write 'lognormal 20 %'"),
        ('"contact.normal_load" = "lognormal factor 0.5"', "factor must be above 1"),
        ('"contact.normal_load" = "lognormal factor 1.2.3"', "write 'lognormal 20 %'"),
        ('"contact.normal_load" = "normal 1.2.3 %"', "expected a force"),
        ('"contact.normal_load" = "uniform 1e400 %"', "both finite"),
        ('"drive.ramp_duration" = "normal 5 %"', "about the file's zero"),
        ('"friction.memory_length" = "normal 5 %"', "the file has no value"),
    ],
)
def test_what_cannot_be_read_is_refused_by_its_key(entry: str, said: str) -> None:
    with raises(InvalidInput, match=r"^uncertainty") as refusal:
        known(entry)
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_value_that_the_file_lacks_can_still_be_given_ends() -> None:
    assert known('"friction.memory_length" = "uniform 1 um to 2 um"').quantile(0.5) == approx(
        to_si("1.5 um", unit="m", name="")
    )


def test_the_spread_of_an_entry_is_set_by_its_whole_key() -> None:
    rig = read_rig(RIGS / "tribometer.toml", changes=["uncertainty.contact.normal_load=normal 2 %"])
    assert rig.content()["uncertainty"] == {"contact.normal_load": "normal 2 %"}


@pytest.mark.parametrize(
    ("key", "entry", "lowest", "highest"),
    [
        ("contact.softer.poisson_ratio", "uniform 0.1 to 0.4", 0.0, 0.5),
        ("stack.coupling_factor", "uniform 0.1 to 0.4", 0.0, 1.0),
        ("contact.normal_load", "uniform 1 N to 2 N", 0.0, np.inf),
        ("sliding.sliding_speed", "uniform 1 mm/s to 2 mm/s", 0.0, np.inf),
        ("drive.voltage_offset", "uniform -1 V to 2 V", -np.inf, np.inf),
        ("stack.lowest_voltage", "uniform -1 V to 2 V", -np.inf, np.inf),
        ("stack.highest_voltage", "uniform -1 V to 2 V", -np.inf, np.inf),
    ],
)
def test_a_distribution_is_cut_off_where_its_quantity_ends(key: str, entry: str, lowest: float, highest: float) -> None:
    law = known(f'"{key}" = "{entry}"')
    assert (law.lowest, law.highest) == (lowest, highest)
