"""A live prediction of the reference rig: its curves, what would be left of its intervals, its heat and its runs."""

from dataclasses import replace
from math import log
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, mark

from sonolube.prediction import LivePrediction, interval
from sonolube.prediction.applicability import contact_heating, spot_heating
from sonolube.prediction.live_prediction import predict
from sonolube.prediction.posterior import RigDraws, learned
from sonolube.prediction.wear import vibration_weight
from sonolube.rig import Distribution, LogNormal, Rig, read_rig
from sonolube.rig.datasets import LabelledArrays

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=list(changes))


@pytest.fixture(scope="module")
def found() -> LabelledArrays:
    return LivePrediction(tribometer(), pin="stainless_steel_316", disc="aluminium_2024", draws=4000).first


def array(found: LabelledArrays, name: str) -> np.ndarray:
    return np.asarray(found[name].to_numpy())


def test_curves_have_33_points_from_a_sixth_to_six_times_the_operating_point(found: LabelledArrays) -> None:
    for name, middle in (("amplitude", 2.5e-6), ("speed", 20.3e-3)):
        points = np.asarray(found.coordinates[f"curve_{name}"].to_numpy())
        assert points.size == 33
        assert (points[0], points[16], points[-1]) == approx((middle / 6, middle, 6 * middle))
        assert np.diff(np.log(points)) == approx(np.full(32, 2 * log(6) / 32))
    # more amplitude, less friction; faster, more: of the medians
    assert np.all(np.diff(array(found, "friction_ratio_over_amplitude")[3]) < 0.02)
    assert np.all(np.diff(array(found, "friction_ratio_over_speed")[3]) > -0.02)
    assert np.all(np.diff(array(found, "friction_ratio_over_speed"), axis=0) >= 0)


def test_heat_is_that_of_the_force_at_the_sliding_speed(found: LabelledArrays) -> None:
    per_watt = contact_heating(tribometer(), "stainless_steel_316", "aluminium_2024")
    assert isinstance(per_watt, float)
    watts = array(found, "friction_force") * 20.3e-3
    assert array(found, "mean_temperature_rise") == approx(per_watt * watts)
    on_spot = spot_heating(tribometer(), "stainless_steel_316", "aluminium_2024")
    assert isinstance(on_spot, float)
    assert array(found, "spot_temperature_rise") == approx(on_spot * watts)
    unnamed = LivePrediction(tribometer(), draws=100).first
    assert unnamed.attrs["heat"] == "Heat is not computed: name the materials of pin and disc"
    assert "spot_temperature_rise" not in unnamed.variables
    assert "mean_temperature_rise" not in unnamed.variables


def test_the_coefficient_scatters_by_its_own_error_beside_that_of_the_ratio(found: LabelledArrays) -> None:
    ratio = array(found, "friction_ratio")
    intrinsic = array(found, "friction_coefficient")[ratio > 0] / ratio[ratio > 0]
    assert np.median(intrinsic) == approx(0.341, rel=0.01)
    assert np.std(np.log(intrinsic)) == approx(0.1, rel=0.05)
    assert array(found, "friction_force") == approx(3 * array(found, "friction_coefficient"))


def test_inputs_stand_in_the_order_of_their_spreads_with_what_knowing_them_would_leave(found: LabelledArrays) -> None:
    names = list(found.coordinates["input"].to_numpy())
    assert names == ["decay_length", "friction_coefficient", "vibration_amplitude"]
    assert array(found, "input_spread")[1:] == approx([0.1, 0.05])
    assert array(found, "input_value")[1:] == approx([0.341, 2.5e-6])
    ratio, force = array(found, "interval_share_left"), array(found, "force_interval_share_left")
    assert ratio[0] < 0.9
    assert ratio[1] == approx(1)  # dry friction is not in the ratio
    assert force[1] < 1
    assert np.all((ratio <= 1) & (force <= 1))
    assert list(array(found, "input_label")) == ["decay length of the contact", "dry friction", "amplitude"]
    assert "within 10 %" in array(found, "input_text")[1]


@mark.parametrize(("factor", "is_known"), [(1.0299, True), (1.5, False)])
def test_an_input_that_is_known_as_well_as_it_can_be_leaves_everything(factor: float, is_known: bool) -> None:
    # a standard deviation of 3 % of the logarithm: exp(0.03) = 1.0305; half as much again tells of the force
    law = Distribution(law=LogNormal(median=0.341, factor=factor), lowest=0.0, text="known")
    rig = replace(tribometer(), uncertainty={"friction.friction_coefficient": law})
    one = predict(rig, draws=2000).sel(input="friction_coefficient")
    assert (float(one["force_interval_share_left"]) == 1.0) is is_known


def test_one_hundred_draws_and_two_hundred_thousand_are_allowed() -> None:
    assert predict(tribometer(), draws=100).sizes["draw"] == 100


def test_runs_of_a_rig_are_kept_with_what_was_predicted_before_them_and_moved_to_the_operating_point() -> None:
    runs = xr.Dataset(
        {
            "friction_reduction": ("run", [0.6, 0.3]),
            "sliding_speed": ("run", [0.0203, 0.0203]),
            "vibration_amplitude": ("run", [2.5e-6, 1.2e-6]),
            "friction_reduction_uncertainty": ("run", [0.03, 0.04]),
        }
    )
    before = predict(tribometer(), draws=1000)
    after = predict(tribometer(), runs=runs, draws=1000)
    assert after["measured_friction_ratio"].to_numpy() == approx([0.4, 0.7])
    assert after["measured_uncertainty"].to_numpy() == approx([0.03, 0.04])
    assert after["measured_vibration_amplitude"].to_numpy() == approx([2.5e-6, 1.2e-6])
    assert after["measured_sliding_speed"].to_numpy() == approx([0.0203, 0.0203])
    low, high = after["predicted_low"].to_numpy(), after["predicted_high"].to_numpy()
    assert np.all(low < high)
    # as predicted before: the 95 % interval there with the uncertainty of the run
    wide = interval(before, "friction_ratio", 0.95)
    assert (low[0], high[0]) == approx(wide, abs=0.06)
    # over the amplitude nothing has to be moved, at the speed of the rig; over the speed the second is at another one
    assert after["measured_ratio_moved_over_amplitude"].to_numpy() == approx([0.4, 0.7], abs=1e-9)
    moved = after["measured_ratio_moved_over_speed"].to_numpy()
    assert moved[0] == approx(0.4, abs=1e-9)
    curve = after["friction_ratio_over_amplitude"].sel(level=0.5)
    medians = np.interp(np.log([2.5e-6, 1.2e-6]), np.log(after["curve_amplitude"].to_numpy()), curve.to_numpy())
    assert moved[1] == approx(0.7 + medians[0] - medians[1], abs=0.03)
    assert after.attrs["runs"] == 2
    assert "measured_friction_ratio" not in before


def test_a_lubricated_contact_has_even_ratios_at_every_point_and_no_measurement_to_choose() -> None:
    found = predict(tribometer(), lubricant=True, draws=1000)
    assert np.sort(found["friction_ratio"].to_numpy()) == approx((np.arange(1000) + 0.5) / 1000)
    assert found["friction_ratio_over_speed"].to_numpy()[3] == approx(np.full(33, 0.5))
    assert found["measure_label"].size == 0
    assert found.attrs["unknown"] == 1


def test_the_wear_of_a_lubricated_contact_is_not_known_but_where_own_runs_state_it() -> None:
    found = predict(tribometer(), lubricant=True, draws=200)
    assert "wear_rate_ratio" not in found
    assert "not known of a lubricated contact" in found.attrs["statement"]
    runs = xr.Dataset({"friction_reduction": ("run", [0.6, 0.62]), "wear_rate_ratio": ("run", [0.9, 0.92])})
    assert "wear_rate_ratio" not in predict(tribometer(), runs=runs.drop_vars("wear_rate_ratio"), lubricant=True)
    worn = predict(tribometer(), runs=runs, lubricant=True, draws=1000)
    assert float(np.median(worn["wear_rate_ratio"])) == approx(0.91, abs=0.05)


def test_an_amplitude_of_a_nanometre_leaves_wear_within_a_hundredth_of_that_without_vibration() -> None:
    # at rest the model takes 1 - exp(-a/l)/I0(a/l) = 0.06 % of friction for l = 1.6 um, 0.2 % of the smallest reduction
    # of the published wear tests, 29 %; a factor of 5 on its odds and ln 0.5 for their effect give 0.7 %
    rig = replace(tribometer(), vibration_amplitude=1e-9, measured_under=None)
    found = predict(rig, draws=2000)
    low, high = interval(found, "wear_rate_ratio", 0.95)
    assert 0.99 < low <= high < 1.01
    assert "Wear does not change" in found.attrs["wear"]


def test_wear_follows_the_friction_of_the_model_and_not_its_discrepancy(monkeypatch: MonkeyPatch) -> None:
    # without discrepancy the ratios are the means themselves, so that the wear is that by the ratios
    found = LivePrediction(tribometer(), draws=300).first
    monkeypatch.setattr(RigDraws, "normals", lambda draws, at: (draws.means(at), 0 * draws.means(at)))
    quiet = LivePrediction(tribometer(), draws=300).first
    assert array(found, "wear_rate_ratio") == approx(array(quiet, "wear_rate_ratio"))
    share = vibration_weight(friction_ratio=array(quiet, "friction_ratio"))
    assert array(quiet, "wear_rate_ratio") == approx(learned().wear.wear_rate_ratios(300, weight=share))


def test_wear_that_the_runs_measured_moves_the_prediction_of_wear() -> None:
    plain = {"friction_reduction": ("run", [0.6, 0.62]), "sliding_speed": ("run", [0.0203, 0.021])}
    worn = xr.Dataset(plain | {"wear_rate_ratio": ("run", [0.9, 0.92])})
    medians = [float(np.median(predict(tribometer(), runs=runs, draws=2000)["wear_rate_ratio"]))
               for runs in (xr.Dataset(plain), worn)]  # fmt: skip
    assert medians[0] < 0.75
    assert medians[1] == approx(0.91, abs=0.05)


def test_a_rig_whose_length_is_measured_names_no_resonance_and_other_rigs_do_not_move_it() -> None:
    known = tribometer("contact.decay_length=1.3um")
    found = predict(known, draws=500)
    assert found.attrs["stiffness_probes"] == ""
    assert found["measure_label"].size == 2
    weak = xr.Dataset({"friction_reduction": ("run", [0.1, 0.12, 0.11])})
    beside = predict(known, laboratory_runs=[(read_rig(RIGS / "power_map.toml"), weak)], draws=500)
    assert beside["input_value"].sel(input="decay_length") == approx(1.3e-6)
