"""A slider with mass ratio over a vibrating surface: mean force, and suppression of stick-slip."""

import numpy as np
from pytest import approx, mark, raises
from scipy.integrate import solve_ivp

from sonolube.errors import InvalidInput
from sonolube.models.friction import (
    DahlFriction,
    DriveForce,
    Holder,
    LuGreFriction,
    parallel_vibration_ratio,
    spring_driven_slider_force,
    transverse_vibration_ratio,
)

STIFF = DahlFriction(contact_stiffness=1e7, coulomb_friction_force=2.0)
HEAVY = Holder(holder_stiffness=1e5, holder_mass=0.5, holder_damping=100.0)
STRIBECK = LuGreFriction(
    coulomb_friction_force=1.0,
    static_friction_force=1.6,
    stribeck_velocity=5e-3,
    bristle_stiffness=1e5,
    bristle_damping=100.0,
    viscous_coefficient=0.4,
)
SOFT = Holder(holder_stiffness=2e3, holder_mass=0.5)


@mark.parametrize("v", [0.2, 0.5, 1.5])
def test_a_heavy_slider_on_stiff_bristles_has_the_kinematic_ratios_of_coulomb_friction(v: float) -> None:
    velocity, frequency = 0.5, 1000.0  # a stroke of 80 um against a deformation of 0.2 um

    def ratio(direction: float) -> float:
        slide = spring_driven_slider_force(
            STIFF,
            HEAVY,
            sliding_speed=v * velocity,
            frequency=frequency,
            vibration_amplitude=velocity / (2 * np.pi * frequency),
            vibration_direction=direction,
            settling_time=0.1,
            duration=0.03,
        )
        return slide.mean_drive_force / 2.0

    kinematic = {"sliding_speed": v, "vibration_velocity": 1.0}
    assert ratio(0.0) == approx(float(parallel_vibration_ratio(**kinematic)), abs=0.01)
    assert ratio(np.pi / 2) == approx(float(transverse_vibration_ratio(**kinematic)), abs=0.01)


def test_the_force_is_that_of_an_adaptive_integrator() -> None:
    speed, frequency, amplitude, angle, load_amplitude = 5e-3, 500.0, 3e-6, 0.6, 0.3
    omega = 2 * np.pi * frequency

    def rates(t: float, state: np.ndarray) -> list[float]:
        elongation, w, z_x, z_y, _ = state
        velocity = amplitude * omega * np.cos(omega * t)
        x, y = w - velocity * np.cos(angle), -velocity * np.sin(angle)
        relative_speed = np.hypot(x, y)
        g = (1 + load_amplitude * np.sin(omega * t)) * (1 + 0.6 * np.exp(-((relative_speed / 5e-3) ** 2))) / 1e5
        rate_x, rate_y = x - relative_speed * z_x / g, y - relative_speed * z_y / g
        friction = 1e5 * z_x + 100 * rate_x + 0.4 * x
        drive = 1e4 * elongation + 30 * (speed - w)
        return [speed - w, (drive - friction) / 0.05, rate_x, rate_y, drive]

    settled = solve_ivp(rates, (0, 0.05), [0, speed, 0, 0, 0], method="LSODA", rtol=1e-8, atol=1e-12)
    start = np.append(settled.y[:4, -1], 0.0)
    averaged = solve_ivp(rates, (0.05, 0.07), start, method="LSODA", rtol=1e-8, atol=1e-12, max_step=2e-5)
    slide = spring_driven_slider_force(
        STRIBECK,
        Holder(holder_stiffness=1e4, holder_mass=0.05, holder_damping=30.0),
        sliding_speed=speed,
        frequency=frequency,
        vibration_amplitude=amplitude,
        vibration_direction=angle,
        load_fraction=load_amplitude,
        settling_time=0.05,
        duration=0.02,
    )
    assert slide.mean_drive_force == approx(averaged.y[4, -1] / 0.02, rel=2e-3)
    assert slide.drive_force_range == approx(1e4 * np.ptp(averaged.y[0]), rel=0.02)


def soft_drive(amplitude: float) -> DriveForce:
    return spring_driven_slider_force(
        STRIBECK,
        SOFT,
        sliding_speed=2e-3,
        frequency=1000.0,
        vibration_amplitude=amplitude,
        settling_time=1.0,
        duration=0.5,
    )


def test_vibration_faster_than_the_sliding_stops_stick_slip() -> None:
    # the falling Stribeck curve drives the slider to and fro by the whole force; peak velocity 6.3 mm/s against 2
    without, vibrated = soft_drive(0.0), soft_drive(1e-6)
    assert without.drive_force_range > 1.0
    assert vibrated.drive_force_range < 1e-3
    assert vibrated.mean_drive_force < 0.6 * without.mean_drive_force


def test_vibration_slower_than_the_sliding_leaves_stick_slip() -> None:
    assert soft_drive(1e-7).drive_force_range > 1.0


def test_a_stroke_within_the_bristle_deflection_does_not_reduce_friction() -> None:
    # 1 nm against a deformation of F_c/K = 0.2 um: Dahl's bristles follow it, and sliding on at mean(v)/mean(|v|)
    slide = spring_driven_slider_force(
        STIFF, HEAVY, sliding_speed=1e-3, frequency=1000.0, vibration_amplitude=1e-9, settling_time=0.1, duration=0.03
    )
    assert slide.mean_drive_force == approx(2.0, rel=1e-3)


def test_a_drive_without_mass_is_refused() -> None:
    with raises(InvalidInput, match="holder_mass must be positive"):
        spring_driven_slider_force(
            STIFF, Holder(), sliding_speed=1e-3, frequency=1e3, vibration_amplitude=0.0, settling_time=0.0, duration=0.1
        )
