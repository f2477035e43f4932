"""Limits of the drive voltage hold its magnitude, also about a negative offset."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from pytest import approx

from sonolube.design.test_plan.candidates import Factors, RigLimits, candidate_tests
from sonolube.design.test_plan.plan import Procedure, Question, plan_tests
from sonolube.design.test_plan.run_protocols import run_protocols
from sonolube.prediction.inputs import rig_inputs
from sonolube.rig import Rig, read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml")


def biased(offset_ratio: float) -> Rig:
    """Rig whose drive oscillates about a bias in proportion to its swing."""
    assert RIG.drive is not None
    assert RIG.drive.voltage_peak_to_peak is not None
    return replace(RIG, drive=replace(RIG.drive, voltage_offset=offset_ratio * RIG.drive.voltage_peak_to_peak))


def factors(rig: Rig) -> Factors:
    """Factors of one load and speed, and four amplitudes up to that of the rig."""
    top = rig_inputs(rig).amplitude.value
    return Factors(
        normal_load=np.array([5.0]), sliding_speed=np.array([0.0655]), vibration_amplitude=top * np.arange(1, 5) / 4
    )


def test_tests_beyond_the_voltage_are_refused_whatever_the_sign_of_the_bias() -> None:
    rig = biased(-0.7)
    inputs = rig_inputs(rig)
    swing = np.arange(1, 5) / 4 * (inputs.voltage_peak_to_peak or 0.0)
    reached = (0.7 + 0.5) * swing  # the trough lies this far from zero
    found = candidate_tests(rig, inputs, factors(rig), limits=RigLimits(voltage_maximum=float(reached[1])))
    by_swing = dict(zip(np.round(found.voltage_peak_to_peak, 6), found.refused, strict=True))
    assert [bool(by_swing[each]) for each in np.round(swing, 6)] == [False, False, True, True]


def test_protocols_allow_the_trough_of_a_drive_of_negative_bias() -> None:
    plan = plan_tests(
        rig := biased(-0.7),
        factors(rig),
        question=Question(),
        procedure=Procedure(intrinsic_distance=1.0, vibrated_distance=1.0),
        points=2,
    )
    swing = max(plan.candidates.voltage_peak_to_peak[list(plan.batch.points)])
    for protocol in run_protocols(plan).values():
        assert protocol.limits.voltage_maximum >= 1.2 * swing
        assert protocol.limits.voltage_maximum == approx(1.2 * swing, rel=0.2)


def test_the_limit_of_the_force_is_three_times_dry_friction_rounded_up_to_three_digits() -> None:
    rig = replace(RIG, friction_coefficient=0.4251)
    plan = plan_tests(
        rig,
        factors(rig),
        question=Question(),
        procedure=Procedure(intrinsic_distance=1.0, vibrated_distance=1.0),
        points=1,
    )
    for protocol in run_protocols(plan).values():  # 3 x 0.4251 x 5 N = 6.3765 N
        assert protocol.limits.friction_force_maximum == approx(6.38, abs=1e-12)
