"""Response curves of a rig through folds, against slow ramps by direct integration."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.charts import Line, Panel, Points
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import Backbone
from sonolube.rig import Rig, read_rig
from sonolube.rig.response_curve import (
    Jump,
    RigResponseCurve,
    response_curve_arrays,
    response_curve_chart,
    rig_response_curve,
)
from sonolube.rig.simulation import friction_point

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "contact_resonance.toml"


@pytest.fixture(scope="module")
def rig() -> Rig:
    return read_rig(RIG)


@pytest.fixture(scope="module")
def curve(rig: Rig) -> RigResponseCurve:
    return rig_response_curve(rig, along="frequency", lowest=15e3, highest=21e3)


def jump(curve: RigResponseCurve, *, is_rising: bool) -> Jump:
    (found,) = (each for each in curve.jumps if each.is_rising is is_rising)
    return found


def ramped(rig: Rig, first: float, last: float, *, periods: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequency and amplitude, period by period, of a slow ramp of the frequency from rest, by direct integration."""
    structure, load, length = rig.structure, rig.normal_load, 0.5e-6
    assert structure is not None
    assert rig.drive is not None
    assert rig.drive.voltage_peak_to_peak is not None
    inverse, size = np.linalg.inv(structure.mass_matrix), len(structure.mass_matrix)
    volts, duration = rig.drive.voltage_peak_to_peak / 2, periods / first
    rise = (last - first) / duration

    def rate(time: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        place, speed = state[:size], state[size:]
        held = min(time, duration)  # the last frequency stays
        phase = 2 * np.pi * (first * time + rise * (held * time - held**2 / 2))
        gap = structure.contact_vector @ place
        pull = structure.drive_vector * volts * np.cos(phase) - structure.damping_matrix @ speed
        pull = pull - structure.stiffness_matrix @ place + structure.contact_vector * load * np.expm1(-gap / length)
        return np.concatenate([speed, inverse @ pull])

    times = np.linspace(0.0, 1.5 * duration, 24 * int(1.5 * periods))
    found = solve_ivp(rate, (0, times[-1]), np.zeros(2 * size), method="DOP853", rtol=1e-7, atol=1e-13, t_eval=times)
    gaps = (structure.contact_vector @ found.y[:size]).reshape(-1, 24)
    frequency = first + rise * np.minimum(times.reshape(-1, 24)[:, -1], duration)
    return frequency, np.ptp(gaps, axis=1) / 2


def test_the_softening_contact_folds_the_resonance_twice(curve: RigResponseCurve) -> None:
    assert curve.complete
    assert curve.folds.size == 2
    up, down = (jump(curve, is_rising=rising) for rising in (True, False))
    assert down.at < up.at
    assert up.after > up.before
    assert down.after < down.before
    assert curve.stable[[0, -1]].all()


def test_the_backbone_passes_through_the_peak(curve: RigResponseCurve) -> None:
    peak = curve.vibration_amplitude.argmax()
    assert curve.backbone is not None
    assert curve.backbone.vibration_amplitude[-1] == approx(curve.vibration_amplitude[peak], rel=1e-3)
    assert curve.backbone.frequency[-1] == approx(curve.frequency[peak], rel=1e-3)


@pytest.mark.slow
def test_a_slow_ramp_up_by_direct_integration_jumps_where_the_curve_says(rig: Rig, curve: RigResponseCurve) -> None:
    told = jump(curve, is_rising=True)
    frequency, amplitude = ramped(rig, told.at - 150.0, told.at + 50.0, periods=1500)
    crossed = frequency[np.argmax(amplitude > (told.before + told.after) / 2)]
    assert told.at - 10.0 < crossed < told.at + 45.0
    end = np.interp(told.at + 50.0, *_upper(curve))
    assert amplitude[-40:].mean() == approx(end, rel=0.03)


def _upper(curve: RigResponseCurve) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequency and amplitude of the branch behind both folds."""
    behind = slice(int(curve.folds[-1]), None)
    return curve.frequency[behind], curve.vibration_amplitude[behind]


def test_friction_along_the_curve_is_that_of_the_rig_at_the_same_drive(rig: Rig, curve: RigResponseCurve) -> None:
    place = int(np.searchsorted(curve.frequency[: curve.folds[0]], 16.5e3))
    point = friction_point(rig.replace("drive.frequency", f"{float(curve.frequency[place])} Hz"))
    assert curve.vibration_amplitude[place] == approx(point.vibration_amplitude, rel=1e-6)
    assert curve.friction_ratio[place] == approx(point.friction_ratio, rel=1e-4)


def test_voltage_folds_where_the_frequency_has_two_stable_vibrations(rig: Rig, curve: RigResponseCurve) -> None:
    assert rig.drive is not None
    between = 17.8e3
    found = rig_response_curve(
        rig.replace("drive.frequency", f"{between} Hz"), along="voltage", lowest=5.0, highest=80.0
    )
    assert found.folds.size == 2
    volts = rig.drive.voltage_peak_to_peak
    assert volts is not None
    assert found.backbone is None
    assert jump(found, is_rising=False).at < volts < jump(found, is_rising=True).at
    crossed = np.flatnonzero(np.diff(np.sign(found.voltage_peak_to_peak - volts)))
    same = np.flatnonzero(np.diff(np.sign(curve.frequency - between)))
    assert found.vibration_amplitude[crossed] == approx(curve.vibration_amplitude[same], rel=0.1)


@pytest.mark.parametrize(
    ("changes", "arguments", "message"),
    [
        ([], {"along": "voltage", "lowest": 5.0, "highest": 5.0}, "the range must be positive and rise, got 5 to 5"),
        (["drive.waveform=square"], {"along": "voltage", "lowest": 1.0, "highest": 5.0}, "drive.waveform is square"),
    ],
)
def test_what_has_no_curve_is_refused(changes: list[str], arguments: dict[str, float], message: str) -> None:
    with raises(InvalidInput, match=message):
        rig_response_curve(read_rig(RIG, changes=changes), **arguments)  # type: ignore[arg-type]


NAN = float("nan")


def folded(**changes: Any) -> RigResponseCurve:
    """An S of six points along the frequency: up to 30 kHz, back to 20 kHz, and up again."""
    made: dict[str, Any] = {
        "along": "frequency",
        "voltage_peak_to_peak": np.full(6, 8.0),
        "frequency": 1e3 * np.array([10.0, 20.0, 30.0, 20.0, 25.0, 40.0]),
        "vibration_amplitude": 1e-6 * np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        "friction_ratio": np.array([0.9, 0.8, 0.7, 0.6, 0.5, 0.4]),
        "stable": np.array([True, True, False, False, True, True]),
        "folds": np.array([2, 3]),
        "rising": np.array([0, 1, 2, 5]),
        "falling": np.array([0, 4, 5]),
        "backbone": None,
        "complete": True,
    }
    return RigResponseCurve(**made | changes)


def parts_of(panel: Panel) -> dict[str, Line]:
    return {part.label: part for part in panel.parts if isinstance(part, Line)}


def test_a_branch_is_drawn_stable_and_unstable_without_a_gap_with_the_jumps_of_both_ramps(rig: Rig) -> None:
    above, below = response_curve_chart(rig, folded()).panels
    lines = parts_of(above)
    assert list(lines) == ["stable", "unstable", "jump of a slow ramp up", "jump of a slow ramp down"]
    assert lines["stable"].x == approx([10, 20, 30, 20, 25, 40])
    assert lines["stable"].y == approx([1, 2, NAN, NAN, 5, 6], nan_ok=True)
    assert lines["unstable"].y == approx([NAN, 2, 3, 4, 5, NAN], nan_ok=True)
    assert (lines["stable"].dash, lines["unstable"].dash) == (0, 1)
    # up from the third point to the last, down from the fifth to the first
    up, down = lines["jump of a slow ramp up"], lines["jump of a slow ramp down"]
    assert up.x == approx([30, 30, NAN], nan_ok=True)
    assert up.y == approx([3, 6, NAN], nan_ok=True)
    assert down.x == approx([25, 25, NAN], nan_ok=True)
    assert down.y == approx([5, 1, NAN], nan_ok=True)
    landed = [part for part in above.parts if isinstance(part, Points)]
    assert [(float(each.x[0]), float(each.y[0])) for each in landed] == [approx((30, 6)), approx((25, 1))]
    assert [(each.colour, each.marker) for each in landed] == [(1, 0), (2, 1)]
    assert (up.colour, down.colour) == (1, 2)
    assert (above.x.label, above.x.unit, above.x.lowest, above.x.highest) == ("Frequency", "kHz", 10.0, 40.0)
    assert parts_of(below)["stable"].y == approx([0.9, 0.8, NAN, NAN, 0.5, 0.4], nan_ok=True)


def test_a_branch_without_folds_or_friction_has_one_panel_and_the_backbone_within_its_range(rig: Rig) -> None:
    backbone = Backbone(frequency=np.array([5e3, 10e3, 40e3, 41e3]), vibration_amplitude=1e-6 * np.arange(1.0, 5.0))
    plain = folded(
        stable=np.ones(6, dtype=bool),
        rising=np.arange(6),
        falling=np.arange(6),
        friction_ratio=np.full(6, NAN),
        backbone=backbone,
    )
    (panel,) = response_curve_chart(rig, plain).panels
    lines = parts_of(panel)
    assert list(lines) == ["backbone", "stable"]
    assert lines["backbone"].x == approx([10, 40])
    assert lines["backbone"].y == approx([2, 3])
    volts = folded(along="voltage", voltage_peak_to_peak=np.array([0.0, 2.0, 4.0, 3.0, 5.0, 9.0]))
    axis = response_curve_chart(rig, volts).panels[0].x
    assert (axis.unit, axis.lowest, axis.highest) == ("V", 0.0, 9.0)


def test_jumps_are_told_up_first_each_from_where_its_ramp_leaves_the_branch() -> None:
    up, down = folded().jumps
    assert (up.is_rising, down.is_rising) == (True, False)
    assert (up.at, up.before, up.after) == approx((30e3, 3e-6, 6e-6))
    assert (down.at, down.before, down.after) == approx((25e3, 5e-6, 1e-6))


def test_arrays_of_a_branch_have_a_row_to_a_point_with_its_stability_in_words(rig: Rig) -> None:
    arrays = response_curve_arrays(rig, folded())
    assert arrays.variables["stability"].values.tolist() == [
        "stable",
        "stable",
        "unstable",
        "unstable",
        "stable",
        "stable",
    ]
    assert arrays.variables["frequency"].values == approx(folded().frequency)
    assert arrays.variables["vibration_amplitude"].attrs["units"] == "m"
    assert all(each.dims == ("point",) for each in arrays.variables.values())
