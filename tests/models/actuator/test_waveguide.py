"""Bar waveguide: strains, trajectories of surface points and natural frequencies against theory and printed values."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.actuator import (
    BarWaveguide,
    axial_displacement,
    free_bar_frequency,
    in_plane_amplitude,
    normal_amplitude,
    normal_displacement,
    surface_trajectory,
)

LENGTH, THICKNESS, NU = 127e-3, 25.4e-3, 0.33
WELDER = BarWaveguide(length=LENGTH, thickness=THICKNESS, poisson_ratio=NU, axial_amplitude=8.5e-6, frequency=20e3)
PRINTED_PHASE = np.pi / 2  # of D 3.25

positions = st.floats(-LENGTH / 2, LENGTH / 2)
modes = st.sampled_from([1, 3, 5])


@pytest.mark.parametrize(("axial", "normal"), [(8.5e-6, 0.88e-6), (11.24e-6, 1.165e-6)])
def test_the_sides_of_the_welders_waveguide_vibrate_by_about_a_micrometre(axial: float, normal: float) -> None:
    assert normal_amplitude(replace(WELDER, axial_amplitude=axial)) == approx(normal, rel=0.005)


def test_two_millimetres_from_the_node_the_axial_amplitude_is_below_half_a_micrometre() -> None:
    assert in_plane_amplitude(WELDER, position=2e-3) == approx(0.42e-6, rel=0.005)


@given(time=st.floats(0, 1e-3), mode=modes)
def test_the_centre_is_a_node_of_the_axial_motion(time: float, mode: int) -> None:
    assert axial_displacement(replace(WELDER, mode=mode), position=0.0, time=time) == 0


@given(end=st.sampled_from([-LENGTH / 2, LENGTH / 2]), mode=modes)
def test_the_ends_are_free_of_strain(end: float, mode: int) -> None:
    bar = replace(WELDER, mode=mode)
    inward = end * (1 - 1e-6)
    strain = np.subtract(*(axial_displacement(bar, position=x, time=0.0) for x in (end, inward))) / (end - inward)
    assert abs(strain) < 1e-5 * bar.wave_number * bar.axial_amplitude
    assert abs(axial_displacement(bar, position=end, time=0.0)) == approx(8.5e-6)
    assert normal_displacement(bar, position=end, time=0.0, phase=0.0) == approx(0, abs=1e-20)


@given(position=st.floats(-0.06, 0.06), time=st.floats(0, 1e-4), mode=modes)
def test_the_ratio_of_lateral_to_axial_strain_is_minus_poissons_ratio(position: float, time: float, mode: int) -> None:
    bar, step = replace(WELDER, mode=mode), 1e-5
    ahead, behind = (axial_displacement(bar, position=position + h, time=time) for h in (step, -step))
    along = (ahead - behind) / (2 * step)
    # the lower surface, half a thickness below the axis, rises as the bar grows longer
    across = -normal_displacement(bar, position=position, time=time, phase=0.0) / (THICKNESS / 2)
    scale = bar.wave_number * bar.axial_amplitude
    assert across == approx(float(-NU * along), abs=1e-6 * scale)


@given(position=positions.filter(lambda x: 1e-4 < abs(x) < 0.063), mode=modes)
def test_surface_points_move_on_ellipses_at_a_lag_of_a_quarter_period(position: float, mode: int) -> None:
    bar = replace(WELDER, mode=mode)
    path = surface_trajectory(bar, position=position, phase=PRINTED_PHASE, samples=37)
    across = normal_amplitude(bar, position=position)
    along = in_plane_amplitude(bar, position=position)
    assume(min(across, along) > 1e-12)
    on_ellipse = (path.axial_displacement / along) ** 2 + (path.normal_displacement / across) ** 2
    assert on_ellipse == approx(np.ones(37))


@given(position=positions)
def test_surface_points_move_on_straight_lines_without_a_lag(position: float) -> None:
    path = surface_trajectory(WELDER, position=position, phase=0.0)
    product = path.axial_displacement * path.normal_displacement[0]
    assert product == approx(path.normal_displacement * path.axial_displacement[0], abs=1e-24)


def test_trajectories_close_after_one_period() -> None:
    path = surface_trajectory(WELDER, position=[[0.01], [0.02]], phase=PRINTED_PHASE, samples=100)
    assert path.axial_displacement.shape == (2, 1, 100)
    assert path.normal_displacement[..., -1] == approx(path.normal_displacement[..., 0], abs=1e-18)


def test_the_printed_phase_makes_the_normal_motion_a_sine() -> None:
    t = np.linspace(0, 1 / 20e3, 9)
    b = normal_amplitude(WELDER)
    printed = normal_displacement(WELDER, position=0.0, time=t, phase=PRINTED_PHASE)
    assert printed == approx(b * np.sin(2 * np.pi * 20e3 * t), abs=1e-18)


def test_the_half_wave_bar_of_the_welder_resonates_near_twenty_kilohertz() -> None:
    # aluminium bar speed sqrt(E/rho) = 5.08 km/s
    assert free_bar_frequency(length=LENGTH, wave_speed=5.08e3) == approx(20e3)
    assert free_bar_frequency(length=LENGTH, wave_speed=5.08e3, mode=3) == approx(60e3)


@pytest.mark.parametrize("mode", [2, 4, 2.5])
def test_an_even_mode_is_refused_with_its_reason(mode: int) -> None:
    with raises(InvalidInput, match=r"mode must be odd, got .*: a bar held at its centre has a node there"):
        free_bar_frequency(length=1.0, wave_speed=5e3, mode=mode)
    with raises(InvalidInput, match=r"mode must be odd"):
        replace(WELDER, mode=mode)


def test_a_position_beyond_the_end_is_refused() -> None:
    with raises(InvalidInput, match=r"position must lie between -0\.0635 and 0\.0635, got 0\.07 m"):
        axial_displacement(WELDER, position=0.07, time=0.0)


def test_a_trajectory_of_one_point_is_refused() -> None:
    with raises(InvalidInput, match=r"samples must be at least 2, got 1"):
        surface_trajectory(WELDER, position=0.0, phase=0.0, samples=1)
