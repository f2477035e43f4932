"""Prediction of a rig: what comes out, what narrows it, what is refused, and by which means."""

import json
import subprocess
import sys
from dataclasses import replace
from math import exp
from pathlib import Path

import numpy as np
import xarray as xr
from pytest import approx, mark, raises
from scipy.stats import norm

from sonolube.charts import Line, Panel, Points
from sonolube.errors import InvalidInput
from sonolube.facts.published import si_value
from sonolube.measurement.measured_runs import read_runs
from sonolube.prediction import LivePrediction, interval, predict, prediction_chart
from sonolube.rig import Distribution, LogNormal, Rig, friction_point, read_rig
from sonolube.tasks.predict.new import new

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
COLUMNS = "vibration_amplitude [um],sliding_speed [mm/s],friction_ratio"
STEEL, ALUMINIUM = "stainless_steel_316", "aluminium_2024"


def rig() -> Rig:
    return read_rig(RIGS / "tribometer.toml")


def runs_file(
    path: Path, *rows: str, head: str = "vibration_amplitude [um],sliding_speed [mm/s],friction_ratio"
) -> Path:
    (path / "runs.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path / "runs.csv"


def width(prediction: xr.Dataset) -> float:
    low, high = interval(prediction, "friction_ratio")
    return high - low


def test_the_measured_ratio_of_the_reference_rig_lies_within_its_80_percent_interval() -> None:
    low, high = interval(predict(rig()), "friction_ratio")
    assert low < 0.379 / 1.024 < high  # N, Table 2.3


def test_force_coefficient_and_reduction_are_those_of_each_draw() -> None:
    found = predict(rig(), draws=500)
    assert found["friction_reduction"].to_numpy() == approx(1 - found["friction_ratio"].to_numpy())
    assert found["friction_force"].to_numpy() == approx(3.0 * found["friction_coefficient"].to_numpy())
    assert found["wear_reduction"].to_numpy() == approx(1 - found["wear_rate_ratio"].to_numpy())
    assert found["friction_force"].attrs["units"] == "N"


def test_wider_intervals_contain_narrower_ones() -> None:
    found = predict(rig())
    ends = [interval(found, "friction_ratio", probability) for probability in (0.5, 0.8, 0.95)]
    assert ends[2][0] < ends[1][0] < ends[0][0] < ends[0][1] < ends[1][1] < ends[2][1]


def brass_rig() -> Rig:
    """Rig of README, by `new`."""
    return new(
        pin="brass", disc="304", load="5N", speed="0.2m/s", frequency="20kHz", amplitude="3um", finish="ground N6"
    ).rig


def test_every_prediction_says_the_direction_of_the_vibration() -> None:
    assert "along the normal" in predict(rig(), draws=300).attrs["statement"]


def test_no_roughness_changes_a_prediction() -> None:
    rougher = rig().replace("contact.roughness.rms_height", "3 um")
    found, other = (predict(one, draws=300)["friction_ratio"].to_numpy() for one in (rougher, rig()))
    assert found == approx(other, abs=1e-6)


def test_a_measured_contact_stiffness_narrows_the_interval_the_more_the_better_it_is_known() -> None:
    widths = [width(predict(brass_rig()))]
    known = brass_rig()
    stiff = known.replace("contact.normal_stiffness", f"{known.normal_load / 1.6e-6:.6g} N/m")
    for factor in (1.35, 1.1):
        law = Distribution(law=LogNormal(median=1.0, factor=factor), lowest=0.0, text=f"within {factor}")
        widths.append(width(predict(replace(stiff, uncertainty={"contact.normal_stiffness": law}))))
    assert widths[1] < 1.03 * widths[0]  # within the error of the draws
    assert widths[2] < widths[1]


def test_a_run_and_the_stiffness_are_said_to_narrow_the_interval_as_they_do(tmp_path: Path) -> None:
    found = predict(rig())
    left = dict(zip(found["measure_label"].to_numpy(), found["measure_share_left"].to_numpy(), strict=True))
    low, high = interval(found, "friction_ratio")
    outcomes = np.quantile(found["friction_ratio"], (np.arange(5) + 0.5) / 5)
    head = f"{COLUMNS},friction_reduction_uncertainty"
    widths = [
        width(predict(rig(), runs=read_runs(runs_file(tmp_path, f"2.5,20.3,{max(r, 0.01):.3f},0.05", head=head))))
        for r in outcomes
    ]
    assert left["one run at this point"] == approx(np.mean(widths) / (high - low), abs=0.06)
    probe, working = found.attrs["stiffness_probes"].split("\n")[0], found.attrs["stiffness_probes"].split("\n")[-1]
    assert probe.startswith("floating mode: pressed")
    assert working.endswith("not resolvable")
    (by_probe,) = (share for label, share in left.items() if "by the floating mode" in label)
    # within 10 %, of the modal mass: a length known so on this rig leaves the same of the interval
    lengths = 1.62e-6 * np.exp(0.6 * norm.ppf((np.arange(5) + 0.5) / 5))
    law = Distribution(law=LogNormal(median=1.0, factor=exp(0.1)), lowest=0.0, text="within 10 %")
    known = [rig().replace("contact.decay_length", f"{length:.6g} m") for length in lengths]
    narrowed = [width(predict(replace(one, uncertainty={"contact.decay_length": law}))) for one in known]
    assert by_probe == approx(np.mean(narrowed) / (high - low), abs=0.08)


def test_of_a_rig_without_structure_a_better_known_stiffness_leaves_less_and_no_resonance_is_named() -> None:
    found = predict(brass_rig())
    left = dict(zip(found["measure_label"].to_numpy(), found["measure_share_left"].to_numpy(), strict=True))
    assert "no structure is known" in found.attrs["stiffness_probes"]
    assert left["contact stiffness within 10 %"] < left["contact stiffness within 30 %"] < 1


def test_a_measured_stiffness_leaves_of_the_interval_what_is_said() -> None:
    found, median, deviation = predict(brass_rig()), 1.62e-6, 0.6
    left = dict(zip(found["measure_label"].to_numpy(), found["measure_share_left"].to_numpy(), strict=True))
    law = Distribution(law=LogNormal(median=1.0, factor=exp(0.3)), lowest=0.0, text="within 30 %")
    widths = []
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):  # of the population's lengths, which a stiffness within 30 % blurs
        length = median * exp(np.hypot(deviation, 0.3) * norm.ppf(share) * deviation**2 / (deviation**2 + 0.09))
        known = brass_rig().replace("contact.decay_length", f"{length:.6g} m")
        widths.append(width(predict(replace(known, uncertainty={"contact.decay_length": law}))))
    assert left["contact stiffness within 30 %"] == approx(np.mean(widths) / width(found), abs=0.08)


def test_what_is_typed_for_friction_counts_whatever_range_the_file_has() -> None:
    found, typed = (
        predict(one, draws=500) for one in (brass_rig(), brass_rig().replace("friction.friction_coefficient", 0.6))
    )
    assert typed["friction_coefficient"].to_numpy() / typed["friction_ratio"].to_numpy() == approx(0.6, rel=0.5)
    assert np.median(typed["friction_force"]) / np.median(found["friction_force"]) == approx(0.6 / 0.425, rel=0.1)


def test_the_curves_hold_the_operating_point_with_the_interval_of_the_table() -> None:
    found = predict(rig(), draws=1000)
    for name, attribute in (("amplitude", "vibration_amplitude"), ("speed", "sliding_speed")):
        at = np.flatnonzero(found[f"curve_{name}"].to_numpy() == found.attrs[attribute])
        assert at.size == 1
        quantiles = found[f"friction_ratio_over_{name}"].to_numpy()[:, at[0]]
        assert quantiles == approx(np.quantile(found["friction_ratio"], found["level"]), abs=1e-12)


@mark.parametrize("draws", [0, 99, -5, 1_000_000])
def test_a_number_of_draws_that_says_nothing_or_takes_for_ever_is_refused(draws: int) -> None:
    with raises(InvalidInput, match=f"draws must lie between 100 and 200000, got {draws}"):
        predict(rig(), draws=draws)


def test_many_draws_give_the_same_interval() -> None:
    assert interval(predict(rig(), draws=20_000), "friction_ratio") == approx(
        interval(predict(rig()), "friction_ratio"), abs=0.01
    )


def test_a_lubricated_contact_gets_no_dry_interval() -> None:
    found = predict(rig(), lubricant=True, draws=1000)
    assert interval(found, "friction_reduction", 0.95) == approx((0.025, 0.975), abs=0.01)
    assert "0 to 100 %" in found.attrs["statement"]


def test_a_live_prediction_follows_the_rig_and_equals_a_fresh_one(tmp_path: Path) -> None:
    runs = read_runs(runs_file(tmp_path, "2,20,0.5", "2.5,40,0.6"))
    for own in (None, runs):
        live = LivePrediction(rig(), runs=own, draws=500)
        for key, value in (("sliding.sliding_speed", "60 mm/s"), ("contact.normal_load", "4 N")):
            changed = rig().replace(key, value)
            found, fresh = live.at(changed), predict(changed, runs=own, draws=500)
            for name in ("friction_ratio", "friction_force", "wear_rate_ratio", "friction_ratio_over_speed"):
                assert found[name].to_numpy() == approx(fresh[name].to_numpy(), abs=1e-6)
            assert found.attrs["statement"] == fresh.attrs["statement"]


def test_the_heat_is_that_of_the_predicted_force_and_needs_both_materials() -> None:
    found = predict(rig(), pin=STEEL, disc=ALUMINIUM, draws=300)
    rise, force = found["mean_temperature_rise"].to_numpy(), found["friction_force"].to_numpy()
    assert rise * force.max() == approx(rise.max() * force)
    assert "Heat of friction does not limit: at most (80 %) " in found.attrs["statement"]
    assert "of flash temperature where one real spot of" in found.attrs["statement"]
    with raises(InvalidInput, match="both materials"):
        predict(rig(), pin=STEEL)


def test_own_runs_narrow_the_interval_the_more_the_more_there_are(tmp_path: Path) -> None:
    rows = ["2.5,20.3,0.4", "2.5,60,0.63", "1.2,20.3,0.75", "2,20.3,0.5", "2.5,10,0.35", "1.8,40,0.62"]
    runs = [None, *(read_runs(runs_file(tmp_path, *rows[:count])) for count in (1, 3, 6))]
    widths = [width(predict(rig(), runs=some)) for some in runs]
    assert widths[1] < 1.03 * widths[0]  # within the error of the draws
    assert widths[2] < widths[1]
    assert widths[-1] < 0.5 * widths[0]


def test_runs_by_voltage_and_forces_are_those_by_amplitude_and_ratio(tmp_path: Path) -> None:
    amplitude = friction_point(rig()).vibration_amplitude
    head = "voltage_peak_to_peak [V],friction_force [mN],intrinsic_friction_force [N]"
    by_force = predict(rig(), runs=read_runs(runs_file(tmp_path, "14,600.00,1.00000", head=head)))
    head = "vibration_amplitude [m],friction_reduction [%]"
    by_ratio = predict(rig(), runs=read_runs(runs_file(tmp_path, f"{amplitude / 2!r},40.000", head=head)))
    assert by_force["friction_ratio"].to_numpy() == approx(by_ratio["friction_ratio"].to_numpy(), abs=1e-9)


def test_runs_that_contradict_the_prediction_are_said_so_first_and_believed_there(tmp_path: Path) -> None:
    found = predict(rig(), runs=read_runs(runs_file(tmp_path, "2.5,20.3,1.2", "2.5,20.3,1.15")))
    assert found.attrs["statement"].startswith("Your runs contradict every model")
    low, high = interval(found, "friction_ratio")
    assert 1.05 < low < 1.175 < high < 1.3


def test_equal_runs_count_as_repeats(tmp_path: Path) -> None:
    once = predict(rig(), runs=read_runs(runs_file(tmp_path, "2,20,0.5")))
    thrice = predict(rig(), runs=read_runs(runs_file(tmp_path, *["2,20,0.5"] * 3)))
    assert width(thrice) < 0.95 * width(once)
    assert "2 of 3 runs equal another in every digit; they count as repeats" in thrice.attrs["caveats"]


def test_the_scatter_of_repeats_is_taken_for_the_uncertainty_of_each_run(tmp_path: Path) -> None:
    rows = [f"2.5,20.3,{ratio}" for ratio in (0.40, 0.44, 0.36, 0.42, 0.38)]
    found = predict(rig(), runs=read_runs(runs_file(tmp_path, *rows)))
    assert found["measured_uncertainty"].to_numpy() == approx(np.std([0.40, 0.44, 0.36, 0.42, 0.38], ddof=1))


def test_equal_repeats_are_uncertain_by_the_last_digit_that_is_written(tmp_path: Path) -> None:
    # half of 0.01 N over sqrt(3) in each force: hypot(1, 0.52 / 1.12) * 0.0028868 / 1.12 = 0.0028417
    head = "voltage_peak_to_peak [V],sliding_speed [mm/s],friction_force [N],intrinsic_friction_force [N]"
    found = predict(rig(), runs=read_runs(runs_file(tmp_path, *["28,30,0.52,1.12"] * 6, head=head)))
    assert found["measured_uncertainty"].to_numpy() == approx([0.0028417] * 6, rel=1e-4)
    assert "0.0028 by the digits is taken" in found.attrs["caveats"]
    fine = predict(rig(), runs=read_runs(runs_file(tmp_path, *["28,30,0.520000000,1.120000000"] * 6, head=head)))
    assert np.isfinite(width(fine))


@mark.parametrize(("stated", "is_said"), [(0.0008, True), (0.05, False)])
def test_standard_errors_within_a_test_are_said_to_leave_out_how_tests_differ(
    stated: float, is_said: bool, tmp_path: Path
) -> None:
    head = f"{COLUMNS},friction_reduction_uncertainty"
    rows = [f"{amplitude},20.3,{ratio},{stated}" for amplitude, ratio in ((1.2, "0.8500"), (2.5, "0.7000"))]
    found = predict(rig(), runs=read_runs(runs_file(tmp_path, *rows, head=head)))
    assert (f"an uncertainty of {stated:g} of their ratios, as of one test" in found.attrs["caveats"]) is is_said
    assert (width(found) < 0.05) is is_said  # less than the printed scatter of one rig's own tests


@mark.parametrize(
    ("rows", "message"),
    [
        (["2,20,3.5"], "friction ratio of 3.5"),
        (["0,20,0.5"], "vibration_amplitude of run 1 must be positive"),
        (["2,-20,0.5"], "sliding_speed of run 1 must be positive"),
    ],
)
def test_runs_that_cannot_be_are_refused_in_one_line(tmp_path: Path, rows: list[str], message: str) -> None:
    with raises(InvalidInput, match=message) as refusal:
        predict(rig(), runs=read_runs(runs_file(tmp_path, *rows)))
    assert "\n" not in str(refusal.value)


def test_runs_of_vibration_in_the_contact_plane_are_refused(tmp_path: Path) -> None:
    head = "vibration_amplitude [um],vibration_direction [deg],friction_ratio"
    with raises(InvalidInput, match="vibration along the normal"):
        predict(rig(), runs=read_runs(runs_file(tmp_path, "2,90,0.5", head=head)))


def test_words_for_the_direction_of_runs_count_as_their_angles(tmp_path: Path) -> None:
    head = "vibration_amplitude [um],vibration_direction,friction_ratio"
    with raises(InvalidInput, match="vibration along the normal"):
        predict(rig(), runs=read_runs(runs_file(tmp_path, "2,across,0.5", head=head)))
    with raises(InvalidInput, match="leave out runs with the direction torsional"):
        predict(rig(), runs=read_runs(runs_file(tmp_path, "2,torsional,0.5", head=head)))
    stated = predict(rig(), runs=read_runs(runs_file(tmp_path, "2,normal,0.5", head=head)))
    silent = predict(
        rig(), runs=read_runs(runs_file(tmp_path, "2,0.5", head="vibration_amplitude [um],friction_ratio"))
    )
    assert stated["friction_ratio"].to_numpy() == approx(silent["friction_ratio"].to_numpy())


def test_empty_cells_take_what_the_rig_has(tmp_path: Path) -> None:
    full = predict(rig(), runs=read_runs(runs_file(tmp_path, "2,20.3,0.5", "2.5,20.3,0.4")))
    empty = predict(rig(), runs=read_runs(runs_file(tmp_path, "2,,0.5", "2.5,,0.4", "2.5,,")))
    assert empty["friction_ratio"].to_numpy() == approx(full["friction_ratio"].to_numpy(), abs=1e-12)
    assert "1 of 3 runs have no friction yet and are left out (line 4)" in empty.attrs["caveats"]


def test_runs_without_friction_are_refused_with_the_columns_that_would_do(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"needs a column friction_reduction \[%\], or friction_ratio"):
        read_runs(runs_file(tmp_path, "2,20", head="vibration_amplitude [um],sliding_speed [mm/s]"))


@mark.parametrize(
    ("change", "message"),
    [({"drive": None}, "needs a frequency"), ({"sliding_speed": 0.0}, "needs a sliding speed above 0")],
)
def test_a_rig_that_cannot_be_predicted_is_refused(change: dict[str, object], message: str) -> None:
    with raises(InvalidInput, match=message):
        predict(replace(read_rig(RIGS / "welder_round.toml"), **change))  # type: ignore[arg-type]


def test_the_figure_shows_bands_published_tests_and_own_runs(tmp_path: Path) -> None:
    over_amplitude, over_speed = charted(tmp_path, "2,20.3,0.5")
    labels = [getattr(part, "label", "") for part in over_amplitude.parts]
    assert labels[:3] == ["95 % interval", "80 % interval", "50 % interval"]
    assert "own runs" in labels
    assert "own runs" not in [getattr(part, "label", "") for part in over_speed.parts]  # at another amplitude


def test_a_run_at_another_speed_is_moved_to_that_of_the_operating_point(tmp_path: Path) -> None:
    over_amplitude, over_speed = charted(tmp_path, "2.5,100,0.8")
    (moved,) = (part for part in over_amplitude.parts if getattr(part, "label", "").startswith("own runs"))
    (measured,) = (part for part in over_speed.parts if getattr(part, "label", "") == "own runs")
    assert isinstance(moved, Points)
    assert isinstance(measured, Points)
    assert "moved to the operating point" in moved.label
    assert moved.is_hollow
    assert measured.y[0] == approx(0.8)
    assert measured.x[0] == approx(100)
    assert 0 <= moved.y[0] < 0.7  # slower sliding has less friction
    (median,) = (part for part in over_speed.parts if getattr(part, "label", "") == "median")
    assert isinstance(median, Line)
    at_point, at_run = np.interp(np.log([20.3, 100.0]), np.log(median.x), median.y)
    assert moved.y[0] == approx(0.8 + at_point - at_run, abs=0.01)
    assert "0.8 at 2.5 um, 100 mm/s" in moved.sources[0]


def test_runs_above_a_ratio_of_one_lie_within_the_figure(tmp_path: Path) -> None:
    assert all((panel.y.highest or 0) > 1.35 for panel in charted(tmp_path, "2.5,20.3,1.3"))


def charted(folder: Path, run: str) -> tuple[Panel, ...]:
    return prediction_chart(predict(rig(), runs=read_runs(runs_file(folder, run)), draws=400)).panels


def test_no_sampler_is_imported_for_a_prediction() -> None:
    program = (
        "import sys, json\nfrom sonolube.prediction import predict\nfrom sonolube.rig import read_rig\n"
        f"predict(read_rig({str(RIGS / 'tribometer.toml')!r}), draws=200)\n"
        "print(json.dumps(sorted({name.split('.')[0] for name in sys.modules})))"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not {"emcee", "numpyro", "jax", "pymc", "blackjax"} & set(json.loads(found.stdout))


def test_the_unknown_resonance_of_the_flextensional_actuator_leaves_room_for_the_measured_reduction() -> None:
    # D 2.2.4: 70 % at 3.5 mm/s; the rig has the static stroke, and what resonance adds between the plates is not known
    rig = read_rig(RIGS / "flextensional.toml", changes=["sliding.sliding_speed=3.5mm/s"])
    low, high = interval(predict(rig, draws=500), "friction_reduction")
    assert low < si_value("2.2.4-reduction") < high
