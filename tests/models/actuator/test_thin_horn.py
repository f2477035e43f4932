"""Closed forms of thin horns against each other and against numerical integration of the equation of the bar."""

from collections.abc import Callable

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.errors import InvalidInput
from sonolube.models.actuator import ThinHorn, thin_conical_horn, thin_exponential_horn, thin_stepped_horn

F, C = 20e3, 5000.0
K = 2 * np.pi * F / C
R, R1 = 0.02, 0.008


def integrated(radius: Callable[[float], float], length: float) -> tuple[float, float, float]:
    """Return strain at the far end over k u there, gain and node of (S u')' + k^2 S u = 0 from a free end."""

    def slope(x: float, state: np.ndarray) -> list[float]:
        area = radius(x) ** 2
        return [state[1] / area, -(K**2) * area * state[0]]

    run = solve_ivp(
        slope, (0, length), [1.0, 0.0], rtol=1e-10, atol=1e-12, max_step=length / 400, events=lambda _x, u: u[0]
    )
    u, force = run.y[:, -1]
    return force / radius(length) ** 2 / (K * u), abs(u), float(run.t_events[0][0])


@pytest.mark.parametrize(
    ("horn", "radius"),
    [
        (
            thin_conical_horn(radius=R, end_radius=R1, frequency=F, wave_speed=C),
            lambda length: lambda x: R + (R1 - R) * x / length,
        ),
        (
            thin_exponential_horn(radius=R, end_radius=R1, frequency=F, wave_speed=C),
            lambda length: lambda x: R * (R1 / R) ** (x / length),
        ),
    ],
    ids=["conical", "exponential"],
)
def test_tapered_horns_solve_the_equation_of_the_bar(
    horn: ThinHorn, radius: Callable[[float], Callable[[float], float]]
) -> None:
    strain, gain, node = integrated(radius(horn.length), horn.length)
    assert strain == approx(0.0, abs=1e-6)
    assert horn.displacement_gain == approx(gain, rel=1e-6)
    assert horn.node_position == approx(node, rel=1e-6)


@pytest.mark.parametrize("end_length", [0.04, 0.0625, 0.09])
def test_a_stepped_horn_solves_the_equation_of_the_bar_for_any_length_of_its_thin_part(end_length: float) -> None:
    horn = thin_stepped_horn(radius=R, end_radius=R1, end_length=end_length, frequency=F, wave_speed=C)
    u, force = np.cos(K * horn.length), -K * R**2 * np.sin(K * horn.length)
    far = u * np.cos(K * end_length) + force / (K * R1**2) * np.sin(K * end_length)
    far_force = force * np.cos(K * end_length) - K * R1**2 * u * np.sin(K * end_length)
    assert far_force / (K * R**2) == approx(0.0, abs=1e-12)
    assert horn.displacement_gain == approx(abs(far))
    whole = horn.length + end_length
    place = horn.node_position
    motion = np.cos(K * place) if place <= horn.length else far * np.cos(K * (whole - place))
    assert motion == approx(0.0, abs=1e-9)


def test_the_gain_of_two_quarter_waves_is_the_ratio_of_areas() -> None:
    horn = thin_stepped_horn(radius=R, end_radius=R1, end_length=C / F / 4, frequency=F, wave_speed=C)
    assert horn.length == approx(C / F / 4)
    assert horn.displacement_gain == approx((R / R1) ** 2)


@pytest.mark.parametrize("horn", [thin_conical_horn, thin_exponential_horn])
def test_a_horn_of_equal_radii_is_a_half_wave_bar(horn: Callable[..., ThinHorn]) -> None:
    bar = horn(radius=R, end_radius=R, frequency=F, wave_speed=C)
    assert bar.length == approx(C / (2 * F))
    assert bar.displacement_gain == approx(1.0)
    assert bar.node_position == approx(bar.length / 2)


def test_impossible_horns_are_refused() -> None:
    with raises(InvalidInput, match="end_radius"):
        thin_conical_horn(radius=R1, end_radius=R, frequency=F, wave_speed=C)
    with raises(InvalidInput, match="end_length must be below half a wavelength"):
        thin_stepped_horn(radius=R, end_radius=R1, end_length=0.2, frequency=F, wave_speed=C)
