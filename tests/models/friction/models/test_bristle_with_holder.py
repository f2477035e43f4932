"""One bristle on a holder against explicit time integration, limits and the balance of energy."""

from dataclasses import asdict, replace
from typing import Literal

import numpy as np
import pytest
from pytest import approx, raises
from scipy.special import i0

from sonolube.errors import InvalidInput
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    RoughContact,
    load_balanced_motion,
    sinusoidal_motion,
)
from sonolube.models.friction import (
    BristleWithHolder,
    Coulomb,
    Holder,
    SpringContact,
    combined_oscillation_ratio,
    dahl_under_vibration,
)
from sonolube.models.surfaces import Roughness

MINDLIN_RATIO, MU, LOAD, FREQUENCY, DECAY_LENGTH, AMPLITUDE = 0.8, 0.3, 3.0, 22e3, 2e-6, 2.5e-6
CONTACT = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=MINDLIN_RATIO),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
OMEGA = 2 * np.pi * FREQUENCY
HOLDER = Holder(holder_stiffness=2e6, holder_mass=1e-4, holder_damping=3.0)


def balanced(amplitude: float = AMPLITUDE) -> ContactMotion:
    return load_balanced_motion(
        CONTACT, sinusoidal_motion(CONTACT, normal_load=LOAD, vibration_amplitude=amplitude, frequency=FREQUENCY)
    )


def critical_speed(amplitude: float = AMPLITUDE) -> float:
    return MU * OMEGA * amplitude / MINDLIN_RATIO


def normal_force_at(theta: float | np.ndarray) -> np.ndarray:
    beta = AMPLITUDE / DECAY_LENGTH
    return np.asarray(LOAD / i0(beta) * np.exp(-beta * np.cos(theta)))


def integrated(
    *,
    speed: float,
    holder: Holder | None = None,
    in_plane: tuple[float, float] = (0.0, 0.0),
    exponent: int = 0,
    steps: int = 20_000,
    periods: int = 4,
) -> dict[str, float]:
    """Return the mean friction ratio and the powers of bristle and holder by explicit time integration."""
    step = 1 / FREQUENCY / steps
    theta = 2 * np.pi * np.arange(steps + 1) / steps
    forces = normal_force_at(theta)
    k, limits = MINDLIN_RATIO * forces / DECAY_LENGTH, MU * forces
    fraction, lag = in_plane
    in_plane_speed = -fraction * AMPLITUDE * OMEGA * np.sin(theta - lag)
    F, y, w = float(limits[0]), 0.0, 0.0
    if holder is not None:
        y = 0.5 * MU * LOAD / holder.holder_stiffness
    sums = dict.fromkeys(("force", "slip", "bristle", "holder"), 0.0)
    for period in range(periods):
        for j in range(steps):
            v = speed + in_plane_speed[j] - w
            factor = 1 - np.sign(v) * F / limits[j] if exponent else 1.0
            new = min(max(F + k[j] * v * factor * step, -limits[j + 1]), limits[j + 1])
            if period == periods - 1:
                sums["force"] += F / steps
                sums["bristle"] += F * v / steps
                sums["slip"] += F * (v - (new - F) / step / k[j]) / steps
            if holder is not None:
                w += step * (F - holder.holder_stiffness * y - holder.holder_damping * w) / holder.holder_mass
                y += step * w
                if period == periods - 1:
                    sums["holder"] += holder.holder_damping * w * w / steps
            F = new
    return sums


def test_from_the_critical_speed_on_the_ratio_is_exactly_one() -> None:
    for amplitude in (0.1e-6, AMPLITUDE, 14e-6):
        speeds = critical_speed(amplitude) * np.array([1.001, 2.0, 100.0])
        assert BristleWithHolder().ratio(
            CONTACT, balanced(amplitude), sliding_speed=speeds, friction_coefficient=MU
        ) == approx([1, 1, 1], rel=1e-6)


def test_just_below_the_critical_speed_friction_is_reduced() -> None:
    speed = 0.9 * critical_speed()
    assert BristleWithHolder().ratio(CONTACT, balanced(), sliding_speed=speed, friction_coefficient=MU) < 0.999


@pytest.mark.parametrize("exponent", [0, 1])
@pytest.mark.parametrize("holder", [Holder(), Holder(holder_stiffness=1e6)])
def test_slow_sliding_reaches_the_static_friction_ratio(exponent: Literal[0, 1], holder: Holder) -> None:
    # friction cannot exceed what the widest gap allows, and slow sliding does not win it back before the next
    for amplitude in (0.1e-6, AMPLITUDE):
        beta = amplitude / DECAY_LENGTH
        slow = BristleWithHolder(**asdict(holder), dahl_exponent=exponent).ratio(
            CONTACT, balanced(amplitude), sliding_speed=1e-7, friction_coefficient=MU
        )
        assert slow == approx(np.exp(-beta) / i0(beta), rel=1e-3)


def test_a_compliant_holder_reduces_friction_and_a_stiff_one_has_no_effect() -> None:
    speeds = critical_speed() * np.array([0.1, 0.5, 1.0])
    rigid, stiff, soft = (
        BristleWithHolder(**asdict(holder)).ratio(CONTACT, balanced(), sliding_speed=speeds, friction_coefficient=MU)
        for holder in (Holder(), Holder(holder_stiffness=1e12), Holder(holder_stiffness=1e6))
    )
    assert stiff == approx(rigid, rel=1e-5)
    assert np.all(soft < rigid)


@pytest.mark.parametrize("exponent", [0, 1])
@pytest.mark.parametrize("in_plane", [(0.0, 0.0), (0.3, 0.7)])
def test_the_bristle_has_the_ratio_of_small_time_steps(exponent: Literal[0, 1], in_plane: tuple[float, float]) -> None:
    speed = 0.3 * critical_speed()
    computed = BristleWithHolder(
        in_plane_fraction=in_plane[0], in_plane_phase=in_plane[1], dahl_exponent=exponent
    ).ratio(CONTACT, balanced(), sliding_speed=speed, friction_coefficient=MU)
    small = integrated(speed=speed, in_plane=in_plane, exponent=exponent)["force"] / (MU * LOAD)
    assert computed == approx(small, abs=5e-4)


@pytest.mark.parametrize("exponent", [0, 1])
def test_a_holder_with_mass_matches_small_time_steps_and_balances_the_energy(exponent: Literal[0, 1]) -> None:
    speed = 0.3 * critical_speed()
    small = integrated(speed=speed, holder=HOLDER, exponent=exponent, periods=40, steps=4000)
    computed = BristleWithHolder(**asdict(HOLDER), dahl_exponent=exponent).ratio(
        CONTACT, balanced(), sliding_speed=speed, friction_coefficient=MU
    )
    assert computed == approx(small["force"] / (MU * LOAD), abs=2e-3)
    # what the drive puts in, v_r F, leaves through bristle and holder's damping
    assert float(computed) * MU * LOAD * speed == approx(small["bristle"] + small["holder"], rel=5e-3)
    assert small["slip"] > 0


def test_a_holder_of_great_mass_is_rigid() -> None:
    speeds = critical_speed() * np.array([0.1, 0.5])
    heavy = Holder(holder_stiffness=1e6, holder_mass=10.0, holder_damping=100.0)
    assert BristleWithHolder(**asdict(heavy)).ratio(
        CONTACT, balanced(), sliding_speed=speeds, friction_coefficient=MU
    ) == approx(BristleWithHolder().ratio(CONTACT, balanced(), sliding_speed=speeds, friction_coefficient=MU), rel=1e-3)


def test_in_plane_motion_faster_than_the_sliding_can_drive_the_slider() -> None:
    # friction reverses when the pin moves forward while it presses: beyond 100 % reduction, as D found
    pushed = BristleWithHolder(in_plane_fraction=0.8, in_plane_phase=np.pi / 2).ratio(
        CONTACT, balanced(), sliding_speed=0.02, friction_coefficient=MU
    )
    held = BristleWithHolder(in_plane_fraction=0.8, in_plane_phase=-np.pi / 2).ratio(
        CONTACT, balanced(), sliding_speed=0.02, friction_coefficient=MU
    )
    assert min(pushed, held) < 0 < max(pushed, held)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"holder_stiffness": 0.0}, r"holder_stiffness must be positive, got 0\.0 N/m"),
        ({"holder_mass": -1.0, "holder_stiffness": 1.0}, r"holder_mass must not be negative, got -1\.0 kg"),
        ({"holder_damping": 1.0}, "holder_damping requires a holder_mass"),
        ({"holder_mass": 1.0}, "requires a finite holder_stiffness"),
    ],
)
def test_impossible_holders_are_refused(values: dict[str, float], message: str) -> None:
    with raises(InvalidInput, match=message):
        Holder(**values)


def within_plane(along: complex, across: complex, *, normal: float = 0.0) -> ContactMotion:
    """Motion with complex amplitudes within the plane, in m."""
    moved = balanced(normal)
    phases = np.exp(2j * np.pi * np.arange(moved.displacement.size) / moved.displacement.size)
    return replace(moved, along=(along * phases).real, across=(across * phases).real)


SPEEDS = np.array([0.002, 0.02, 0.2])


@pytest.mark.parametrize(("along", "across"), [(0.0, 1.0), (0.4, 1.0), (1.0, 0.5 - 0.5j)])
def test_at_a_constant_load_it_is_the_spring_contact_in_every_direction(along: complex, across: complex) -> None:
    # a flat profile of the same slip length, integrated in another room; F_n/k_t is l/0.8
    size = 0.8e-6
    slip = MU * DECAY_LENGTH / MINDLIN_RATIO
    expected = combined_oscillation_ratio(
        SpringContact(friction_coefficient=MU, mindlin_ratio=1.0),
        approach=slip / MU,
        frequency=FREQUENCY,
        sliding_speed=SPEEDS,
        in_plane_amplitude=size * abs(along),
        in_plane_phase=-np.angle(along),
        transverse_amplitude=size * abs(across),
        transverse_phase=-np.angle(across),
        steps=8192,
    )
    found = BristleWithHolder().ratio(
        CONTACT, within_plane(size * along, size * across), sliding_speed=SPEEDS, friction_coefficient=MU
    )
    assert found == approx(expected, abs=1e-4)


def test_with_dahls_exponent_and_a_constant_load_it_is_dahls_law_within_the_plane() -> None:
    # the cube of D has half the stiffness in the law: both by the length F_c/k of their contact
    from sonolube.models.contact import cube_tangential_stiffness, normal_force, separation
    from sonolube.models.contact.tangential_stiffness import mindlin_tangential_stiffness

    d = separation(CONTACT, normal_load=LOAD)
    scale = float(
        cube_tangential_stiffness(CONTACT, separation=d) / mindlin_tangential_stiffness(CONTACT, separation=d)
    )
    size = 1e-6
    expected = dahl_under_vibration(
        CONTACT,
        separation=d,
        friction_coefficient=MU,
        sliding_speed=SPEEDS,
        frequency=FREQUENCY,
        in_plane_amplitude=0.3 * size,
        transverse_amplitude=size,
        transverse_phase=0.5 - np.pi / 2,
        steps=4096,
    ) / (MU * float(normal_force(CONTACT, separation=d)))
    moved = within_plane(0.3 * size * scale, size * scale * np.exp(-0.5j))
    found = BristleWithHolder(dahl_exponent=1).ratio(
        CONTACT, moved, sliding_speed=SPEEDS * scale, friction_coefficient=MU
    )
    assert found == approx(expected, abs=1e-4)


@pytest.mark.parametrize("exponent", [0, 1])
def test_along_alone_is_the_limit_of_little_across(exponent: Literal[0, 1]) -> None:
    model = BristleWithHolder(dahl_exponent=exponent)
    for normal in (0.0, 1e-6):
        only, both = (
            replace(within_plane(1e-6, 0.0, normal=normal), across=None),
            within_plane(1e-6, 1e-13, normal=normal),
        )
        one, other = (
            model.ratio(CONTACT, each, sliding_speed=SPEEDS, friction_coefficient=MU) for each in (only, both)
        )
        assert other == approx(one, abs=2e-4)


@pytest.mark.parametrize("exponent", [0, 1])
def test_long_strokes_have_the_ratio_of_coulomb(exponent: Literal[0, 1]) -> None:
    moved = within_plane(2e-4, 5e-4j)
    speeds = np.array([5.0, 30.0, 100.0])
    found = BristleWithHolder(dahl_exponent=exponent).ratio(
        CONTACT, moved, sliding_speed=speeds, friction_coefficient=MU
    )
    assert found == approx(Coulomb().ratio(CONTACT, moved, sliding_speed=speeds), abs=4e-3)


def test_across_on_an_elastic_holder_is_refused_with_the_remedy() -> None:
    with raises(InvalidInput, match=r"holder_stiffness: .* leave friction.holder_stiffness out"):
        BristleWithHolder(holder_stiffness=1e6).ratio(
            CONTACT, within_plane(0.0, 1e-6), sliding_speed=0.1, friction_coefficient=MU
        )
