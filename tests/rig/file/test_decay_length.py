"""Decay length of a rig file: by itself, by the normal stiffness under its load, with origin and distribution."""

import tomllib
from math import e, exp
from pathlib import Path

import pytest
from pytest import approx, raises
from scipy.special import i0

from sonolube.design import grid_plan, propagate
from sonolube.errors import InvalidInput
from sonolube.models.contact import decay_length
from sonolube.rig import Rig, contact_point, friction_point, read_rig, rig_from

FILE = """
title = "a"
source = "b"
[contact]
normal_load = "6 N"
nominal_area = "7 mm2"
LENGTH
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
vibration_amplitude = "1.2 um"
[uncertainty]
UNCERTAIN
"""
STIFF = 'normal_stiffness = "3 MN/m"'  # 6 N over 3 MN/m: 2 um
WORN = 'decay_length = "2 um"\ndecay_length_origin = "worn_scan"'


def rig(length: str, uncertain: str = "") -> Rig:
    return rig_from(tomllib.loads(FILE.replace("LENGTH", length).replace("UNCERTAIN", uncertain)))


def file_of(folder: Path, length: str, uncertain: str = "") -> Path:
    path = folder / "rig.toml"
    path.write_text(FILE.replace("LENGTH", length).replace("UNCERTAIN", uncertain))
    return path


def test_a_stiffness_gives_the_length_of_load_over_stiffness() -> None:
    known = rig(STIFF)
    assert known.contact.decay_length == approx(2e-6)
    assert known.decay_length_origin == "normal_stiffness"
    assert contact_point(known).normal_stiffness == approx(3e6)


def test_another_load_keeps_the_length_and_changes_the_stiffness_in_proportion(tmp_path: Path) -> None:
    path = file_of(tmp_path, STIFF)
    for change in (["contact.normal_load=12N"], ["contact.normal_load=12N", "contact.normal_stiffness=3MN/m"]):
        known = read_rig(path, changes=change)
        assert known.contact.decay_length == approx(2e-6)
        assert contact_point(known).normal_stiffness == approx(6e6)
    assert rig(STIFF).replace("contact.normal_load", "12 N").contact.decay_length == approx(2e-6)
    plan = grid_plan(path, over={"contact.normal_load": [3.0, 12.0]})
    assert [plan.rig({"contact.normal_load": load}).contact.decay_length for load in (3.0, 12.0)] == approx([2e-6] * 2)


def test_a_stiffness_measured_at_another_load_belongs_to_that_load() -> None:
    assert rig(f'{STIFF}\nstiffness_load = "9 N"').contact.decay_length == approx(3e-6)


def test_an_amplitude_of_one_length_lowers_slow_friction_by_the_bessel_function() -> None:
    # of a load-balanced sine the least normal force is F_N exp(-a/l)/I0(a/l)
    found = friction_point(rig('decay_length = "1.2 um"')).friction_ratio
    assert found == approx(exp(-1) / i0(1), rel=1e-3)


def test_without_a_length_the_roughness_gives_it() -> None:
    known = rig("")
    assert (known.contact.decay_length, known.decay_length_origin) == (None, None)
    assert float(decay_length(known.contact)) == approx(0.2e-6)
    assert dict(known.table())["decay length"] == "200 nm by roughness, Rq/3"


def test_the_table_of_a_rig_has_the_length_with_its_origin() -> None:
    known = rig(WORN)
    assert known.contact.roughness.rms_height == approx(0.6e-6)
    assert dict(known.table())["decay length"] == "2 um from a scan of the worn track"
    assert dict(rig('decay_length = "2 um"').table())["decay length"] == "2 um as stated"


def test_a_rig_with_a_stiffness_is_written_and_read_again(tmp_path: Path) -> None:
    again = read_rig(rig(STIFF).to_toml(tmp_path / "again.toml"), changes=["contact.normal_load=1N"])
    assert again.contact.decay_length == approx(2e-6)


def test_a_typed_length_takes_the_place_of_a_stiffness_and_the_reverse(tmp_path: Path) -> None:
    typed = read_rig(file_of(tmp_path, STIFF), changes=["contact.decay_length=0.7um"])
    assert typed.contact.decay_length == approx(0.7e-6)
    assert typed.decay_length_origin == "stated"
    path = file_of(tmp_path, WORN, '"contact.decay_length" = "lognormal factor 2"')
    typed = read_rig(path, changes=["contact.normal_load=12N", "contact.normal_stiffness=1.5MN/m"])
    assert typed.contact.decay_length == approx(4e-6)  # at 6 N
    assert typed.decay_length_origin == "normal_stiffness"
    assert typed.uncertainty == {}


@pytest.mark.parametrize(
    ("length", "refusal"),
    [
        (f"{STIFF}\n{WORN}", "contact: give either decay_length or normal_stiffness, got both"),
        ('decay_length = "-2 um"', r"contact: decay_length must be positive"),
        ('normal_stiffness = "0 N/m"', "contact: normal_stiffness must be positive"),
        (
            'normal_stiffness = "1 N/m"',
            "load over normal_stiffness 6 m lies beyond any contact: expected 100 pm to 1 mm",
        ),
        ('decay_length_origin = "own_runs"', "says how decay_length is known, which is missing"),
        (f'{STIFF}\ndecay_length_origin = "own_runs"', "decay_length_origin follows from normal_stiffness"),
        ('decay_length = "2 um"\ndecay_length_origin = "guess"', "contact.decay_length_origin"),
        ('stiffness_load = "2 N"', "stiffness_load is the load of a measured normal_stiffness, which is missing"),
        ('decay_length = "2 um"\nheight_distribution = "gaussian"', "decay_length is for exponential heights"),
        ('normal_stiffness = "2 um"', "normal_stiffness"),
    ],
)
def test_what_no_contact_has_is_refused_in_one_line(length: str, refusal: str) -> None:
    with raises(InvalidInput, match=refusal) as refused:
        rig(length)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("length", "key", "factor"), [(WORN, "contact.decay_length", e), (STIFF, "contact.normal_stiffness", 1.3)]
)
def test_the_distribution_of_either_key_reaches_friction(tmp_path: Path, length: str, key: str, factor: float) -> None:
    # the ratio of slow sliding rises with the length, so that its quantiles are those of the length
    path = file_of(tmp_path, length, f'"{key}" = "lognormal factor {factor}"')
    found = propagate(path, samples=256)
    quantiles = [float(found["friction_ratio"].quantile(level)) for level in (0.1587, 0.5, 0.8413)]
    betas = [1.2 / (2 * factor**power) for power in (-1, 0, 1)]
    assert quantiles == approx([exp(-beta) / float(i0(beta)) for beta in betas], abs=0.01)


def test_the_stiffness_itself_has_the_distribution_of_its_entry(tmp_path: Path) -> None:
    uncertain = '"contact.normal_stiffness" = "lognormal factor 1.3"\n"contact.normal_load" = "normal 1 %"'
    path = file_of(tmp_path, STIFF, uncertain)
    found = propagate(path, outcome="normal_stiffness", samples=64)
    # k = F/l, and l is 6 N over the sampled stiffness
    expected = found["contact_normal_stiffness"] * found["normal_load"] / 6.0
    assert found["normal_stiffness"].values == approx(expected.values, rel=1e-9)


def test_lengths_and_stiffnesses_are_swept(tmp_path: Path) -> None:
    path = file_of(tmp_path, STIFF)
    for key, values, lengths in (
        ("contact.decay_length", [1e-6, 3e-6], [1e-6, 3e-6]),
        ("contact.normal_stiffness", [1e6, 12e6], [6e-6, 0.5e-6]),
    ):
        plan = grid_plan(path, over={key: values})
        assert [plan.rig({key: value}).contact.decay_length for value in values] == approx(lengths)
