"""Uncertainty propagation: samples against single rigs, and outcomes whose distribution has a closed form."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from scipy import stats
from tests.same import same

from sonolube.charts import Band, Bars, Field, Line, Rule, chart_tables, draw_chart
from sonolube.design import (
    available_outcomes,
    band_chart,
    histogram_chart,
    outcome_statistics,
    propagate,
    sample_statistics,
    sobol_chart,
    sobol_indices,
)
from sonolube.design.uncertainty import identified_structure
from sonolube.errors import InvalidInput, UnknownName
from sonolube.rig import operating_points, read_rig, wear_point
from sonolube.validation.tribometer import tribometer_stack

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
UNCERTAIN = RIGS / "tribometer_uncertain.toml"
SPEED = "sliding.sliding_speed"


def rig_with(tmp_path: Path, table: str, base: str = "tribometer") -> Path:
    path = tmp_path / "rig.toml"
    text = re.sub(r"\[uncertainty\][^\[]*", "", (RIGS / f"{base}.toml").read_text(encoding="utf-8"))
    path.write_text(f"{text}\n[uncertainty]\n{table}\n")
    return path


def test_every_sample_is_the_rig_of_its_coordinates() -> None:
    found = propagate(UNCERTAIN, samples=32)
    for sample in (0, 17):
        row = found.isel(sample=sample)
        changes = [
            f"{row[name].attrs['key']}={float(row[name])!r} {row[name].attrs['units']}"
            for name in ("normal_load", "rms_height", "summit_radius", "tip_damping", "memory_length")
        ]
        changes += [f"contact.nominal_area={float(row['nominal_area'])!r} m2"]
        changes += [f"stack.free_stroke_per_volt={float(row['free_stroke_per_volt'])!r} m/V"]
        known = operating_points(read_rig(UNCERTAIN, changes=changes))
        assert float(row["friction_ratio"]) == approx(float(known.friction_ratio), abs=1e-4)
        assert float(row["vibration_amplitude"]) == approx(float(known.vibration_amplitude), rel=1e-4)


def test_an_outcome_proportional_to_a_normal_entry_is_normal(tmp_path: Path) -> None:
    # the power of D 1.9 is proportional to the capacitance, 360 nF 28 V 28 V 22 kHz = 6.209 W
    path = rig_with(tmp_path, '"stack.free_capacitance" = "normal 5 %"')
    found = outcome_statistics(propagate(path, outcome="charging_power", samples=256))
    exact = stats.norm(6.209, 0.05 * 6.209)
    assert found.mean.value == approx(exact.mean(), rel=1e-3)
    assert found.standard_deviation.value == approx(exact.std(), rel=0.02)
    assert found.quantiles[0.95].value == approx(exact.ppf(0.95), rel=0.005)


def test_the_sobol_indices_of_a_product_of_entries_have_their_closed_form(tmp_path: Path) -> None:
    # friction without vibration, mu F: relative variances a2 and b2 make a2 + b2 + a2 b2
    path = rig_with(
        tmp_path,
        '"contact.normal_load" = "normal 10 %"\n"friction.friction_coefficient" = "uniform 30 %"\n'
        '"contact.nominal_area" = "normal 5 %"',
        "cutter_head",
    )
    result = propagate(path, outcome="intrinsic_friction_force", samples=64, indices=True)
    found = sobol_indices(result["intrinsic_friction_force"].values)
    a2, b2 = 0.1**2, 0.3**2 / 3
    whole = a2 + b2 + a2 * b2
    assert found.first_order == approx(np.array([a2, b2, 0]) / whole, abs=0.06)
    assert found.total_order == approx(np.array([a2 * (1 + b2), b2 * (1 + a2), 0]) / whole, abs=0.06)
    mean = read_rig(path).friction_coefficient * read_rig(path).normal_load
    assert found.standard_deviation == approx(mean * np.sqrt(whole), rel=0.06)


def test_uncertainty_of_a_rig_without_structure_propagates_through_its_wear_model(tmp_path: Path) -> None:
    path = rig_with(tmp_path, '"contact.roughness.rms_height" = "normal 5 %"', "cutter_head")
    found = propagate(path, outcome="wear_rate_ratio", samples=32)
    height = float(found["rms_height"][5])
    known = wear_point(read_rig(path, changes=[f"contact.roughness.rms_height={height!r} m"]))
    assert float(found["wear_rate_ratio"][5]) == approx(known.wear_rate_ratio, rel=1e-9)
    assert "vibration_velocity" not in available_outcomes(read_rig(path))
    assert found["status"].values.tolist() == [0] * 32
    assert found["reason"].values.tolist() == [0] * 32
    assert found["reason_text"].values.tolist() == ["computed"]
    assert np.isfinite(found["wear_rate_ratio"].values).all()


@pytest.mark.parametrize(("factor", "own"), [(1.009, True), (1.011, False), (0.991, True), (0.989, False)])
def test_an_identified_structure_is_of_the_stack_of_the_facts_within_a_percent(
    monkeypatch: pytest.MonkeyPatch, factor: float, own: bool
) -> None:
    class Asked(Exception): ...

    def ask(**arguments: object) -> None:
        raise Asked

    monkeypatch.setattr("sonolube.design.uncertainty.tribometer_identification", ask)
    rig = replace(
        read_rig(RIGS / "tribometer.toml"),
        stack=replace(tribometer_stack(), stack_stiffness=factor * tribometer_stack().stack_stiffness),
    )
    with pytest.raises(Asked if own else InvalidInput, match=None if own else "needs the tribometer's stack"):
        identified_structure(rig, seed=0)
    with pytest.raises(InvalidInput, match="needs the tribometer's stack"):
        identified_structure(read_rig(RIGS / "cutter_head.toml"), seed=0)


def test_a_refused_sample_keeps_its_reason(tmp_path: Path) -> None:
    # the drive goes up to 28 V
    path = rig_with(tmp_path, '"stack.highest_voltage" = "uniform 27 V to 29 V"')
    found = propagate(path, samples=64)
    refused = found["highest_voltage"].values < 28
    assert np.array_equal(np.isnan(found["friction_ratio"].values), refused)
    reasons = found["reason_text"].values[found["reason"].values[refused]]
    assert all("the highest admissible voltage is" in str(reason) for reason in reasons)
    assert outcome_statistics(found).valid_samples == np.sum(~refused)


def test_every_sample_is_computed_at_every_swept_value() -> None:
    speeds = np.array([0.01, 0.05, 0.2])
    band = propagate(UNCERTAIN, samples=32, over={SPEED: speeds})
    assert band["friction_ratio"].dims == ("sample", "sliding_speed")
    alone = propagate(UNCERTAIN, samples=32, changes=[f"{SPEED}=50 mm/s"])
    assert band["friction_ratio"].values[:, 1] == approx(alone["friction_ratio"].values, abs=1e-4)
    assert np.all(np.diff(np.median(band["friction_ratio"].values, axis=0)) > 0)


def test_a_swept_key_is_not_uncertain(tmp_path: Path) -> None:
    path = rig_with(tmp_path, '"contact.normal_load" = "normal 5 %"\n"sliding.sliding_speed" = "normal 50 %"')
    found = propagate(path, samples=32, over={SPEED: [0.02, 0.04]})
    assert found.attrs["uncertain"] == ["contact.normal_load"]
    assert found["sliding_speed"].values.tolist() == [0.02, 0.04]


def test_joint_samples_keep_their_correlation() -> None:
    values = np.linspace(600.0, 800.0, 40)
    joint = {"structure.tip_damping": values, "structure.reaction_mass": values / 300}
    found = propagate(RIGS / "tribometer.toml", samples=64, joint_samples=joint)
    assert found["tip_damping"].values == approx(300 * found["reaction_mass"].values)
    assert np.unique(found["tip_damping"].values).size == 40
    assert (
        sample_statistics(
            found["vibration_amplitude"].values, subsequence=found["subsequence"].values
        ).standard_deviation.value
        > 0
    )


def test_a_second_run_resumes_from_the_same_folder(tmp_path: Path) -> None:
    once, again = (propagate(UNCERTAIN, samples=32, folder=tmp_path)["friction_ratio"].values for _ in range(2))
    same(once, again)
    assert len(list(tmp_path.glob("chunk-*.npz"))) == 1


def test_the_histogram_has_all_samples_and_each_quantile_with_its_interval() -> None:
    found = propagate(UNCERTAIN, samples=32, outcome="vibration_amplitude")
    (panel,) = histogram_chart(found).panels
    assert panel.x.text == "Vibration amplitude, zero to peak [µm]"
    (bars,) = (part for part in panel.parts if isinstance(part, Bars))
    micrometres = 1e6 * found["vibration_amplitude"].values
    assert bars.lengths.sum() == approx(100)
    assert bars.places[0] - bars.breadth / 2 == approx(micrometres.min())
    assert bars.places[-1] + bars.breadth / 2 == approx(micrometres.max())
    rules = [part.value for part in panel.parts if isinstance(part, Rule)]
    intervals = [part.x for part in panel.parts if isinstance(part, Band)]
    assert rules == sorted(rules)
    assert all(low <= value <= high for value, (low, high) in zip(rules, intervals, strict=True))


def test_the_band_over_a_key_has_its_quantiles_and_two_keys_have_maps() -> None:
    found = propagate(UNCERTAIN, samples=32, over={SPEED: np.geomspace(0.01, 0.2, 5)})
    (panel,) = band_chart(found).panels
    assert panel.x.text == "Sliding speed [mm/s]"
    assert panel.x.logarithmic
    (median,) = (part for part in panel.parts if isinstance(part, Line))
    assert median.y == approx(np.median(found["friction_ratio"].values, axis=0))
    over = {SPEED: [0.01, 0.05], "drive.voltage_peak_to_peak": [10.0, 20.0, 28.0]}
    found = propagate(UNCERTAIN, samples=32, over=over)
    maps = [part for panel in band_chart(found).panels for part in panel.parts if isinstance(part, Field)]
    samples = found["friction_ratio"].transpose("sample", "voltage_peak_to_peak", "sliding_speed").values
    assert maps[0].values == approx(np.median(samples, axis=0))
    assert maps[1].values.shape == (3, 2)


def test_the_bars_of_sobol_indices_name_their_entries(tmp_path: Path) -> None:
    path = rig_with(tmp_path, '"friction.friction_coefficient" = "normal 5 %"', "cutter_head")
    result = propagate(path, samples=32, outcome="friction_force", indices=True)
    chart = sobol_chart(result, sobol_indices(result["friction_force"].values))
    assert chart.panels[0].y.words == ("friction.friction_coefficient",)
    heads = [next(iter(row)) for table in chart_tables(chart) for row in table["rows"]]
    assert heads == ["friction.friction_coefficient"] * 2
    draw_chart(chart)


def test_unusable_requests_are_refused_with_the_reason() -> None:
    with raises(InvalidInput, match=r"table uncertainty is missing"):
        propagate(RIGS / "tribometer.toml")
    with raises(InvalidInput, match=r"leave out over and joint_samples"):
        propagate(UNCERTAIN, indices=True, over={SPEED: [0.02]})
    with raises(UnknownName, match=r"unknown outcome 'friction_rato'; did you mean friction_ratio\?"):
        propagate(UNCERTAIN, outcome="friction_rato")
    with raises(InvalidInput, match=r"contact.normal_lod: unknown key"):
        propagate(UNCERTAIN, over={"contact.normal_lod": [3.0]})


@pytest.mark.parametrize("keys", [0, 3])
def test_an_uncertainty_band_needs_one_or_two_swept_keys(keys: int) -> None:
    over = {SPEED: [0.02], "drive.frequency": [22e3], "drive.voltage_peak_to_peak": [20.0]}
    found = propagate(UNCERTAIN, samples=32, over=dict(list(over.items())[:keys]))
    with raises(InvalidInput, match=rf"one or two swept keys, got {keys}"):
        band_chart(found)
