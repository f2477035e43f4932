"""Time marching against closed forms, conservation laws and other integrators."""

from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import fsolve

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap
from sonolube.models.dynamics.motions import State
from sonolube.models.dynamics.structure import Structure, drive_receptance, dynamic_stiffness
from sonolube.models.dynamics.transient import march, trajectory
from sonolube.models.dynamics.waveform import (
    WAVEFORMS,
    PiecewiseLinear,
    StartUpRamp,
    fourier_coefficients,
    sampled_waveform,
)

Array = NDArray[np.float64]
F = 22e3
LOAD = 3.0
ROUGH = ExponentialGap(decay_length=2e-6)
NO_CONTACT = LinearGap(normal_stiffness=0.0)


def chain(first: float, second: float) -> Array:
    return np.array([[first, -first, 0], [-first, first + second, -second], [0, -second, second]])


def tribometer(*, c_p: float = 30.0, k_2: float = 2e5, c_2: float = 20.0) -> Structure:
    return Structure(
        mass_matrix=np.diag([0.15, 0.35, 0.5]),
        damping_matrix=chain(c_p, c_2),
        stiffness_matrix=chain(2e9, k_2),
        drive_vector=62 * 140e-12 * 2e9 * np.array([-1.0, 1.0, 0.0]),
        contact_vector=np.array([1.0, 0.0, 0.0]),
        clamped_capacitance=210e-9,
    )


def held(*, c: float) -> Structure:
    """Return one mass on a spring to the ground, with drive and contact at the mass."""
    return Structure(
        mass_matrix=np.array([[0.1]]),
        damping_matrix=np.array([[c]]),
        stiffness_matrix=np.array([[1e7]]),
        drive_vector=np.array([10.0]),
        contact_vector=np.array([1.0]),
        clamped_capacitance=1e-7,
    )


def state_matrix(s: Structure) -> tuple[Array, Array, Array]:
    """Return A, b and c of z' = A z + b V + c (F_n - F_N) for z = (x, v/omega), which balances its entries."""
    n, omega, inverse = s.coordinates, 2 * np.pi * F, np.linalg.inv(s.mass_matrix)
    A = np.block(
        [[np.zeros((n, n)), omega * np.eye(n)], [-inverse @ s.stiffness_matrix / omega, -inverse @ s.damping_matrix]]
    )
    zeros = np.zeros(n)
    return A, np.r_[zeros, inverse @ s.drive_vector / omega], np.r_[zeros, inverse @ s.contact_vector / omega]


@numba.njit
def rate(
    t: float,
    z: Array,
    generator: Array,
    b: Array,
    c: Array,
    swing: float,
    ramp: float,
    decay: float,
    tau: float,
    shape: int,
) -> Any:
    w = 0.5 * np.sin(2 * np.pi * F * t) if shape == 0 else 0.5 * shape
    n = z.size // 2
    force = LOAD * np.exp(-z[0] / decay) * max(1 - tau * z[n] * 2 * np.pi * F, 0.0)
    rise = min(t / ramp, 1.0) if ramp > 0 else 1.0
    return generator @ z + b * (swing * rise * w) + c * (force - LOAD)


def by_dop853(
    s: Structure, *, swing: float, ramp: float, periods: int, tau: float = 0.0, square: bool = False
) -> Array:
    """Return the displacement of the contact at the end of each period."""
    A, b, c = state_matrix(s)
    z, ends = np.zeros(A.shape[0]), []
    for half in range(2 * periods):
        shape = (1, -1)[half % 2] if square else 0
        options: dict[str, Any] = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-18}
        arguments = (A, b, c, swing, ramp, 2e-6, tau, shape)
        z = solve_ivp(rate, (half / (2 * F), (half + 1) / (2 * F)), z, args=arguments, **options).y[:, -1]
        if half % 2:
            ends.append(z[0])
    return np.array(ends)


@pytest.mark.parametrize("steps", [8, 20])
@pytest.mark.parametrize("c_2", [0.0, 20.0, 447.0, 2e4])
def test_without_contact_every_step_is_exact_for_any_damping(steps: int, c_2: float) -> None:
    # harmonic motion, which the dynamic stiffness gives, and free motion by the matrix exponential
    s, periods, swing = tribometer(c_2=c_2), 50, 10.0
    x0, v0 = np.array([1e-6, -2e-6, 0.5e-6]), np.array([0.01, 0.2, -0.02])
    omega = 2 * np.pi * F
    steady = np.linalg.solve(dynamic_stiffness(s, frequency=F), s.drive_vector) * (-0.5j * swing)
    A, _, _ = state_matrix(s)
    free = np.r_[x0, v0 / omega] - np.r_[steady.real, (1j * steady).real]
    ends = [(expm(A * k / F) @ free + np.r_[steady.real, (1j * steady).real])[0] for k in range(1, periods + 1)]
    marched = march(
        s,
        NO_CONTACT,
        normal_load=LOAD,
        frequency=F,
        voltage_peak_to_peak=swing,
        periods=periods,
        steps_per_period=steps,
        strobed_periods=periods,
        initial_state=State(coordinates=x0, velocities=v0),
    )
    assert marched.strobed.displacement == approx(np.array(ends), abs=2e-12 * np.abs(ends).max())


def test_a_linear_ramp_is_exact_without_contact() -> None:
    # the ramped sine is the output of a linear system itself, so that one matrix exponential holds everything
    s, swing, ramped = tribometer(), 10.0, 10
    A, b, _ = state_matrix(s)
    omega, n = 2 * np.pi * F, A.shape[0]
    turn = np.array([[0.0, omega], [-omega, 0.0]])  # sin' = omega cos
    whole = np.zeros((n + 4, n + 4))
    whole[:n, :n], whole[:n, n] = A, b * swing / 2
    whole[n : n + 2, n : n + 2], whole[n + 2 :, n + 2 :] = turn, turn
    whole[n : n + 2, n + 2 :] = np.eye(2) * F / ramped  # (t sin)' = sin + omega t cos
    start = np.zeros(n + 4)
    start[n + 3] = 1.0
    expected = (expm(whole * ramped / F) @ start)[0]
    marched = march(
        s,
        NO_CONTACT,
        normal_load=LOAD,
        frequency=F,
        voltage_peak_to_peak=swing,
        periods=ramped,
        steps_per_period=8,
        ramp=StartUpRamp(duration=ramped / F),
    )
    assert marched.strobed.displacement[-1] == approx(expected, rel=1e-11)


def test_a_waveform_with_corners_within_steps_gives_the_response_of_its_fourier_series() -> None:
    s, f = held(c=2000.0), 700.0
    waveform = sampled_waveform([0.0, 1.0, 0.3, -0.4, -1.0, 0.2, 0.5])
    marched = march(
        s,
        NO_CONTACT,
        normal_load=LOAD,
        frequency=f,
        voltage_peak_to_peak=3.0,
        periods=40,
        steps_per_period=8,
        waveform=waveform,
    )
    orders = np.arange(1, 1001)
    lines = 3.0 * drive_receptance(s, frequency=f * orders) * fourier_coefficients(waveform, 1000)[1:]
    phases = 2 * np.pi * np.arange(1, 9) / 8
    expected = 2 * (lines @ np.exp(1j * np.multiply.outer(orders, phases))).real
    assert marched.last_periods.displacement == approx(expected, abs=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize(("tau", "square"), [(0.0, False), (0.3, False), (0.0, True)])
def test_the_error_falls_with_the_fifth_power_of_the_step_or_faster(tau: float, square: bool) -> None:
    s, periods, steps = tribometer(), 20, np.array([16, 24, 32, 48, 64])
    exact = by_dop853(s, swing=30.0, ramp=10 / F, periods=periods, tau=tau, square=square)
    errors = [
        np.abs(
            march(
                s,
                ExponentialGap(decay_length=2e-6, force_damping=tau),
                normal_load=LOAD,
                frequency=F,
                voltage_peak_to_peak=30.0,
                periods=periods,
                steps_per_period=int(count),
                ramp=StartUpRamp(duration=10 / F),
                waveform=WAVEFORMS["square" if square else "sine"],
            ).strobed.displacement
            - exact
        ).max()
        for count in steps
    ]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order > 5
    assert errors[0] < 5e-5 * np.ptp(exact)
    assert errors[-1] < 5e-8 * np.ptp(exact)


def test_a_start_up_of_200_periods_agrees_with_another_integrator() -> None:
    s = tribometer()
    exact = by_dop853(s, swing=17.0, ramp=100 / F, periods=200)
    for steps, error in ((12, 1e-4), (16, 1e-5), (64, 1e-10)):
        marched = march(
            s,
            ROUGH,
            normal_load=LOAD,
            frequency=F,
            voltage_peak_to_peak=17.0,
            periods=200,
            steps_per_period=steps,
            strobed_periods=200,
            ramp=StartUpRamp(duration=100 / F),
        )
        assert marched.strobed.displacement == approx(exact, abs=error * np.ptp(marched.last_periods.displacement))


@pytest.mark.parametrize(
    "law", [ROUGH, HertzGap(tip_radius=5e-3, effective_modulus=1e11), LinearGap(normal_stiffness=1e7)]
)
def test_impacting_agrees_with_runge_kutta_in_many_steps(law: GapLaw) -> None:
    s, swing, periods, steps = tribometer(), 200.0, 10, 1000
    A, b, c = state_matrix(s)
    h, z = 1 / (F * steps), np.zeros(6)

    def slope(t: float, z: Array) -> Any:
        force = float(law.force(np.array(z[0]), np.array(LOAD)))
        return A @ z + b * (swing * 0.5 * np.sin(2 * np.pi * F * t)) + c * (force - LOAD)

    for k in range(periods * steps):
        first = slope(k * h, z)
        second = slope((k + 0.5) * h, z + h / 2 * first)
        third = slope((k + 0.5) * h, z + h / 2 * second)
        z = z + h / 6 * (first + 2 * second + 2 * third + slope((k + 1) * h, z + h * third))
    marched = march(
        s,
        law,
        normal_load=LOAD,
        frequency=F,
        voltage_peak_to_peak=swing,
        periods=periods,
        steps_per_period=256,
        workers=1,
    )
    assert marched.envelope.lowest_normal_force.min() < 0.01 * LOAD
    assert marched.final_state.coordinates == approx(z[:3], abs=1e-5 * np.ptp(marched.last_periods.displacement))


def test_a_corner_at_the_loss_of_contact_lowers_the_order_and_is_reported() -> None:
    def ends(steps: int) -> tuple[Array, str]:
        marched = march(
            tribometer(),
            LinearGap(normal_stiffness=1e6),
            normal_load=LOAD,
            frequency=F,
            voltage_peak_to_peak=np.linspace(40, 80, 64),
            periods=20,
            steps_per_period=steps,
        )
        return marched.strobed.displacement, str(marched.advice[0])

    exact, _ = ends(4096)
    steps = (32, 128, 512)
    errors = [np.sqrt(np.mean((ends(count)[0] - exact) ** 2)) for count in steps]
    assert 1.4 < -np.polyfit(np.log(steps), np.log(errors), 1)[0] < 2.6
    assert (
        ends(32)[1]
        == "the force has a corner at the loss of contact, where the error falls only as the square of the step"
    )


def test_energy_is_conserved_without_drive_and_damping() -> None:
    s = tribometer(c_p=0.0, c_2=0.0)
    motion = trajectory(
        s,
        ROUGH,
        normal_load=LOAD,
        frequency=F,
        voltage_peak_to_peak=0.0,
        periods=300,
        steps_per_period=32,
        initial_state=State(coordinates=np.zeros(3), velocities=np.array([0.6, -0.2, 0.02])),
    )
    x, v = motion.states.coordinates, motion.states.velocities
    kinetic = np.einsum("ti,ij,tj->t", v, s.mass_matrix, v) / 2
    elastic = np.einsum("ti,ij,tj->t", x, s.stiffness_matrix, x) / 2
    pressed = LOAD * (2e-6 * np.expm1(-x[:, 0] / 2e-6) + x[:, 0])
    assert np.ptp(x[:, 0]) > 5e-6
    assert kinetic + elastic + pressed == approx(kinetic[0], rel=1e-7)


def test_the_work_of_the_drive_is_dissipated_by_the_dampers() -> None:
    s = tribometer(c_p=2000.0, c_2=400.0)
    motion = trajectory(
        s, ROUGH, normal_load=LOAD, frequency=F, voltage_peak_to_peak=100.0, periods=1500, steps_per_period=64
    )
    last = slice(-64, None)
    v = motion.states.velocities[last]
    supplied = np.mean((v @ s.drive_vector) * motion.voltage[last])
    taken = np.mean(np.einsum("ti,ij,tj->t", v, s.damping_matrix, v))
    assert supplied == approx(taken, rel=1e-5)


def test_the_mean_force_under_a_floating_structure_is_its_load_whatever_the_loss_of_contact() -> None:
    marched = march(
        tribometer(c_p=600.0, c_2=300.0),
        ROUGH,
        normal_load=LOAD,
        frequency=F,
        voltage_peak_to_peak=np.array([10.0, 100.0, 300.0]),
        periods=3000,
        ramp=StartUpRamp(duration=500 / F, shape="cosine"),
    )
    assert marched.last_periods.normal_force.mean(axis=-1) == approx(LOAD, rel=2e-5)
    assert (
        marched.envelope.lowest_normal_force[-1, -1]
        < 0.01 * LOAD
        < LOAD
        < marched.envelope.highest_normal_force[-1, -1]
    )


def test_a_grounded_structure_rests_where_spring_contact_and_offset_balance() -> None:
    marched = march(
        held(c=500.0),
        ROUGH,
        normal_load=LOAD,
        frequency=1e3,
        voltage_peak_to_peak=0.0,
        voltage_offset=2.0,
        periods=100,
        ramp=StartUpRamp(duration=0.02),
    )
    x = float(marched.last_periods.displacement[-1])
    assert 1e7 * x == approx(10.0 * 2.0 + LOAD * (np.exp(-x / 2e-6) - 1), rel=1e-9)


def test_without_contact_a_resonance_builds_up_as_one_minus_its_free_decay() -> None:
    s = held(c=20.0)  # 1591.5 Hz, decay rate 100 /s
    f = np.sqrt(1e7 / 0.1) / (2 * np.pi)
    marched = march(
        s, NO_CONTACT, normal_load=LOAD, frequency=f, voltage_peak_to_peak=1.0, periods=100, periods_per_window=1
    )
    middle = marched.envelope.time - 0.5 / f
    steady = 0.5 * 10.0 / (20.0 * 2 * np.pi * f)
    expected = steady * -np.expm1(-100 * middle)
    assert marched.envelope.first_harmonic_amplitude[5:] == approx(expected[5:], rel=0.01)


def test_a_march_can_be_continued_from_its_final_state() -> None:
    s = tribometer()

    def go(periods: int, start: State | None) -> State:
        return march(
            s,
            ROUGH,
            normal_load=LOAD,
            frequency=F,
            voltage_peak_to_peak=12.0,
            periods=periods,
            steps_per_period=64,
            initial_state=start,
        ).final_state

    assert go(40, go(60, None)).coordinates == approx(go(100, None).coordinates, rel=1e-7)


def test_points_of_a_batch_are_independent() -> None:
    s = tribometer()
    load, f, swing = np.linspace(1, 5, 70), np.linspace(21e3, 23e3, 70), np.linspace(1, 60, 70)

    def go(chosen: Any, workers: int) -> Array:
        marched = march(
            s,
            ROUGH,
            normal_load=load[chosen],
            frequency=f[chosen],
            voltage_peak_to_peak=swing[chosen],
            periods=40,
            ramp=StartUpRamp(duration=0.001),
            workers=workers,
        )
        return marched.last_periods.displacement

    together = go(slice(None), 1)
    assert together == approx(go(slice(None), 3), rel=0, abs=0)
    assert together[[0, 33, 69]] == approx(go([0, 33, 69], 1), rel=1e-9)


def test_a_trajectory_is_the_march_of_its_point() -> None:
    conditions: dict[str, Any] = {
        "normal_load": LOAD,
        "frequency": F,
        "voltage_peak_to_peak": 20.0,
        "voltage_offset": 5.0,
        "periods": 30,
        "ramp": StartUpRamp(duration=20 / F),
    }
    motion, marched = trajectory(tribometer(), ROUGH, **conditions), march(tribometer(), ROUGH, **conditions)
    assert motion.time[-1] == approx(30 / F)
    assert motion.contact.displacement[-16:] == approx(marched.last_periods.displacement, rel=1e-12)
    assert motion.contact.normal_force[0] == approx(LOAD)
    assert motion.voltage[[0, 164, -13]] == approx([0.0, 164 / 320 * (5 + 10), 15.0])


def test_harmonics_of_the_last_period_are_those_of_the_receptance_without_contact() -> None:
    s = held(c=2000.0)
    marched = march(s, NO_CONTACT, normal_load=LOAD, frequency=700.0, voltage_peak_to_peak=3.0, periods=60)
    lines = np.fft.rfft(np.roll(marched.last_periods.displacement, 1)) / 16
    response = complex(drive_receptance(s, frequency=700.0)) * 3.0 / 2j
    assert lines[:3] == approx([0.0, response / 2, 0.0], abs=1e-10 * abs(response))


def test_many_periods_take_bounded_memory() -> None:
    marched = march(
        tribometer(),
        ROUGH,
        normal_load=LOAD,
        frequency=F,
        voltage_peak_to_peak=[1.0, 2.0],
        periods=5000,
        steps_per_period=8,
    )
    assert marched.envelope.time.shape == (2, 250)
    assert marched.envelope.time[:, -1] == approx(5000 / F)
    assert marched.last_periods.displacement.shape == (2, 8)


def test_steps_too_long_for_the_contact_are_reported_as_coarse() -> None:
    def go(steps: int) -> Any:
        return march(
            tribometer(),
            ROUGH,
            normal_load=100.0,
            frequency=5e3,
            voltage_peak_to_peak=[100.0, 1000.0, 3000.0],
            periods=300,
            steps_per_period=steps,
            ramp=StartUpRamp(duration=0.02),
        )

    short, long = go(64), go(8)
    assert set(short.status) == {"marched"}
    assert set(long.status) <= {"coarse", "diverged"}
    assert all("steps a period" in advice for advice in long.advice)
    assert np.all(np.isinf(long.step_error[long.status == "diverged"]))
    finer, coarse = go(32).last_periods.normal_force, go(16)
    for point in range(3):
        exact = short.last_periods.normal_force[point, 1::2]
        assert np.abs(finer[point] - exact).max() < 1e-3 * exact.max()
        off = np.abs(coarse.last_periods.normal_force[point] - exact[1::2]).max() / exact.max()
        assert off < max(10 * coarse.step_error[point], 1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"normal_load": -1.0}, r"normal_load must be positive, got -1\.0 N"),
        ({"frequency": 0.0}, r"frequency must be positive, got 0\.0 Hz"),
        ({"voltage_peak_to_peak": np.nan}, r"voltage_peak_to_peak must be finite, got nan V"),
        ({"voltage_peak_to_peak": -1.0}, r"voltage_peak_to_peak must not be negative"),
        ({"voltage_offset": np.inf}, r"voltage_offset must be finite"),
        ({"frequency": np.ones(3), "normal_load": np.ones(2)}, r"must have matching shapes, got \(2,\), \(3,\)"),
        ({"frequency": np.ones(0)}, r"at least one point"),
        ({"steps_per_period": 10}, r"steps_per_period must be a multiple of 4, at least 8, got 10"),
        ({"periods": 0}, r"periods must be at least 1, got 0"),
        ({"workers": 0}, r"workers must be at least 1, got 0"),
        ({"strobed_periods": 0}, r"strobed_periods must be at least 1"),
        (
            {"initial_state": State(coordinates=np.zeros(2), velocities=np.zeros(3))},
            r"3 coordinates and velocities .* \(2,\)",
        ),
        (
            {"initial_state": State(coordinates=np.full(3, np.nan), velocities=np.zeros(3))},
            r"coordinates must be finite",
        ),
    ],
)
def test_invalid_arguments_of_a_march_are_refused_by_name(change: dict[str, Any], message: str) -> None:
    conditions: dict[str, Any] = {"normal_load": LOAD, "frequency": F, "voltage_peak_to_peak": 1.0, "periods": 1}
    with raises(InvalidInput, match=message):
        march(tribometer(), ROUGH, **{**conditions, **change})


def test_a_jump_within_a_step_is_refused_with_a_suitable_number_of_steps() -> None:
    third = PiecewiseLinear(
        starts_at=np.array([0.0, 2 * np.pi / 3]), first=np.array([2 / 3, -1 / 3]), last=np.array([2 / 3, -1 / 3])
    )
    conditions: dict[str, Any] = {"normal_load": LOAD, "frequency": F, "voltage_peak_to_peak": 1.0, "periods": 2}
    with raises(
        InvalidInput, match="steps_per_period = 16 lets the waveform jump within a step; take a multiple of 12"
    ):
        march(tribometer(), ROUGH, waveform=third, **conditions)
    march(tribometer(), ROUGH, waveform=third, steps_per_period=12, **conditions)


def test_a_trajectory_of_several_points_is_refused() -> None:
    two: Any = np.ones(2)
    with raises(InvalidInput, match="trajectory takes one point, got 2; march takes many"):
        trajectory(tribometer(), ROUGH, normal_load=two, frequency=F, voltage_peak_to_peak=1.0, periods=1)


def test_coupled_modes_with_coinciding_poles_are_refused() -> None:
    # two coupled oscillators, one damped: (x^2 + g x + 1) (x^2 + k) - 0.01 has a double root x for some g and k
    def double_root(unknown: Array) -> list[float]:
        real, imaginary, g, k = unknown
        x = complex(real, imaginary)
        here = (x**2 + g * x + 1) * (x**2 + k) - 0.01
        slope = (2 * x + g) * (x**2 + k) + (x**2 + g * x + 1) * 2 * x
        return [here.real, here.imag, slope.real, slope.imag]

    _, _, g, k = fsolve(double_root, [-0.05, 1.0, 0.2, 1.0], xtol=1e-13)
    s = Structure(
        mass_matrix=np.eye(2),
        damping_matrix=np.diag([g, 0.0]),
        stiffness_matrix=np.array([[1.0, 0.1], [0.1, k]]),
        drive_vector=np.array([1.0, 0.0]),
        contact_vector=np.array([1.0, 0.0]),
        clamped_capacitance=1e-9,
    )
    with raises(InvalidInput, match=r"damping_matrix .* coincide"):
        march(s, ROUGH, normal_load=1.0, frequency=1e3, voltage_peak_to_peak=1.0, periods=1)
