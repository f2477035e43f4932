"""Stick-slip of a pulled mass with LuGre friction: rigid Coulomb stick-slip, another integrator, the authors' case."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.errors import InvalidInput
from sonolube.models.friction import Holder, LuGreFriction, SlidingKind, lugre_stick_slip

# the values of Canudas de Wit et al. (1995), table I, and of the simulation of their section III B
S_0, S_1, S_2, F_C, F_S, V_S = 1e5, np.sqrt(1e5), 0.4, 1.0, 1.5, 0.001
PUBLISHED = LuGreFriction(
    coulomb_friction_force=F_C,
    static_friction_force=F_S,
    stribeck_velocity=V_S,
    bristle_stiffness=S_0,
    bristle_damping=S_1,
    viscous_coefficient=S_2,
)
DRIVE, SPEED = Holder(holder_stiffness=2.0, holder_mass=1.0), 0.1


@pytest.mark.parametrize(("stiffness", "mass", "speed"), [(2.0, 1.0, 0.1), (20.0, 0.5, 0.05), (2.0, 1.0, 0.5)])
def test_stiff_bristles_have_the_closed_form_of_rigid_coulomb_stick_slip(
    stiffness: float, mass: float, speed: float
) -> None:
    law = replace(
        PUBLISHED,
        stribeck_velocity=1e-4,
        bristle_stiffness=1e8,
        bristle_damping=2 * np.sqrt(1e8 * mass),
        viscous_coefficient=0.0,
    )
    drop, omega = F_S - F_C, np.sqrt(stiffness / mass)
    # sticking from F_c - drop to F_s at the rate K v; then a free oscillation about F_c until the mass rests
    breakaway = F_S / (stiffness * speed)
    period = 2 * drop / (stiffness * speed) + 2 / omega * (np.pi - np.arctan(drop * omega / (stiffness * speed)))
    found = lugre_stick_slip(
        law, Holder(holder_stiffness=stiffness, holder_mass=mass), sliding_speed=speed, duration=breakaway + 4 * period
    )
    assert found.kind is SlidingKind.STICK_SLIP
    assert found.period == approx(period, rel=2e-3)
    assert found.first_slip_time == approx(breakaway + np.arctan(stiffness * speed / (drop * omega)) / omega, rel=2e-3)
    assert found.peak_friction_force == approx(F_S, rel=3e-3)
    assert found.peak_spring_force == approx(F_C + np.hypot(drop, np.sqrt(stiffness * mass) * speed), rel=2e-3)
    assert found.peak_velocity == approx(speed + np.hypot(speed, drop / np.sqrt(stiffness * mass)), rel=2e-3)


def test_the_published_stick_slip_is_that_of_another_integrator() -> None:
    def rates(_: float, state: np.ndarray) -> list[float]:
        y, x, w, z = state  # pulled end, mass, its velocity, bristles
        g = (F_C + (F_S - F_C) * np.exp(-((w / V_S) ** 2))) / S_0
        bristles = w - abs(w) * z / g
        return [SPEED, w, 2.0 * (y - x) - S_0 * z - S_1 * bristles - S_2 * w, bristles]

    def mass_overtakes(_: float, state: np.ndarray) -> float:
        return float(state[2] - SPEED)

    mass_overtakes.direction = 1  # type: ignore[attr-defined]
    other = solve_ivp(
        rates, (0, 30), [0.0] * 4, method="Radau", events=mass_overtakes, rtol=1e-7, atol=1e-10, max_step=0.05
    )
    slips = other.t_events[0]
    found = lugre_stick_slip(PUBLISHED, DRIVE, sliding_speed=SPEED, duration=30.0)
    assert found.first_slip_time == approx(slips[0], rel=1e-4)
    assert found.period == approx(slips[-1] - slips[-2], rel=1e-4)
    assert found.peak_spring_force == approx(2.0 * (other.y[0] - other.y[1])[other.t > slips[-2]].max(), rel=1e-3)
    assert found.peak_velocity == approx(other.y[2][other.t > slips[-2]].max(), rel=1e-3)


def test_the_published_case_first_slips_when_the_spring_has_reached_the_static_force() -> None:
    # the pulled end moves at 0.1 m/s and the spring has 2 N/m, so that 1.5 N is reached after 7.5 s
    found = lugre_stick_slip(PUBLISHED, DRIVE, sliding_speed=SPEED, duration=30.0)
    assert found.kind is SlidingKind.STICK_SLIP
    assert 7.5 < found.first_slip_time < 7.8
    assert found.peak_friction_force == approx(F_S, rel=0.02)


def test_work_of_the_pull_goes_into_spring_mass_and_friction() -> None:
    found = lugre_stick_slip(PUBLISHED, DRIVE, sliding_speed=SPEED, duration=20.0, samples=200_001)
    supplied = np.trapezoid(found.spring_force * SPEED, found.time)
    rubbed = np.trapezoid(found.friction_force * found.velocity, found.time)
    stored = found.spring_force[-1] ** 2 / (2 * 2.0) + found.velocity[-1] ** 2 / 2
    assert supplied == approx(rubbed + stored, rel=1e-4)


def test_a_stiff_damped_drive_slides_steadily_with_the_steady_friction() -> None:
    found = lugre_stick_slip(
        PUBLISHED, Holder(holder_stiffness=2e4, holder_mass=1.0, holder_damping=50.0), sliding_speed=SPEED, duration=4.0
    )
    assert found.kind is SlidingKind.STEADY_SLIDING
    assert np.isnan(found.period)
    assert found.peak_spring_force == approx(F_C + S_2 * SPEED, rel=1e-3)


def test_stick_slip_in_which_the_force_varies_by_less_than_one_per_cent_is_no_steady_sliding() -> None:
    drop, stiffness, mass, speed = 0.004, 200.0, 0.01, 1e-3
    law = replace(
        PUBLISHED,
        static_friction_force=F_C + drop,
        stribeck_velocity=3e-6,
        bristle_stiffness=1e10,
        bristle_damping=2 * np.sqrt(1e10 * mass),
        viscous_coefficient=0.0,
    )
    # rigid Coulomb friction with a static limit, as above
    omega, rate = np.sqrt(stiffness / mass), stiffness * speed
    period = 2 * drop / rate + 2 / omega * (np.pi - np.arctan(drop * omega / rate))
    found = lugre_stick_slip(
        law, Holder(holder_stiffness=stiffness, holder_mass=mass), sliding_speed=speed, duration=7.0
    )
    assert found.kind is SlidingKind.STICK_SLIP
    assert found.period == approx(period, rel=0.01)
    assert found.peak_spring_force - F_C == approx(np.hypot(drop, np.sqrt(stiffness * mass) * speed), rel=0.01)


def test_a_history_that_ends_before_it_repeats_says_so() -> None:
    found = lugre_stick_slip(PUBLISHED, DRIVE, sliding_speed=SPEED, duration=9.0)
    assert found.kind is SlidingKind.UNSETTLED
    assert "lengthen the duration" in found.reason
    assert np.isnan(found.period)


def test_a_massless_drive_is_refused() -> None:
    with raises(InvalidInput, match="needs a holder with a mass and an elastic spring"):
        lugre_stick_slip(PUBLISHED, Holder(holder_stiffness=2.0), sliding_speed=SPEED, duration=1.0)
