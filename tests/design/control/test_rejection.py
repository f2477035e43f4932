"""Rejection of a step of friction against the recursion of the sampled loop."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.charts import Line, Panel, Rule
from sonolube.design.control import (
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    VibrationMode,
    disturbance_rejection,
    tuned_controller,
)
from sonolube.design.control.rejection import rejection_chart
from sonolube.errors import InvalidInput
from sonolube.rig import AMPLITUDE
from sonolube.rig.operating_conditions import CommandedQuantity

LINE = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))
MODE = VibrationMode(
    natural_frequency=22e3, damping_ratio=0.02, motional_conductance=0.4, parallel_capacitance=2e-7, frequency=22e3
)
PROCESS = Process(time_constant=MODE.time_constant, dead_time=1e-3, sample_interval=2e-4)
TARGET = 1.2


def loop(level_maximum: float = 50.0) -> FrictionLoop:
    controller = tuned_controller(LINE, PROCESS, level_maximum=level_maximum)
    return FrictionLoop(plant=LINE, mode=MODE, controller=controller, tracker=None, level_maximum=level_maximum)


@pytest.mark.parametrize("step", [0.1, -0.2])
def test_the_deviation_obeys_the_recursion_of_the_loop(step: float) -> None:
    # SIMC cancels the lag: L = T/(tau_c + theta) z^-d/(z - 1), tau_c = theta; friction is (1 + step) times the command.
    # So the deviation y[n] is step * target less (1 + step) T/(2 theta) times the sum of y up to n - 1 - d.
    found = disturbance_rejection(loop(), friction_force=TARGET, friction_step=step, duration=0.2)
    after = found.run.friction_force[found.run.time >= found.start_time - 1e-9] - TARGET
    gain, dead = (1 + step) * PROCESS.sample_interval / (2 * PROCESS.effective_dead_time), PROCESS.dead_time_samples
    expected = np.empty(after.size)
    for n in range(after.size):
        expected[n] = step * TARGET - gain * expected[: max(n - dead, 0)].sum()
    assert after == approx(expected, abs=1e-9)
    assert found.peak_deviation == approx(abs(step) * TARGET, rel=1e-9)
    outside = np.flatnonzero(np.abs(expected) > 0.05 * abs(step) * TARGET)
    assert found.recovery_time == approx((outside[-1] + 1) * PROCESS.sample_interval)


def test_a_step_beyond_what_vibration_takes_away_never_recovers() -> None:
    found = disturbance_rejection(loop(), friction_force=0.6, friction_step=0.5, duration=0.1)
    assert found.recovery_time is None
    assert found.run.level[-1] == approx(50.0)
    assert found.run.friction_force[-1] == approx(0.75)  # 1.5 times the least of the line


@pytest.mark.parametrize("step", [0.0, -1.0, 20.0, float("nan")])
def test_a_step_that_is_none_is_refused(step: float) -> None:
    with raises(InvalidInput, match="friction_step"):
        disturbance_rejection(loop(), friction_force=TARGET, friction_step=step, duration=0.1)


def chart_of(quantity: CommandedQuantity, *, start: float = 0.0) -> tuple[Panel, Panel]:
    """Panels of a run of 0.4 s whose friction steps at 0.2 s, with an effective dead time of 1.55 ms."""
    time = start + 1e-3 * np.arange(400)
    run = SimpleNamespace(time=time, friction_force=1.0 + time, level=2e-6 * (1.0 + time))
    rejection: Any = SimpleNamespace(run=run, start_time=0.2)
    process = SimpleNamespace(effective_dead_time=1.55e-3)
    study: Any = SimpleNamespace(
        plant=SimpleNamespace(quantity=quantity),
        controller=SimpleNamespace(process=process),
        friction_force=1.25,
        level_maximum=5e-6,
        limit="voltage",
    )
    friction, drive = rejection_chart(study, rejection).panels
    return friction, drive


def test_the_step_is_drawn_from_ten_dead_times_before_it_to_sixty_behind_in_milliseconds() -> None:
    friction, drive = chart_of(AMPLITUDE)
    found, target = friction.parts
    assert isinstance(found, Line)
    assert isinstance(target, Line)
    assert (found.x[0], found.x[-1], found.x.size) == approx((-15.0, 93.0, 109))
    assert found.y == approx(1.2 + 1e-3 * found.x)
    assert target.x == approx(found.x)
    assert target.y == approx(np.full(109, 1.25))
    assert (friction.x.lowest, friction.x.highest) == approx((-15.5, 93.0))
    assert friction.x.unit == "ms"
    level, limit = drive.parts
    assert isinstance(level, Line)
    assert isinstance(limit, Rule)
    assert level.y == approx(2.4 + 2e-3 * found.x)  # um
    assert limit.value == approx(5.0)
    assert (limit.label, limit.along) == ("voltage limit", "y")
    assert (drive.y.lowest, drive.y.highest) == approx((0.0, 1.12 * 5.0))


def test_the_chart_ends_where_the_run_does() -> None:
    friction, _ = chart_of(AMPLITUDE, start=0.195)
    assert friction.x.lowest == approx(-5.0)
    friction, _ = chart_of(AMPLITUDE, start=-0.15)
    assert friction.x.highest == approx(49.0)
