"""Direction of a rig's vibration: words, angles, second components, limits into each other, refusals in one line."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.contact import separation
from sonolube.models.contact.tangential_stiffness import mindlin_tangential_stiffness
from sonolube.models.friction import torsional_vibration_ratio
from sonolube.rig import Rig, friction_point, operating_points, point_batch, read_rig, rig_from, simulate, wear_point
from sonolube.rig.contact_temperature import temperature_point, thermal_solid
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.responses import simulation_arrays
from sonolube.rig.vibration import steady_vibration
from sonolube.rig.vibration_direction import NORMAL, SAME_DIRECTION, VibrationDirection, require_same_direction
from sonolube.text.units import to_si

RIGS = Path("examples/rigs")
PUBLISHED = Path(__file__).parents[2] / "src" / "sonolube" / "prediction" / "published"
BRISTLE, COULOMB, SPRINGS = (
    f"friction.model={name}" for name in ("bristle_with_holder", "coulomb", "asperity_stick_slip")
)
WITHIN = ("vibration.direction=", "vibration.vibration_direction=")


def tribometer(*changes: str) -> Rig:
    """Tribometer with changes; by Coulomb's law where a direction within the plane comes without a model."""
    named = any(change.startswith("friction.model=") for change in changes)
    within = any(change.startswith(WITHIN) and not change.endswith(("normal", "perpendicular")) for change in changes)
    return read_rig(RIGS / "tribometer.toml", changes=[*changes, *([COULOMB] if within and not named else [])])


def coulomb(*changes: str) -> float:
    return friction_point(tribometer("friction.model=coulomb", *changes)).friction_ratio


def peak_velocity(rig: Rig) -> float:
    assert rig.vibration_amplitude is not None
    assert rig.drive is not None
    return 2 * np.pi * rig.drive.frequency * rig.vibration_amplitude


def test_along_and_across_have_the_closed_forms() -> None:
    rig = tribometer()
    zeta = rig.sliding_speed / peak_velocity(rig)
    m = 1 / (1 + zeta**2)
    assert coulomb("vibration.direction=along") == approx(2 / np.pi * np.arcsin(zeta), rel=1e-9)
    assert coulomb("vibration.direction=across") == approx(2 / np.pi * np.sqrt(1 - m) * ellipk(m), rel=1e-9)


def test_the_example_along_the_sliding_reaches_the_printed_reduction() -> None:
    point = friction_point(read_rig(RIGS / "vibrating_base.toml"))
    assert point.friction_ratio == approx(2 / np.pi * np.arcsin(0.62 / 6.64), rel=1e-3)
    assert point.friction_reduction == approx(0.9, abs=0.05)  # D 1.3.1, of Gutowski and Leus


def test_a_ring_turns_by_the_mean_over_its_directions() -> None:
    rig = tribometer()
    expected = torsional_vibration_ratio(sliding_speed=rig.sliding_speed, vibration_velocity=peak_velocity(rig))
    found = coulomb("vibration.direction=torsional", "vibration.torsion_radius=2mm")
    assert found == approx(float(expected), abs=1e-6)


@pytest.mark.parametrize(("angle", "word"), [("0 deg", "along"), ("90 deg", "across"), ("180 deg", "along")])
@pytest.mark.parametrize("model", ["coulomb", "asperity_stick_slip"])
def test_an_angle_becomes_the_word(angle: str, word: str, model: str) -> None:
    by_angle, by_word = (
        friction_point(tribometer(f"friction.model={model}", change)).friction_ratio
        for change in (f"vibration.vibration_direction={angle}", f"vibration.direction={word}")
    )
    assert by_angle == approx(by_word, abs=3e-4)


@pytest.mark.parametrize(("word", "other"), SAME_DIRECTION.items())
def test_words_of_the_literature_mean_the_same(word: str, other: str) -> None:
    assert tribometer(f"vibration.direction={word}").direction == tribometer(f"vibration.direction={other}").direction


def test_nothing_said_is_along_the_normal_and_changes_no_number() -> None:
    assert tribometer().direction == NORMAL == VibrationDirection(direction="perpendicular")
    plain, said = (friction_point(tribometer(*each)) for each in ((), ("vibration.direction=normal",)))
    same(plain, said)


@pytest.mark.parametrize("model", ["asperity_stick_slip", "bristle_with_holder"])
@pytest.mark.parametrize("source", ["measured", "computed"])
def test_a_second_component_along_is_the_in_plane_fraction_of_old_files(model: str, source: str) -> None:
    common = (f"friction.model={model}", f"vibration.amplitude_source={source}")
    old = tribometer(*common, "friction.in_plane_fraction=0.3", "friction.in_plane_phase=40deg")
    new = tribometer(
        *common, "vibration.second_direction=along", "vibration.second_fraction=0.3", "vibration.second_phase=40deg"
    )
    assert friction_point(new).friction_ratio == approx(friction_point(old).friction_ratio, rel=1e-9)
    assert resolved_rig(old).direction == resolved_rig(new).direction
    voltage: dict[str, Any] = {"voltage_peak_to_peak": [5.0, 15.0], "voltage_offset": [2.5, 7.5]}
    one, other = (point_batch(rig, **voltage).numbers["friction_ratio"] for rig in (old, new))
    assert other == approx(one, rel=1e-9)


def test_a_second_amplitude_is_the_fraction_of_the_main_one() -> None:
    by_size, by_fraction = (
        tribometer("vibration.second_direction=across", f"vibration.{change}").direction
        for change in ("second_amplitude=0.5um", "second_fraction=0.2")
    )
    assert by_size.second_fraction == approx(by_fraction.second_fraction)


def test_a_normal_second_component_of_an_in_plane_vibration_is_the_same_ellipse() -> None:
    """A main part along with a second one along the normal, and the other way round, scaled and delayed."""
    one = tribometer(
        SPRINGS,
        "vibration.direction=along",
        "vibration.second_direction=normal",
        "vibration.second_fraction=0.5",
        "vibration.second_phase=50deg",
    )
    other = tribometer(
        "vibration.vibration_amplitude=1.25um", "vibration.second_direction=along", "vibration.second_fraction=2",
        "vibration.second_phase=-50deg", "vibration.amplitude_source=measured",
    )  # fmt: skip
    motion = steady_vibration(one).motions[0]
    sine = steady_vibration(other).motions[0]
    assert np.ptp(motion.displacement) / 2 == approx(1.25e-6, rel=1e-9)
    assert friction_point(one).friction_ratio == approx(friction_point(other).friction_ratio, abs=0.02)
    assert np.ptp(sine.displacement) / 2 == approx(1.25e-6, rel=0.02)  # of a structure, nearly a sine


def test_little_of_a_second_component_changes_little() -> None:
    alone = coulomb("vibration.direction=along")
    with_little = coulomb(
        "vibration.direction=along", "vibration.second_direction=across", "vibration.second_fraction=1e-6"
    )
    assert with_little == approx(alone, abs=1e-4)


@pytest.mark.parametrize("direction", ["along", "across"])
def test_no_amplitude_leaves_friction_as_it_is(direction: str) -> None:
    for model in ("coulomb", "asperity_stick_slip"):
        rig = tribometer(
            f"friction.model={model}", f"vibration.direction={direction}", "vibration.vibration_amplitude=0um"
        )
        assert friction_point(rig).friction_ratio == approx(1.0, abs=1e-3)


def test_sweeps_of_amplitude_and_speed_carry_the_direction() -> None:
    rig = read_rig(RIGS / "tribometer.toml", changes=["friction.model=coulomb", "vibration.direction=along"])
    speeds = np.array([0.05, 0.2, 0.5])
    points = operating_points(rig, sliding_speed=speeds)
    assert points.friction_ratio == approx(2 / np.pi * np.arcsin(np.minimum(speeds / peak_velocity(rig), 1)), rel=1e-9)
    assert np.ptp(points.mean_displacement) == 0


def test_a_tip_that_moves_within_the_plane_has_its_amplitude_computed() -> None:
    rig = tribometer("friction.model=coulomb", "vibration.direction=along", "vibration.amplitude_source=computed")
    point = friction_point(rig)
    assert "the tip free within the plane" in point.amplitude_origin
    halved = friction_point(rig.replace("drive.voltage_peak_to_peak", "14 V"))
    assert halved.vibration_amplitude == approx(point.vibration_amplitude / 2, rel=1e-12)


def test_the_motion_shows_every_component() -> None:
    rig = tribometer("vibration.direction=across", "vibration.second_direction=normal", "vibration.second_fraction=0.1")
    arrays = simulation_arrays(rig, simulate(rig))
    assert np.ptp(arrays["displacement_across"].to_numpy()) / 2 == approx(2.5e-6, rel=1e-4)
    assert np.ptp(arrays["displacement"].to_numpy()) / 2 == approx(0.25e-6, rel=1e-4)
    assert "displacement_along" not in arrays


def test_what_a_direction_was_tested_with_is_said_first() -> None:
    along, across = (
        friction_point(tribometer("friction.model=coulomb", f"vibration.direction={word}"))
        for word in ("along", "across")
    )
    assert "of seven published points it differs from two" in along.caveats[0]
    assert "theory alone" in across.caveats[0]
    assert "compared with no experiment" in across.caveats[0]


def test_wear_within_the_plane_has_no_number() -> None:
    point = wear_point(tribometer("vibration.direction=along"))
    assert np.isnan(point.wear_rate_ratio)
    assert "the wear models are of vibration along the normal" in (point.reason or "")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (["vibration.direction=sideways"], "vibration.direction"),
        (["vibration.direction=torsional"], "needs torsion_radius"),
        (["vibration.torsion_radius=2mm"], 'torsion_radius belongs to direction "torsional"'),
        (["vibration.second_direction=along"], "needs second_amplitude or second_fraction"),
        (["vibration.second_fraction=0.2"], "give second_direction too"),
        (["vibration.second_direction=normal", "vibration.second_fraction=0.2"], "that of the vibration itself"),
        (["vibration.direction=along", "friction.in_plane_fraction=0.2", SPRINGS], "say the same twice"),
        (
            ["vibration.direction=across", "friction.model=dong_2015_half_period"],
            "friction.model: dong_2015_half_period has no law for a vibration across",
        ),
        (["vibration.direction=along", "friction.model=kinematic"], "take asperity_stick_slip or bristle_with_holder"),
        (["vibration.direction=torsional", "vibration.torsion_radius=2um"], "by more than 0.1 rad"),
    ],
)
def test_a_direction_without_meaning_is_refused_in_one_line(changes: list[str], message: str) -> None:
    with raises(SonolubeError) as refusal:
        tribometer(*changes)
    assert message in str(refusal.value)
    assert "\n" not in str(refusal.value)


def _dahl_within_the_plane(rig: Rig, angle: float) -> float:
    """Friction ratio of Dahl's law at an angle under a constant load, by integration over many periods."""
    rest = separation(rig.contact, normal_load=rig.normal_load)
    assert rig.friction_coefficient is not None
    stiffness = float(mindlin_tangential_stiffness(rig.contact, separation=rest))
    limit, peak = rig.friction_coefficient * rig.normal_load, peak_velocity(rig)
    assert rig.drive is not None
    omega = 2 * np.pi * rig.drive.frequency

    def rate(turn: float, state: np.ndarray) -> list[float]:
        v = np.array([rig.sliding_speed + peak * np.cos(turn) * np.cos(angle), peak * np.cos(turn) * np.sin(angle)])
        change = (v - np.hypot(*v) * state[:2] / limit) * stiffness / omega
        return [*change, state[0] / limit / (2 * np.pi)]

    state = np.zeros(3)
    for _ in range(30):
        period = solve_ivp(rate, (0, 2 * np.pi), [*state[:2], 0.0], method="LSODA", rtol=1e-8, atol=1e-9, max_step=0.01)
        state = period.y[:, -1]
    return float(state[2])


@pytest.mark.parametrize("degrees", [40.0, 90.0])
def test_a_bristle_with_dahls_exponent_has_the_ratio_of_a_long_integration(degrees: float) -> None:
    rig = tribometer(BRISTLE, "friction.dahl_exponent=1", f"vibration.vibration_direction={degrees}deg")
    expected = _dahl_within_the_plane(rig, np.radians(degrees))
    assert friction_point(rig).friction_ratio == approx(expected, abs=1e-3)


def test_a_bristle_that_is_elastic_up_to_its_limit_takes_every_direction_and_keeps_more_than_coulomb_has() -> None:
    ring = ["vibration.direction=torsional", "vibration.torsion_radius=5mm"]
    for changes in (["vibration.direction=across"], ["vibration.vibration_direction=40deg"], ring):
        ratio = friction_point(tribometer(BRISTLE, *changes)).friction_ratio
        assert coulomb(*changes) < ratio < 1


def test_a_bristle_on_an_elastic_holder_refuses_across_in_one_line() -> None:
    rig = tribometer(BRISTLE, "friction.holder_stiffness=1e6N/m", "vibration.direction=across")
    with raises(SonolubeError, match=r"leave friction.holder_stiffness out for a rigid one") as refusal:
        friction_point(rig)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"direction": "along", "vibration_direction": "3 deg"}, "give either direction or vibration_direction"),
        ({"second_direction": "along", "second_fraction": 0.2, "second_amplitude": "1 um"}, "got both"),
    ],
)
def test_a_file_says_a_thing_once(entries: dict[str, Any], message: str) -> None:
    content = tribometer().content()
    content["vibration"] |= entries
    with raises(InvalidInput, match=message):
        rig_from(content)


def test_an_angle_takes_the_place_of_a_word_and_of_another_size() -> None:
    rig = read_rig(RIGS / "vibrating_base.toml", changes=["vibration.vibration_direction=20deg"])
    assert rig.direction.angle == approx(np.radians(20))
    assert rig.replace("vibration.direction", "across").direction.angle == approx(np.pi / 2)
    assert tribometer("friction.model=coulomb", "vibration.direction=30 deg").direction.angle == approx(np.radians(30))
    second = tribometer("vibration.second_direction=across", "vibration.second_fraction=0.2")
    assert second.replace("vibration.second_amplitude", "1 um").direction.second_fraction == approx(0.4)


def test_a_direction_within_the_plane_asks_for_a_model() -> None:
    with raises(InvalidInput, match=r"friction\.model: missing; of a vibration along the sliding take coulomb"):
        read_rig(RIGS / "tribometer.toml", changes=["vibration.direction=along"])


def test_springs_of_normal_vibration_miss_what_littmann_measured_along() -> None:
    """The lowest ratio by the memory length of vibration along the normal, against a reduction of up to 70 %."""
    printed = ("drive.frequency=60kHz", "vibration.vibration_amplitude=0.6897um", "sliding.sliding_speed=1mm/s")
    by = {
        name: friction_point(read_rig(RIGS / "vibrating_base.toml", changes=[*printed, f"friction.model={name}"]))
        for name in ("asperity_stick_slip", "coulomb")
    }
    assert by["asperity_stick_slip"].friction_ratio == approx(0.635, abs=0.01)
    assert by["coulomb"].friction_ratio < 0.3
    assert "at least 0.63" in by["asperity_stick_slip"].caveats[0]


def test_friction_within_the_plane_heats_by_its_whole_path() -> None:
    """Power along the sliding by its closed form; the mean force alone would be far less."""
    rig = tribometer("vibration.direction=along")
    solid = thermal_solid("aluminium_2024")
    given: dict[str, Any] = {"pin": solid, "disc": solid, "heat_capacity": 5.0, "thermal_conductance": 0.1}
    point = temperature_point(rig, **given, duration=60.0)
    zeta = rig.sliding_speed / peak_velocity(rig)
    path = 2 / np.pi * (np.arcsin(zeta) + np.sqrt(1 / zeta**2 - 1))
    dry = rig.friction_coefficient * rig.normal_load * rig.sliding_speed
    assert point.frictional_heat_rate + point.vibration_heat_rate == approx(path * dry, rel=1e-4)
    assert temperature_point(rig, **given, duration=60.0, vibration_heat_rate=0.5).vibration_heat_rate == 0.5
    springs = tribometer("vibration.direction=along", SPRINGS)
    with raises(InvalidInput, match=r"give that heat as vibration_heat, or take friction\.model coulomb"):
        temperature_point(springs, **given, duration=60.0)


KNOWN: dict[str, Any] = {"pin": "m50", "disc": "m50", "load": "5N", "speed": "0.2m/s", "frequency": "20kHz"}


@pytest.mark.parametrize(
    ("given", "angle"),
    [({"direction": "along"}, 0.0), ({"direction": "transverse"}, np.pi / 2), ({"direction": "30deg"}, np.pi / 6)],
)
def test_a_new_rig_states_its_direction_and_takes_coulombs_law(given: dict[str, Any], angle: float) -> None:
    rig = sl.new(**KNOWN, amplitude="3um", **given).rig
    assert rig.direction.angle == approx(angle)
    assert rig.friction_model.name == "coulomb"


def test_a_new_ring_has_its_radius_and_a_normal_one_nothing_new() -> None:
    ring = sl.new(**KNOWN, amplitude="3um", direction="torsional", torsion_radius="5mm").rig
    assert ring.direction.torsion_radius == approx(5e-3)
    plain, said = (sl.new(**KNOWN, amplitude="3um", **each).rig_text for each in ({}, {"direction": "normal"}))
    assert plain == said
    for given, message in (
        ({"direction": "torsional"}, "needs torsion_radius"),
        ({"direction": "along", "torsion_radius": "5mm"}, "leave it out"),
        ({"direction": "sideways"}, "unknown direction of vibration 'sideways'"),
        ({"direction": "3 mm"}, "direction"),
    ):
        with raises(SonolubeError, match=message):
            sl.new(**KNOWN, amplitude="3um", **given)


def test_what_needs_the_motion_along_the_normal_refuses_and_says_what_to_do() -> None:
    rig = tribometer("vibration.direction=along", "vibration.amplitude_source=computed")
    with raises(InvalidInput, match=r"the vibration is along the sliding; use friction or simulate"):
        _ = resolved_rig(rig).moved


@pytest.mark.parametrize(
    ("direction", "components"),
    [
        (VibrationDirection(direction="normal"), (1, 0, 0)),
        (VibrationDirection(direction="along"), (0, 1, 0)),
        (VibrationDirection(direction="across"), (0, 0, 1)),
        (VibrationDirection(direction="oblique", vibration_direction=np.pi / 6), (0, np.sqrt(3) / 2, 0.5)),
        # a second one of a fifth, a quarter of a period late
        (
            VibrationDirection(
                direction="normal", second_direction="along", second_fraction=0.2, second_phase=np.pi / 2
            ),
            (1, -0.2j, 0),
        ),
    ],
)
def test_components_of_a_direction_are_those_of_its_unit_vector(
    direction: VibrationDirection, components: tuple[complex, complex, complex]
) -> None:
    assert direction.components() == approx(components)


def test_runs_of_another_direction_than_their_rig_are_refused_by_their_words() -> None:
    require_same_direction(frozenset({"normal"}), NORMAL, title="runs")
    require_same_direction(frozenset(), NORMAL, title="runs")
    with raises(InvalidInput, match=r"^runs: vibrates .*; leave out runs with the direction torsional$"):
        require_same_direction(frozenset({"normal", "torsional"}), NORMAL, title="runs")


def test_the_distances_of_coulombs_law_from_published_points_are_those_that_are_said() -> None:
    above = []
    for name in ("littmann_2001", "gutowski_2012", "luo_2024"):
        (rig,) = tomllib.loads((PUBLISHED / f"{name}.toml").read_text(encoding="utf-8"))["rigs"]
        for point in rig["points"]:
            stated = rig | point
            velocity = stated.get("vibration_velocity") or f"{2 * np.pi * 0.35e-6 * 26e3!r} m/s"
            speed, peak = (to_si(text, unit="m/s", name="") for text in (stated["sliding_speed"], velocity))
            measured = stated.get("friction_ratio", 1 - stated.get("friction_reduction", np.nan))
            if "reduced_friction_force" in stated:
                reduced, intrinsic = (
                    to_si(stated[f"{kind}_friction_force"], unit="N", name="") for kind in ("reduced", "intrinsic")
                )
                measured = reduced / intrinsic
            above.append(float(measured - 2 / np.pi * np.arcsin(min(speed / peak, 1.0))))
    few, slow = above[:2], above[2:]
    assert len(slow) == 5
    assert max(map(abs, few)) <= 0.045
    assert (round(min(slow), 2), round(max(slow), 2)) == (0.09, 0.15)
