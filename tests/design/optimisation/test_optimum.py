"""Optimisation against closed forms, brute force, finite differences, and the linear structure."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.charts import Note, Points
from sonolube.design.optimisation import (
    DEFAULT_MAXIMUM_SWING,
    Candidate,
    DesignProblem,
    DesignSpace,
    HalfWaveHorn,
    Limits,
    Tolerance,
    candidate_rig,
    design_point_at,
    design_rig,
    deviations,
    enumerate_candidates,
    estimate_swings,
    evaluate,
    maximum_swing,
    optimise,
    refine_swing,
    required_electronics,
    swing_sensitivities,
)
from sonolube.design.optimisation.design_output import front_chart
from sonolube.errors import InvalidInput, OutsideRange, UnknownName
from sonolube.models.actuator import PreloadBolt, catalogue_actuator, catalogue_names
from sonolube.rig import Rig, least_power_study, point_batch, read_rig, rig_content, structure_entries
from sonolube.rig.driven_rig import driven_rig

FILE = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
RIG = driven_rig(read_rig(FILE, changes=["vibration.amplitude_source=computed"]))
ENTRIES = structure_entries(rig_content(FILE))
CATALOGUE = {name: catalogue_actuator(name) for name in catalogue_names()}
RATIO = 0.44


def space(**changes: object) -> DesignSpace:
    return DesignSpace(
        **({"rig": RIG, "entries": ENTRIES, "frequencies": (20e3, 24e3), "catalogue": CATALOGUE} | changes)  # type: ignore[arg-type]
    )


def friction_of(rig: Rig, frequency: float, swing: float) -> float:
    found = point_batch(rig, frequency=[frequency], voltage_peak_to_peak=[swing], voltage_offset=[swing / 2])
    return float(found.numbers["friction_ratio"][0])


def test_the_tip_mass_of_least_voltage_is_that_of_the_resonance() -> None:
    # least voltage at one frequency: |k - m w^2 + i w c| is least at m = k/w^2, the contact's 1.5 MN/m on top of 2 GN/m
    heavy = ENTRIES | {"reaction_mass": 1e5, "arm_stiffness": 1.0, "arm_damping": 0.0, "tip_damping": 300.0}
    f = 22e3
    narrow = space(entries=heavy, frequencies=(f, f * (1 + 1e-7)), ranges={"tip_mass": (0.08, 0.15)})
    best = optimise(DesignProblem(space=narrow, friction_ratio=RATIO), minimise="voltage").best
    assert best.candidate.entries["tip_mass"] == approx(2.0015e9 / (2 * np.pi * f) ** 2, rel=1e-3)


def test_no_frequency_of_a_dense_grid_needs_less_power() -> None:
    found = optimise(DesignProblem(space=space(), friction_ratio=RATIO))
    brute = least_power_study(RIG, frequency=np.linspace(20e3, 24e3, 321), friction_ratio=RATIO)
    least = float(np.nanmin(brute["power_to_supply"].values))
    power = found.best.objective("power")
    assert power <= least * (1 + 2e-4)
    assert power == approx(least, rel=5e-3)
    assert friction_of(RIG, found.best.frequency, found.best.voltage_peak_to_peak) == approx(RATIO, abs=1e-6)


def test_designs_are_ranked_by_the_power_to_supply_not_by_the_charge_of_the_capacitance() -> None:
    # at resonance the capacitance takes least and the motion most: the two rankings differ
    f = np.array([20.7e3, 22e3])
    swings = estimate_swings(RIG, Limits(), frequency=f, friction_ratio=RATIO)
    found = evaluate(RIG, Limits(), frequency=f, voltage_peak_to_peak=swings)
    charge, heat = (found.quantities[name] for name in ("charging_power", "dissipated_power"))
    assert charge[1] < charge[0]
    assert heat[1] > heat[0]
    assert found.objectives["power"] == approx(np.maximum(charge, heat))
    best = optimise(DesignProblem(space=space(), friction_ratio=RATIO)).best
    assert best.objective("power") < found.objectives["power"][1]


@pytest.mark.slow
def test_no_structure_of_a_dense_grid_generates_less_heat() -> None:
    wide = space(ranges={"tip_mass": (0.09, 0.13), "reaction_mass": (1.0, 4.0)})
    problem = DesignProblem(space=wide, friction_ratio=RATIO)
    found = optimise(problem, minimise="heat", samples=4).best.objective("heat")
    for tip in (0.1, 0.12):
        for reaction in (1.5, 3.5):
            rig = candidate_rig(
                wide, Candidate(actuator="own", waveform="sine", entries={"tip_mass": tip, "reaction_mass": reaction})
            )
            f = np.linspace(20e3, 24e3, 60)
            volts = estimate_swings(rig, Limits(), frequency=f, friction_ratio=RATIO)
            reached = np.isfinite(volts)
            brute = evaluate(rig, Limits(), frequency=f[reached], voltage_peak_to_peak=volts[reached])
            assert found <= brute.objectives["heat"].min() * (1 + 2e-3)


@pytest.mark.parametrize("frequency", [21.3e3, 22.6e3])
def test_the_sensitivities_of_the_voltage_at_constant_friction_are_its_finite_differences(frequency: float) -> None:
    wide = space(ranges={"tip_mass": (0.05, 0.2), "tip_damping": (100.0, 1000.0)})
    problem = DesignProblem(space=wide, friction_ratio=RATIO)
    candidate = Candidate(actuator="own", waveform="sine", entries={"tip_mass": 0.11, "tip_damping": 700.0})
    point = design_point_at(problem, candidate, frequency=frequency, near=40.0)
    assert point is not None
    slopes = swing_sensitivities(problem, point)
    for name in ("frequency", "tip_mass", "tip_damping"):
        ends = []
        for side in (-1, 1):
            factor = np.exp(side * 1e-3)
            f = frequency * (factor if name == "frequency" else 1)
            entries = {key: value * (factor if key == name else 1) for key, value in candidate.entries.items()}
            rig = candidate_rig(wide, replace(candidate, entries=entries))
            ends.append(refine_swing(rig, frequency=f, friction_ratio=RATIO, near=40.0, highest=190.0))
        assert slopes[name] == approx(np.log(ends[1] / ends[0]) / 2e-3, rel=0.01, abs=0.01)


def test_a_drive_that_no_limit_bounds_is_tried_up_to_the_default_maximum() -> None:
    below = replace(RIG.drive, voltage_offset=-20.0, voltage_peak_to_peak=28.0)  # never above zero
    rig = replace(RIG, drive=below, stack=replace(RIG.stack, highest_voltage=100.0))
    assert maximum_swing(rig, Limits()) == approx(DEFAULT_MAXIMUM_SWING)


def test_small_drives_have_the_amplitude_current_tension_and_heat_of_the_linear_chain() -> None:
    f, swing = 21.5e3, 0.02
    found = evaluate(RIG, Limits(), frequency=[f], voltage_peak_to_peak=[swing])
    m1, m2, m3 = ENTRIES["tip_mass"], ENTRIES["reaction_mass"] + 0.07, ENTRIES["arm_mass"]
    s = 2j * np.pi * f
    stack, arm = 2e9 + 30.0 * s, ENTRIES["arm_stiffness"] + ENTRIES["arm_damping"] * s
    contact = 3.0 / 2e-6 + ENTRIES["tip_damping"] * s
    dynamic = np.array(
        [[m1 * s**2 + stack + contact, -stack, 0], [-stack, m2 * s**2 + stack + arm, -arm], [0, -arm, m3 * s**2 + arm]]
    )
    push = 8.68e-9 * 2e9 * swing / 2
    x = np.linalg.solve(dynamic, np.array([-push, push, 0]))
    e = x[1] - x[0]
    clamped = 360e-9 - 8.68e-9**2 * 2e9
    current = s * (clamped * swing / 2 + 8.68e-9 * 2e9 * e)
    assert found.quantities["vibration_amplitude"][0] == approx(abs(x[0]), rel=1e-4)
    assert found.quantities["peak_current"][0] == approx(abs(current), rel=1e-4)
    assert found.quantities["dynamic_tension"][0] == approx(abs(push - stack * e), rel=1e-4)
    dielectric, dissipated = np.pi / 4 * f * 360e-9 * 0.02 * swing**2, (swing / 2 * current.conjugate()).real / 2
    assert found.objectives["heat"][0] == approx(dissipated + dielectric, rel=1e-4)
    assert found.quantities["charging_power"][0] == approx(360e-9 * swing**2 * f)  # D 1.9
    assert found.quantities["apparent_power"][0] == approx(swing / 2 * abs(current) / 2, rel=1e-4)
    assert found.objectives["power"][0] == approx(max(360e-9 * swing**2 * f, dissipated), rel=1e-4)


def test_the_utilisation_of_every_limit_is_demand_over_limit() -> None:
    bolt = PreloadBolt(thread_diameter=0.01, length=0.06, youngs_modulus=205e9, yield_strength=640e6, preload=12e3)
    pressed = space(bolt=bolt)
    rig = candidate_rig(pressed, Candidate(actuator="own", waveform="sine", entries={}))
    limits = Limits(
        voltage_maximum=60.0,
        current_maximum=10.0,
        slew_rate_maximum=5e6,
        nominal_pressure=20e6,
        temperature_rise=50.0,
        thermal_conductance=2.0,
        horn=HalfWaveHorn(density=2780.0, youngs_modulus=73e9, stress_limit=60e6),
    )
    found = evaluate(rig, limits, frequency=[21e3], voltage_peak_to_peak=[30.0], bolt=bolt)
    quantities = {name: float(values[0]) for name, values in found.quantities.items()}
    utilisation = {name: float(values[0]) for name, values in found.utilisation.items()}
    assert utilisation["voltage"] == approx(0.5)
    assert utilisation["slew_rate"] == approx(2 * np.pi * 21e3 * 15 / 5e6)
    assert utilisation["current"] == approx(quantities["peak_current"] / 10)
    assert utilisation["tension"] == approx(quantities["dynamic_tension"] / 12e3)
    assert utilisation["temperature"] == approx(quantities["heat_rate"] / 2 / 50)
    speed = 2 * np.pi * 21e3 * quantities["vibration_amplitude"]
    assert utilisation["horn_stress"] == approx(2780 * np.sqrt(73e9 / 2780) * speed / 60e6)
    stress = 205e9 * quantities["elongation"] / 0.06
    assert utilisation["bolt_fatigue"] == approx(1.2 * stress / bolt.endurance_limit)
    assert found.maximum_utilisation[0] == approx(max(utilisation.values()))


def test_a_pareto_front_trades_one_objective_for_the_other_between_their_optima() -> None:
    some = space(actuators=("own", "nac2023"), ranges={"tip_mass": (0.1, 0.3)})
    problem = DesignProblem(space=some, friction_ratio=RATIO)
    found = optimise(problem, minimise="power", second_objective="voltage", samples=4)
    values = np.array([[point.objective("power"), point.objective("voltage")] for point in found.front])
    assert np.all(np.diff(values[:, 0]) > 0)
    assert np.all(np.diff(values[:, 1]) < 0)
    assert values[0, 0] == approx(found.best.objective("power"), rel=1e-3)
    assert values[-1, 1] <= found.screening.objectives["voltage"][found.screening.feasible].min() * 1.01
    (panel,) = front_chart(found).panels
    families = [part for part in panel.parts if isinstance(part, Points) and not part.is_faint]
    assert sorted(np.concatenate([family.x for family in families])) == approx(values[:, 0])
    assert {family.label for family in families} <= {"own, sine", "nac2023, sine"}
    ends = [(part.x, part.y) for part in panel.parts if isinstance(part, Note)]
    assert ends == [tuple(values[0]), tuple(values[-1])]


def test_a_voltage_limit_below_the_optimum_becomes_active_or_infeasible() -> None:
    wide = space(ranges={"tip_damping": (650.0, 1200.0)}, frequencies=(21e3, 21.5e3))
    free = optimise(DesignProblem(space=wide, friction_ratio=RATIO), minimise="power").best
    top = 1.0005 * free.voltage_peak_to_peak
    bound = optimise(DesignProblem(space=wide, friction_ratio=RATIO, limits=Limits(voltage_maximum=top))).best
    assert bound.voltage_peak_to_peak <= top
    with raises(OutsideRange, match="no design brings friction down"):
        optimise(DesignProblem(space=wide, friction_ratio=RATIO, limits=Limits(voltage_maximum=0.5 * top)))
    with raises(OutsideRange, match=r"violates current, .* times what is allowed"):
        optimise(DesignProblem(space=wide, friction_ratio=RATIO, limits=Limits(current_maximum=0.1)))


def test_a_robust_design_reaches_the_target_at_every_corner_for_more_power() -> None:
    tolerance = Tolerance(manufacturing_tolerance=0.02)
    problem = DesignProblem(space=space(), friction_ratio=RATIO, tolerance=tolerance)
    robust, nominal = optimise(problem).best, optimise(DesignProblem(space=space(), friction_ratio=RATIO)).best
    frictions = [
        friction_of(candidate_rig(problem.space, robust.candidate, each), robust.frequency, robust.voltage_peak_to_peak)
        for each in deviations(tolerance)
    ]
    assert max(frictions) == approx(RATIO, abs=1e-5)
    assert robust.objective("power") > nominal.objective("power")
    off = [
        friction_of(
            candidate_rig(problem.space, nominal.candidate, each), nominal.frequency, nominal.voltage_peak_to_peak
        )
        for each in deviations(tolerance)
    ]
    assert max(off) > RATIO + 0.05


def test_every_matching_network_has_its_band_about_the_drive_frequency() -> None:
    problem = DesignProblem(space=space(), friction_ratio=RATIO)
    candidate = Candidate(actuator="own", waveform="sine", entries={})
    point = design_point_at(problem, candidate, frequency=21.5e3, near=40.0)
    assert point is not None
    found = required_electronics(problem, point, source_resistance=50.0)
    assert [each.name for each in found.networks] == ["parallel inductor", "series inductor", "L network"]
    assert all(each.band[0] < 21.5e3 < each.band[1] for each in found.networks)
    assert found.amplifier.peak_current == approx(float(point.evaluation.quantities["peak_current"][0]), rel=1e-9)
    assert found.amplifier.power_factor < 1
    driven = design_rig(problem, point)
    assert driven.drive.voltage_offset == approx(point.voltage_peak_to_peak / 2)


def test_candidates_combine_every_actuator_and_waveform_with_corners_and_samples() -> None:
    some = space(actuators=("own", "nac2023"), waveforms=("sine", "triangle"), ranges={"tip_mass": (0.1, 0.2)})
    found = enumerate_candidates(some, samples=4)
    assert len(found) == 2 * 2 * (2 + 4)
    assert {0.1, 0.2} <= {round(candidate.entries["tip_mass"], 12) for candidate in found}


def test_an_invalid_design_space_is_refused_with_the_name_of_the_entry() -> None:
    with raises(UnknownName, match="unknown entry of structure 'tip_mas'; did you mean tip_mass"):
        space(ranges={"tip_mas": (0.1, 0.2)})
    with raises(UnknownName, match="unknown actuator 'sa05'"):
        space(actuators=("sa05",))
    with raises(InvalidInput, match="a range must increase from above 0"):
        space(frequencies=(2e4, 1e4))
    with raises(UnknownName, match="unknown objective 'cost'"):
        optimise(DesignProblem(space=space(), friction_ratio=RATIO), minimise="cost")
    with raises(OutsideRange, match="no actuator makes a rig: apa40sm: its source prints no blocked_force"):
        optimise(DesignProblem(space=space(actuators=("apa40sm",)), friction_ratio=RATIO))
