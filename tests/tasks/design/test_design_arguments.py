"""Arguments of designs as within their tasks: units, defaults, ranges from both sides, and what they exclude."""

from math import inf
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of
from tests.tasks.running import running

from sonolube.design.optimisation import OWN_ACTUATOR
from sonolube.errors import InvalidInput, UnknownName
from sonolube.example_files import example_file
from sonolube.rig import Rig, read_rig
from sonolube.tasks.design import control, efficiency, map as maps, optimise, plan, sweep, uncertainty
from sonolube.tasks.export import mock_up


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The reference rig, driven by a voltage: 3 N, 20.3 mm/s, coefficient 0.34."""
    return read_rig(example_file("tribometer").source)


UNDRIVEN: Any = SimpleNamespace(title="Own", normal_load=3.0, friction_coefficient=0.2)


@pytest.mark.parametrize(
    ("target", "force"), [("0.2", 0.6), (0.2, 0.6), ("0.6N", 0.6), (" 600 mN", 0.6), ("20 %", 0.6)]
)
def test_a_target_is_a_coefficient_or_a_force(target: str | float, force: float) -> None:
    assert control.friction_force("friction", target, normal_load=3.0) == approx(force)


@pytest.mark.parametrize("target", ["0", "-0.1", "0N"])
def test_a_target_is_positive(target: str) -> None:
    with raises(InvalidInput, match=f"^friction {target} must be positive"):
        control.friction_force("friction", target, normal_load=3.0)


def test_sampling_and_times_of_a_run_are_positive_and_the_delay_fits_in() -> None:
    with running(control.control, rate="5 kHz"):
        assert control._times("5 kHz", "1 ms", 0.2) == approx((0.2e-3, 1e-3, 0.2))
        assert control._times("5 kHz", "0.2 s", 0.2)[1] == approx(0.2)
        for rate, duration in (("0 Hz", "1 s"), ("1 Hz", "0 s"), ("-1 Hz", "1 s")):
            with raises(InvalidInput, match=r"must be positive$"):
                control.sampling_and_duration(rate=rate, duration=duration)
        with raises(InvalidInput, match=r"^delay 0\.3 s must not exceed duration 0\.2$"):
            control._times("5 kHz", "0.3 s", 0.2)


def test_limits_are_those_given_the_rigs_own_or_none(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(control, "own_level", lambda rig: 28.0)
    monkeypatch.setattr(control, "commanded_quantity", lambda rig: names_of(control).VOLTAGE)
    with running(control.control, voltage_limit="30 V"):
        amplifier = control._limits(UNDRIVEN, None, None, None, None)["amplifier"]
        assert (amplifier.voltage_maximum, amplifier.current_maximum, amplifier.slew_rate_maximum) == (28.0, inf, inf)
        amplifier = control._limits(UNDRIVEN, None, "30 V", 0.5, 2e6)["amplifier"]
        assert (amplifier.voltage_maximum, amplifier.current_maximum) == approx((30.0, 0.5))
        assert amplifier.slew_rate_maximum == approx(2e6)
        monkeypatch.setattr(control, "commanded_quantity", lambda rig: names_of(control).AMPLITUDE)
        assert control._limits(UNDRIVEN, "2 um", None, None, None) == {"amplitude_maximum": approx(2e-6)}
        assert control._limits(UNDRIVEN, None, None, None, None) == {"amplitude_maximum": 28.0}


def test_an_efficiency_that_is_given_holds_at_every_speed() -> None:
    own = control._efficiency_line(2e-10)
    assert (own.slope, own.intercept) == (0.0, 2e-10)
    assert control._efficiency_line(None).slope != 0


def test_a_resonance_is_assumed_where_a_rig_has_no_structure(rig: Rig, monkeypatch: MonkeyPatch) -> None:
    assert control.resonance_without_structure(rig, 50.0, 0.2) == (None, {})
    monkeypatch.setattr(names_of(control).loops, "assumed_mode", lambda rig, **named: named)
    monkeypatch.setattr(names_of(control).loops, "amplitude_mode", lambda rig, **named: named)
    monkeypatch.setattr(control, "commanded_quantity", lambda rig: names_of(control).VOLTAGE)
    bare: Any = SimpleNamespace(structure=None)
    mode: Any
    mode, assumed = control.resonance_without_structure(bare, 50.0, 0.25)
    assert mode == {"quality_factor": 50.0, "coupling_factor": 0.25}
    assert assumed == {
        "resonance": "at the drive's frequency, quality factor 50, coupling 0.25; not measured",
    }  # fmt: skip
    monkeypatch.setattr(control, "commanded_quantity", lambda rig: names_of(control).AMPLITUDE)
    mode, assumed = control.resonance_without_structure(bare, 50.0, 0.25)
    assert mode == {"quality_factor": 50.0}
    assert "quality factor 50; not measured" in assumed["amplitude control"]


@pytest.mark.parametrize("step", ["0 %", "-91 %", "901 %"])
def test_a_disturbance_lies_between_a_tenth_left_and_ten_times(step: str, rig: Rig) -> None:
    with raises(InvalidInput, match=rf"^disturbance {step} must lie between -90 and 900 %, and not be zero$"):
        control.control(rig, disturbance=step)


def test_a_target_ratio_is_below_friction_without_vibration() -> None:
    # 0.2 times 3 N: 0.6 N without vibration
    assert optimise.target_ratio(UNDRIVEN, "0.3N") == approx(0.5)
    assert optimise.target_ratio(UNDRIVEN, 0.15) == approx(0.75)
    assert optimise.target_ratio(UNDRIVEN, None, 0.6) == approx(0.4)
    for target, reduction, words in (
        (None, None, "give target_friction, or target_reduction in its place"),
        ("0.1", 0.5, "give target_friction, or target_reduction in its place"),
        (None, 0.0, "target_reduction must lie between 0 and 100 %, got 0 %"),
        (None, 1.0, "target_reduction must lie between 0 and 100 %, got 100 %"),
        ("0.2", None, "target_friction 0.2 must lie below friction without vibration, 0.2 or 600 mN"),
    ):  # fmt: skip
        with raises(InvalidInput, match=f"^{words}"):
            optimise.target_ratio(UNDRIVEN, target, reduction)


def test_a_horn_needs_its_material_and_the_stress_that_it_bears(monkeypatch: MonkeyPatch) -> None:
    assert optimise.half_wave_horn(None, None) is None
    values = {"density": 4430.0, "youngs_modulus": 114e9}
    monkeypatch.setattr(optimise, "material", lambda name: SimpleNamespace(value=values.__getitem__))
    found = optimise.half_wave_horn("titanium", 200e6)
    assert found is not None
    assert (found.density, found.youngs_modulus, found.stress_limit) == (4430.0, 114e9, 200e6)
    for given in (("titanium", None), (None, 200e6)):
        with raises(InvalidInput, match=r"^horn and horn_limit belong together"):
            optimise.half_wave_horn(*given)


def test_a_bolt_needs_its_thread_and_tension(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(optimise, "preload_bolt", lambda thread, **named: (thread, named))
    assert optimise.bolt_of_thread(None, None, 1.0) is None
    assert optimise.bolt_of_thread("M6x40mm", 1e3, 640e6) == (  # type: ignore[comparison-overlap]
        "M6x40mm", {"preload": 1e3, "yield_strength": 640e6, "name": "bolt"},
    )  # fmt: skip
    for given in (("M6x40mm", None), (None, 1e3)):
        with raises(InvalidInput, match=r"^bolt and preload belong together, such as bolt M6x40mm preload 1kN$"):
            optimise.bolt_of_thread(given[0], given[1], 640e6)


def test_actuators_are_named_once_and_the_catalogue_is_those_with_complete_sheets() -> None:
    known: Any = {name: SimpleNamespace(complete=name != "b") for name in "abc"}
    assert optimise._actuator_names((), known) == (OWN_ACTUATOR,)
    assert optimise._actuator_names(("c", "catalogue", "own", "c"), known) == ("c", "a", "own")
    assert optimise._actuator_names(("b",), known) == ("b",)


def test_waveforms_are_of_four_and_the_drives_own_by_default() -> None:
    assert optimise._waveform_names({"drive.waveform": "square,sine", "drive.frequency": "1:2"}, "sine") == (
        "square", "sine",
    )  # fmt: skip
    assert optimise._waveform_names({"drive.frequency": "1:2"}, "triangle") == ("triangle",)
    with raises(InvalidInput, match=r"^over drive\.waveform: 'round' is none of sine, square, triangle, sawtooth$"):
        optimise._waveform_names({"drive.waveform": "sine,round"}, "sine")


def test_ranges_are_of_the_frequency_or_an_entry_of_the_structure() -> None:
    optimise._require_range_key("drive.frequency", {})
    optimise._require_range_key("structure.tip_mass", {"tip_mass": 0.05})
    with raises(UnknownName, match="unknown entry of structure 'tip_mas'; did you mean tip_mass"):
        optimise._require_range_key("structure.tip_mas", {"tip_mass": 0.05})
    for key in ("drive.voltage", "contact.tip_mass"):
        with raises(InvalidInput, match=rf"^over {key}: choose over drive\.frequency, drive\.waveform or an entry"):
            optimise._require_range_key(key, {"tip_mass": 0.05})


def test_a_design_space_has_rising_ranges_and_the_frequency_by_a_fifth(rig: Rig) -> None:
    given: dict[str, Any] = {"actuators": (), "catalogue": None, "mechanical_quality_factor": 80.0, "bolt": None}
    space = optimise.design_space(rig, over={"structure.tip_mass": "50g:150g"}, **given)
    assert space.frequencies == approx((17.6e3, 26.4e3))  # of 22 kHz
    assert space.ranges == {"tip_mass": approx((0.05, 0.15))}
    assert (space.actuators, space.waveforms, space.mechanical_quality_factor) == ((OWN_ACTUATOR,), ("sine",), 80.0)
    assert optimise.design_space(rig, over={"drive.frequency": (2e4, 3e4)}, **given).frequencies == (2e4, 3e4)
    for ends in ((0.1, 0.1), (0.2, 0.1), (0.0, 0.1)):
        with raises(InvalidInput, match=r"^over structure\.tip_mass: needs a range from above 0 that rises, got"):
            optimise.design_space(rig, over={"structure.tip_mass": ends}, **given)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"catalogue": "own.toml", "actuator": ["x"]}, "catalogue has no meaning unless actuator names one"),
        ({"quality": 70.0}, "quality has no meaning for the rig's own actuator"),
        ({"quality": 70.0, "actuator": ["own"]}, "quality has no meaning for the rig's own actuator"),
        ({"bolt_strength": "1 GPa"}, "bolt_strength has no meaning without bolt"),
        ({"pareto": "power"}, "pareto has no meaning for the quantity that is minimised; name another"),
        ({"samples": 4}, "samples has no meaning unless over gives an entry of structure"),
        ({"quantile": 0.9}, "quantile needs robust, the tolerance"),
        ({"temperature_limit": "40K"}, "temperature_limit needs conductance, the heat"),
    ],
)
def test_arguments_of_an_optimisation_that_change_nothing_are_refused(
    given: dict[str, Any], words: str, rig: Rig, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(optimise, "read_catalogue", lambda path: {"other": None})
    with raises(InvalidInput, match=f"^{words}"):
        optimise.optimise(rig, target_friction=0.15, **given)


def test_an_actuator_of_an_own_catalogue_gives_both_a_meaning(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(optimise, "read_catalogue", lambda path: {"other": None})
    with running(optimise.optimise, catalogue="own.toml", quality=70.0):
        for actuators in (["other"], ["catalogue"]):
            optimise._refuse_unused(actuators, "own.toml", bolt=None, same_objective=False)


INPUTS: Any = SimpleNamespace(sliding_speed=0.06, amplitude_per_volt=1e-7, amplitude=SimpleNamespace(value=2e-6))


def factors(**more: Any) -> Any:
    return plan._factors(UNDRIVEN, INPUTS, **({"speed": None, "load": None, "vibration": None, "voltage": None} | more))


def test_a_plan_is_about_the_rig_where_nothing_is_given() -> None:
    found = factors()
    assert found.normal_load == approx([3.0])
    assert (found.sliding_speed[0], found.sliding_speed[-1], found.sliding_speed.size) == (
        approx(0.02), approx(0.18), 7,
    )  # fmt: skip
    assert found.vibration_amplitude == approx([0.4e-6, 0.8e-6, 1.2e-6, 1.6e-6, 2e-6])  # from a fifth


def test_factors_of_a_plan_have_counts_of_their_own_and_voltages_scale_the_amplitude() -> None:
    found = factors(speed="20:80mm/s", load="3:7N", voltage="10,20V")
    assert (found.sliding_speed.size, found.normal_load.tolist()) == (7, approx([3.0, 4.58, 7.0]))  # in even ratios
    assert found.vibration_amplitude == approx([1e-6, 2e-6])
    assert factors(vibration="1:2um").vibration_amplitude.size == 5
    with raises(InvalidInput, match=r"^vibration and voltage both set the amplitude; give one$"):
        factors(vibration="1um", voltage="3V")
    bare: Any = SimpleNamespace(**(vars(INPUTS) | {"amplitude_per_volt": None}))
    with raises(
        InvalidInput,
        match=r"^voltage needs the rig's drive\.voltage_peak_to_peak or vibration\.calibration to scale by",
    ):
        plan._amplitudes(bare, None, "3V")


def test_running_in_is_as_published_or_the_same_in_both_states(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(plan, "published_distances", lambda: (12.0, 30.0))
    found = plan._procedure(None, 12.5, "day")
    assert (found.intrinsic_distance, found.vibrated_distance, found.measuring_time) == (12.0, 30.0, 12.5)
    own = plan._procedure(5.0, 1.0, "pair")
    assert (own.intrinsic_distance, own.vibrated_distance) == (5.0, 5.0)
    assert own.blocking is not found.blocking


def values(rig: Rig, of: str, lowest: str | None = None, highest: str | None = None, points: int | None = None) -> Any:
    return sweep._values(rig, of, lowest, highest, points)


def test_a_study_runs_over_its_usual_range_or_the_ends_given(rig: Rig) -> None:
    volts, loads, speeds = values(rig, "voltage"), values(rig, "load"), values(rig, "speed")
    assert (volts[0], volts[-1], volts.size) == (0.0, 200.0, 101)
    assert (loads[0], loads[-1], loads.size) == (3.0, 9.0, 25)
    assert (speeds[0], speeds[-1], speeds.size) == (approx(1e-3), approx(1.0), 61)
    assert np.diff(np.log(speeds)) == approx(np.full(60, np.log(1e3) / 60))
    assert np.diff(loads) == approx(np.full(24, 0.25))
    assert values(rig, "load", "2N", "4N", 3) == approx([2.0, 3.0, 4.0])
    assert values(rig, "amplitude")[-1] == approx(10e-6)
    frequencies = values(rig, "frequency", "20kHz", "24kHz", 5)
    assert (frequencies[0], frequencies[-1]) == approx((20e3, 24e3))
    assert frequencies.size > 5  # a resonance within has points of its own


@pytest.mark.parametrize(
    ("of", "lowest", "highest", "points", "words"),
    [
        ("voltage", "-1V", None, None, "lowest -1V must not lie below 0 V and must lie below highest 200V"),
        ("load", "0N", None, None, "lowest 0N must lie above 0 N and must lie below highest 9N"),
        ("load", "5N", "5N", None, "lowest 5N must lie above 0 N and must lie below highest 5N"),
        ("load", None, None, 1, "points 1 must lie between 2 and 10000 for of load"),
        ("load", None, None, 10_001, "points 10001 must lie between 2 and 10000 for of load"),
    ],
)
def test_ends_and_counts_of_a_study_are_refused(
    of: str, lowest: str | None, highest: str | None, points: int | None, words: str, rig: Rig
) -> None:
    with raises(InvalidInput, match=f"^{words}$"):
        values(rig, of, lowest, highest, points)
    assert values(rig, "load", points=2).size == 2
    assert values(rig, "voltage", "0V", "1V", 10_000).size == 10_000


def test_curves_are_voltages_or_amplitudes_by_what_the_rig_is_commanded_by(rig: Rig) -> None:
    assert sweep._curves(rig, "speed", (), ()) == {}
    found = sweep._curves(rig, "speed", ("10V", "20V"), ())
    assert found["voltage_peak_to_peak"] == approx([10.0, 20.0])
    for of, volts, amplitudes, words in (
        ("load", ("1V",), (), "voltage has no meaning for of load; it is for speed and frequency"),
        ("frequency", (), ("1um",), "vibration has no meaning for of frequency; it is for speed"),
    ):
        with raises(InvalidInput, match=f"^{words}$"):
            sweep._curves(rig, of, volts, amplitudes)
    with raises(InvalidInput, match=r"its voltage sets its vibration; give voltage of each curve$"):
        sweep._curves(rig, "speed", (), ("1um",))
    with raises(InvalidInput):
        sweep._curves(rig, "speed", ("0V",), ())
    assert "voltage" in sweep.studies_of(rig)
    assert "amplitude" not in sweep.studies_of(rig)


@pytest.mark.parametrize("given", [{"lowest": "1V"}, {"highest": "1V"}, {"points": 3}])
def test_waveforms_have_no_range_and_a_sweep_is_over_keys_or_of_one_quantity(given: dict[str, Any], rig: Rig) -> None:
    with raises(InvalidInput, match=r"have no meaning for of waveform, which runs over names$"):
        sweep.sweep(rig, of="waveform", **given)
    neither_or_both: tuple[dict[str, Any], ...] = ({}, {"of": "load", "over": {"drive.frequency": [1.0]}})
    for both in neither_or_both:
        with raises(InvalidInput, match=r"^needs either over, keys with their values, or of, one quantity"):
            sweep.sweep(rig, **both)
    for arguments, words in (
        ({"seed": 3}, "seed has no meaning for sample grid, which draws nothing; it is for lhs"),
        ({"scheduler": "tcp://a", "workers": 3}, "workers has no meaning for a scheduler at an address"),
        ({"points": 3}, "points has no meaning for sample grid; it is for lhs, and for of"),
        ({"sample": "lhs"}, "sample lhs needs points, how many to draw"),
        ({"lowest": "1V"}, "lowest has no meaning for over"),
    ):
        with raises(InvalidInput, match=f"^{words}"):
            sweep.sweep(rig, over={"drive.frequency": [1e3, 2e3]}, **arguments)


def test_bands_run_over_one_or_two_rising_keys() -> None:
    assert uncertainty._axes({}) == {}
    assert uncertainty._axes({"a.frequency": "1kHz:3kHz:3"})["a.frequency"] == approx([1e3, 2e3, 3e3])
    two = {"a.frequency": [1.0, 2.0], "b.frequency": [1.0, 2.0]}
    assert len(uncertainty._axes(two)) == 2
    for over, words in (
        (two | {"c.frequency": [1.0, 2.0]}, "over gives a band once and a map twice, not 3 times"),
        ({"drive.waveform": "sine,square"}, "over drive.waveform: a band needs numbers to run over, not words"),
        ({"a.frequency": [1.0]}, "over a.frequency: a band needs at least 2 values that rise"),
        ({"a.frequency": [1.0, 1.0]}, "over a.frequency: a band needs at least 2 values that rise"),
        ({"a.frequency": [2.0, 1.0]}, "over a.frequency: a band needs at least 2 values that rise"),
    ):
        with raises(InvalidInput, match=f"^{words}$"):
            uncertainty._axes(over)


@pytest.mark.parametrize("given", [{"over": {"a.b": [1.0, 2.0]}}, {"identified": True}])
def test_shares_of_the_variance_need_independent_entries(given: dict[str, Any], rig: Rig) -> None:
    with raises(InvalidInput, match=r"^sobol needs independent entries and one outcome each: leave out over and ident"):
        uncertainty.uncertainty(rig, sobol=True, **given)


def test_kinds_of_maps_are_those_of_the_commanded_quantity(rig: Rig, monkeypatch: MonkeyPatch) -> None:
    assert maps._kind(rig, None) == "velocity-power"
    assert maps._kind(rig, "frequency-voltage") == "frequency-voltage"
    with raises(InvalidInput, match=r"^kind velocity-amplitude is for a rig without a drive voltage, and that of"):
        maps._kind(rig, "velocity-amplitude")
    monkeypatch.setattr(maps, "commanded_quantity", lambda rig: names_of(maps).AMPLITUDE)
    assert maps._kind(rig, None) == "velocity-amplitude"
    with raises(InvalidInput, match=r"^kind velocity-power needs a drive voltage, and .* has an amplitude alone"):
        maps._kind(rig, "velocity-power")
    assert maps._listed(["a", "b", "c"]) == "a, b or c"


def test_axes_of_a_map_take_values_of_their_keys_and_two_at_least(rig: Rig) -> None:
    usual = maps._axes(rig, "velocity-power", {})
    own = maps._axes(rig, "velocity-power", {"sliding.sliding_speed": "10mm/s,20mm/s", "contact.normal_load": "5N"})
    assert own["sliding_speed"] == approx([0.01, 0.02])
    assert own["normal_load"] == approx([5.0])  # of one panel
    assert set(own) == set(usual)
    with raises(InvalidInput, match=r"^over drive\.frequency: no axis of a velocity-power map; its axes are sliding"):
        maps._axes(rig, "velocity-power", {"drive.frequency": "1kHz,2kHz"})
    with raises(InvalidInput, match=r"^over sliding\.sliding_speed: a velocity-power map runs over it, and needs at"):
        maps._axes(rig, "velocity-power", {"sliding.sliding_speed": "10mm/s"})


def test_an_efficiency_says_how_many_runs_were_beyond_what_friction_needs() -> None:
    found: Any = SimpleNamespace(saturated_runs=0, caveats=("a",), fit=SimpleNamespace(runs=7))
    answer = efficiency.EfficiencyAnswer(rig=UNDRIVEN, calibration=found, name="own-efficiency")
    assert answer.caveats() == ("a",)
    found.saturated_runs = 2
    assert answer.caveats()[1].startswith("2 runs left less than a tenth of the friction")
    assert "of 7 runs over sliding speed" in answer.figures()["own-efficiency"].caption


@pytest.mark.parametrize(("name", "word"), [("own", "own"), ("a-b c", "a_b_c"), ("2nd", "rig_2nd"), ("_a", "rig__a")])
def test_names_of_units_are_words_of_c(name: str, word: str) -> None:
    assert mock_up._word(name) == word


def test_variables_of_a_unit_have_ranges_where_they_are_inputs_with_ends() -> None:
    variables = [
        SimpleNamespace(name="load", is_input=True, unit="N", lowest=1.0, highest=5.0),
        SimpleNamespace(name="any", is_input=True, unit="", lowest=-inf, highest=inf),
        SimpleNamespace(name="force", is_input=False, unit="N", lowest=1.0, highest=5.0),
    ]
    unit: Any = SimpleNamespace(description=SimpleNamespace(variables=variables))
    assert mock_up._variables(unit) == {
        "load": {"causality": "input", "unit": "N", "lowest": 1.0, "highest": 5.0},
        "any": {"causality": "input", "unit": "", "lowest": None, "highest": None},
        "force": {"causality": "output", "unit": "N", "lowest": None, "highest": None},
    }


def test_the_heat_of_a_unit_is_at_the_rigs_speed_within_the_range(monkeypatch: MonkeyPatch) -> None:
    heat = SimpleNamespace(heat_capacity=1.5, thermal_conductance=0.05)
    tables: Any = SimpleNamespace(
        heat=heat, heat_partition=lambda speed: 10 * speed, rig=SimpleNamespace(sliding_speed=0.02),
        ranges=SimpleNamespace(sliding_speed=(0.03, 0.05)),
    )  # fmt: skip
    assert mock_up._heat_values(tables) == {
        "heat_partition": approx(0.3), "heat_capacity": 1.5, "thermal_conductance": 0.05,
    }  # fmt: skip
    tables.heat_partition = None
    assert mock_up._heat_values(tables) == {}
    monkeypatch.setattr(mock_up, "thermal_solid", lambda name: name)
    rig: Any = SimpleNamespace(pin_material="steel", disc_material=None)
    with running(mock_up.fmu, heat_capacity="2 J/K"):
        found = mock_up._heat(rig, None, "brass", "2 J/K", 0.1)
        assert found is not None
        assert (found.pin, found.disc, found.heat_capacity, found.thermal_conductance) == ("steel", "brass", 2.0, 0.1)  # type: ignore[comparison-overlap]
        for capacity, conductance, name in (("0 J/K", 0.1, "heat_capacity"), (1.0, 0.0, "conductance")):
            with raises(InvalidInput, match=f"^{name} must be positive$"):
                mock_up._heat(rig, None, "brass", capacity, conductance)
        with raises(InvalidInput, match=r"^heat_capacity has no meaning without the materials of pin and disc$"):
            mock_up._heat(rig, None, None, "2 J/K", 0.1)
    with running(mock_up.fmu):
        assert mock_up._heat(rig, None, None, 1.5, 0.05) is None


@pytest.mark.parametrize(
    ("has_current", "frequency", "heat", "missing", "count"),
    [
        (True, (1.0, 2.0), object(), "", 0),
        (False, (1.0, 2.0), object(), "", 1),
        (True, (22e3, 22e3), object(), "", 1),
        (True, (1.0, 2.0), None, "", 1),
        (True, (1.0, 2.0), object(), "no compiler", 1),
    ],
)
def test_what_a_unit_lacks_is_said(
    has_current: bool, frequency: tuple[float, float], heat: Any, missing: str, count: int, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(mock_up, "operating_caveats", lambda rig: ("own",))
    vibration = SimpleNamespace(vibration=SimpleNamespace(source="stated"))
    monkeypatch.setattr(mock_up, "resolved_rig", lambda rig: vibration)
    tables: Any = SimpleNamespace(has_current=has_current, ranges=SimpleNamespace(frequency=frequency), heat=heat)
    unit: Any = SimpleNamespace(missing=missing)
    study: Any = SimpleNamespace()
    answer = mock_up.UnitsAnswer(rig=UNDRIVEN, tables=tables, study=study, plant=unit, controller=unit, assumed={})
    found = answer.caveats()
    assert len(found) == 3 + count
    assert found[0] == "own"
    if frequency[0] == 22e3:
        assert found[2].startswith("the amplitude stated holds at 22 kHz only")
