"""Parts by name and size, files of other programs and commands by hand-made functions: units, refusals, defaults."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of
from tests.tasks.running import running

from sonolube.errors import InvalidInput, UnknownName
from sonolube.studies import study_horn_face
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.horn import horns
from sonolube.tasks.impedance import computed_impedance as impedance
from sonolube.tasks.parts import foreign_modes as foreign, modes, named_parts as parts


def block(*, length: float, width: float = 0.02, ceramic: str = "pic255") -> Any:
    return SimpleNamespace(length=length, width=width, ceramic=ceramic)


def test_sizes_are_in_si_known_and_whole() -> None:
    assert parts.sizes_in_si("bar", block, {"length": "127 mm"}) == {"length": approx(0.127)}
    assert parts.sizes_in_si("bar", block, {"length": 0.5, "width": "2 cm"}) == {"length": 0.5, "width": approx(0.02)}
    with raises(UnknownName, match="unknown size of a bar 'lenght'; did you mean length"):
        parts.sizes_in_si("bar", block, {"lenght": "1 m"})
    with raises(UnknownName, match="unknown size of a bar 'ceramic'"):
        parts.sizes_in_si("bar", block, {"ceramic": "1 m"})
    with raises(InvalidInput, match=r"^a bar needs length; give each by sizes, such as length=20mm$"):
        parts.sizes_in_si("bar", block, {"width": 0.1})


@pytest.mark.parametrize(("length", "is_taken"), [(0.99e6, True), (1.01e6, False), (1.01e-6, True), (0.99e-6, False),
                                                  (-1.01e6, False), (0.0, True)])  # fmt: skip
def test_a_size_beyond_any_part_is_refused(length: float, is_taken: bool) -> None:
    if is_taken:
        assert parts.sizes_in_si("bar", block, {"length": length}) == {"length": length}
    else:
        with raises(InvalidInput, match=r"lies beyond any part$"):
            parts.sizes_in_si("bar", block, {"length": length})


@pytest.mark.parametrize(("part", "found"), [("a.STEP", True), (Path("b.stp"), True), (NamedBytes("c.step", b""), True),
                                             ("block", False), ("a.step.csv", False)])  # fmt: skip
def test_a_step_file_is_known_by_its_ending(part: Any, found: bool) -> None:
    assert parts.is_step(part) is found
    with raises(InvalidInput, match=r"^own\.step has its sizes, and takes no other: leave a, b out$"):
        parts.step_part("own.step", {"a": 1, "b": 2})


def test_a_material_is_described_with_what_replaces_its_properties() -> None:
    assert parts._described("brass", {}) == "brass"
    assert parts._described("brass", {"density": 8400.0, "poisson_ratio": 0.3}) == (
        "brass with density 8400 kg/m3, poisson ratio 0.3"
    )


def test_a_medium_takes_the_properties_that_are_given_and_no_ceramic(monkeypatch: MonkeyPatch) -> None:
    solid = SimpleNamespace(name="brass", value=lambda name: {"youngs_modulus": 1e11, "density": 8e3}[name])
    monkeypatch.setattr(parts, "material", lambda name: solid)
    monkeypatch.setattr(parts, "piezo_ceramic_names", lambda: ("pic255",))
    monkeypatch.setattr(names_of(parts).fem, "isotropic_medium", lambda **named: named)
    monkeypatch.setattr(names_of(parts).fem, "medium_from_material", lambda found: found)
    medium: Any = parts.solid_medium("bar", "brass", {"poisson_ratio": 0.3, "density": 7e3})
    assert medium == {
        "youngs_modulus": 1e11, "poisson_ratio": 0.3, "density": 7e3,
    }  # fmt: skip
    whole: Any = parts.solid_medium("bar", "brass", {})
    assert whole is solid
    solid.name = "pic255"
    with raises(InvalidInput, match=r"^material pic255: a piezoelectric ceramic needs .* compute bar --ceramic pic255"):
        parts.solid_medium("bar", "pic255", {})


def test_a_transducer_takes_the_wiring_that_it_has_and_a_part_the_usual_one(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "transducers", lambda: {"stack": block})
    found: Any = parts.named_transducer("stack", {"length": "1 cm"}, ceramic="pzt", poled=None)
    assert (found.length, found.ceramic) == (approx(0.01), "pzt")
    with raises(InvalidInput, match=r"^drive \+z: stack has its own; leave it out, or take another part$"):
        parts.named_transducer("stack", {"length": 1.0}, drive="+z")
    monkeypatch.setattr(parts, "named_part", lambda part, sizes: (part, sizes))
    monkeypatch.setattr(names_of(parts).fem, "poled_part", lambda geometry, **named: (geometry, named))
    assert parts.named_transducer("block", {}, poled="x", ground=None) == (  # type: ignore[comparison-overlap]
        ("block", {}), {"ceramic": "pic255", "along": "x", "driven": "+z", "grounded": "-z"},
    )  # fmt: skip
    with raises(InvalidInput, match=r"^contact tip: block has no drive; it is for transducers: stack$"):
        modes._require_output("block", {}, "tip")
    monkeypatch.setattr(parts, "named_transducer", lambda part, sizes: SimpleNamespace(outputs={"tip": 1}))
    modes._require_output("stack", {}, "tip")
    with raises(UnknownName, match="unknown output of stack 'tup'; did you mean tip"):
        modes._require_output("stack", {}, "tup")


def test_points_are_three_columns_in_millimetres(tmp_path: Path) -> None:
    path = tmp_path / "p.csv"
    path.write_text("1,2,3\n4,5,6\n")
    assert modes._points_in_metres(path) == approx(np.array([[1e-3, 2e-3, 3e-3], [4e-3, 5e-3, 6e-3]]))
    for text, count in (("1,2\n", 2), ("1,2,nan\n", 3)):
        path.write_text(text)
        with raises(InvalidInput, match=f"needs the three columns x, y and z in mm, got {count}$"):
            modes._points_in_metres(path)


def test_a_body_on_the_contact_has_mass_spring_and_damper() -> None:
    with running(modes.modes, body_mass="2 kg"):
        found = modes._body("2 kg", "3 N/m", 4.0)
    assert found is not None
    assert (found.body_mass, found.spring_stiffness, found.viscous_damping) == approx((2.0, 3.0, 4.0))
    assert modes._body(None, "0N/m", "0N s/m") is None


def test_a_command_has_sizes_and_given_choices_with_units() -> None:
    with running(modes.modes, count=4, clamp=["-x", "+x"], body_mass=2.0, tolerance="1 %"):
        assert modes._command("block", {"length": 0.1, "width": "2 cm"}) == (
            "sonolube modes block --set length=0.1m --set 'width=2 cm' --count 4 --clamp -x --clamp +x"
            " --tolerance '1 %' --body-mass 2.0kg"
        )
    assert foreign.typed("3 N", "N") == "3 N"
    assert foreign.typed(3.0, "N") == "3.0N"


def test_arguments_that_a_part_leaves_without_effect_are_refused() -> None:
    for given, part, points, contact, words in (
        ({"density": 1.0}, "stack", None, None, "density has no meaning for stack, which has its own"),
        ({"toward": "x"}, "block", None, None, "toward has no meaning without points"),
        ({"body_mass": 1.0}, "block", None, None, "body_mass has no meaning without contact"),
    ):
        with running(modes.modes, **given), raises(InvalidInput, match=f"^{words}"):
            modes._refuse_unused(part, points=points, contact=contact)
    with running(modes.modes, density=1.0, toward="x", body_mass=1.0):
        modes._refuse_unused("block", points="p.csv", contact="tip")


def test_pictures_are_numbered_among_the_elastic_modes(monkeypatch: MonkeyPatch) -> None:
    found = SimpleNamespace(modes=SimpleNamespace(rigid_body_count=2), natural_frequency=np.zeros(4))
    solved: Any = SimpleNamespace(
        found=found, part=SimpleNamespace(name="a/bar.step", assumptions={"x": "y"}), names=["r", "r", "axial 1", "b 2"]
    )
    monkeypatch.setattr(names_of(modes).mode_files, "shapes_table", lambda *each, direction: f"table {direction}")
    monkeypatch.setattr(names_of(modes).mode_files, "modes_grid", lambda *each: "grid")
    monkeypatch.setattr(names_of(modes).mode_files, "mode_animation", lambda surface, *, title: title.encode())
    monkeypatch.setattr(names_of(modes).mode_files, "mode_title", lambda found, names, row: names[row])
    monkeypatch.setattr(modes.ModesAnswer, "_surface", lambda self, row: row)
    values: dict[str, Any] = {"solved": solved, "direction": "z"}
    plain = modes.ModesAnswer(**values, points=None, with_grid=False, with_animations=False, structure=None)
    assert list(plain.figures()) == ["bar-1-axial-1", "bar-2-b-2"]
    assert (plain.files(), plain.assumptions()) == ({}, {"x": "y"})
    full = modes.ModesAnswer(**values, points=np.zeros((1, 3)), with_grid=True, with_animations=True, structure="s")
    assert full.files() == {
        "bar-shapes.csv": "table z", "bar-modes.toml": "s", "bar-modes.vtu": "grid", "bar-1-axial-1.gif": b"axial 1",
        "bar-2-b-2.gif": b"b 2",
    }  # fmt: skip


@pytest.mark.parametrize(("places", "count", "is_taken"), [(["1"], None, True), ([], None, False), ("1", None, True),
                                                           (["1", "2"], 2, True), (["1"], 2, False),
                                                           (["1", "2", "3"], 2, False)])  # fmt: skip
def test_places_are_one_or_more_or_both_ends(places: Any, count: int | None, is_taken: bool) -> None:
    if is_taken:
        assert foreign._several("tip", places, count=count) == ([places] if isinstance(places, str) else places)
        return
    with raises(InvalidInput, match=rf"^needs tip, .*; got {len(places)}$") as refused:
        foreign._several("tip", places, count=count)
    assert refused.value.key == "tip"
    assert ("two nodes" in str(refused.value)) == (count == 2)


def test_units_of_a_file_are_given_both_or_none() -> None:
    assert foreign._unit_system(None, None) is None
    found = foreign._unit_system("mm", "N")
    assert found is not None
    assert (found.length_unit, found.force_unit) == ("mm", "N")
    with raises(InvalidInput, match=r"^needs force_unit, such as N, beside the unit of length$"):
        foreign._unit_system("mm", None)
    with raises(InvalidInput, match=r"^needs length_unit, such as mm"):
        foreign._unit_system(None, "N")


@pytest.mark.parametrize(
    ("position", "distance", "text"),
    [
        ([0.01, 0.0, -0.02], 0.0, "tip: node 7 at 10 mm, 0 m, -20 mm"),
        ([0.01, 0.0, 0.0], 1.1e-5, "tip: node 7 at 10 mm, 0 m, 0 m, 11 um from the point"),
        ([0.01, 0.0, 0.0], 0.9e-5, "tip: node 7 at 10 mm, 0 m, 0 m"),
        ([np.nan, 0.0, 0.0], 0.0, "tip: node 7"),
    ],
)
def test_a_node_that_was_taken_is_said_with_its_place_and_distance(
    position: list[float], distance: float, text: str
) -> None:
    node: Any = SimpleNamespace(row=1, number=7, distance=distance)
    file: Any = SimpleNamespace(position=np.array([[0.0, 0.0, 0.0], position]))
    assert foreign._place("tip", node, file) == text


def test_what_a_file_leaves_out_is_said_with_its_size_where_it_can_be_told(monkeypatch: MonkeyPatch) -> None:
    lists = {"natural_frequency": np.array([20e3, 40e3, 30e3])}
    monkeypatch.setattr(names_of(foreign).participation, "kept_compliance", lambda found: 4e-9)
    monkeypatch.setattr(names_of(foreign).participation, "truncated_compliance", lambda found: 1e-9)
    text = foreign._truncation(lists)
    assert text.startswith(
        "modes above 40 kHz are left out: their static compliance at the contact is missing, about 1e"
    )
    assert "beside 4e-09 m/N" in text
    monkeypatch.setattr(names_of(foreign).participation, "truncated_compliance", lambda found: np.nan)
    assert "is missing, and the clamped" in foreign._truncation(lists)


def test_a_table_states_its_capacitance_or_the_user_does(monkeypatch: MonkeyPatch) -> None:
    content: dict[str, Any] = {"natural_frequency": [1.0, 2.0]}
    monkeypatch.setattr(foreign, "read_modes", lambda path, *, force_per_volt: dict(content))
    lists, capacitance = foreign._of_table(Path("a.csv"), None, 3e-9)
    assert (lists["natural_frequency"].tolist(), capacitance) == ([1.0, 2.0], 3e-9)
    content["clamped_capacitance"] = "4 nF"
    assert foreign._of_table(Path("a.csv"), None, None)[1] == approx(4e-9)
    content["clamped_capacitance"] = 5e-9
    assert foreign._of_table(Path("a.csv"), None, None)[1] == approx(5e-9)
    with raises(InvalidInput, match=r"^a\.csv: states clamped_capacitance; leave out clamped_capacitance$"):
        foreign._of_table(Path("a.csv"), None, 3e-9)


def test_the_tension_of_a_rod_is_stated_or_follows_from_its_torque() -> None:
    assert impedance._tension("stack", {}, None, None, 0.2) == 0.0
    assert impedance._tension("stack", {}, 500.0, None, 0.2) == approx(500.0)
    # torque over nut factor and thread: 6 N m over 0.2 and 6 mm
    assert impedance._tension("stack", {"rod_radius": "3 mm"}, None, 6.0, 0.2) == approx(5000.0)
    assert impedance._tension("stack", {"rod_radius": 0.003}, None, 6.0, 0.3) == approx(6 / 0.3 / 0.006)
    for part, sizes in (("cutter_head", {"rod_radius": 0.003}), ("stack", {})):
        with raises(InvalidInput, match=r"^torque needs the thread of a stack with rod_radius") as refused:
            impedance._tension(part, sizes, None, 6.0, 0.2)
        assert refused.value.key == "torque"


def test_a_stress_needs_a_working_end_and_a_preload_a_rod() -> None:
    transducer: Any = SimpleNamespace(outputs={"tip": 1}, geometry=SimpleNamespace(regions=("stack",)))
    impedance._require_stressed("stack", transducer, is_preloaded=False)
    with raises(InvalidInput, match=r"^preload: stack has no rod that preloads its stack; set rod_radius$"):
        impedance._require_stressed("stack", transducer, is_preloaded=True)
    transducer.geometry.regions = ("stack", names_of(impedance).ROD)
    impedance._require_stressed("stack", transducer, is_preloaded=True)
    transducer.outputs = {}
    with raises(InvalidInput, match=r"^amplitude: stack has no working end in line with its stack$"):
        impedance._require_stressed("stack", transducer, is_preloaded=False)


def test_a_preload_is_stated_once_and_at_an_amplitude() -> None:
    for given, amplitude, torque, words in (
        ({"preload": 1.0}, None, None, "preload has no meaning without amplitude"),
        ({"nut_factor": 0.3}, 1e-6, None, "nut_factor has no meaning without torque"),
        ({"preload": 1.0, "torque": 2.0}, 1e-6, 2.0, "preload has no meaning beside torque; give one of them"),
    ):
        with running(impedance.compute, **given), raises(InvalidInput, match=f"^{words}"):
            impedance._refuse_unused(amplitude, torque)
    with running(impedance.compute, torque=2.0, nut_factor=0.3):
        impedance._refuse_unused(1e-6, 2.0)


def test_the_ceramic_is_that_given_or_the_usual_one_of_a_part_or_transducer(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(impedance, "transducers", lambda: {"stack": lambda *, ceramic="pzt8": None})
    assert impedance._ceramic_of("stack", "own") == "own"
    assert impedance._ceramic_of("stack", None) == "pzt8"
    assert impedance._ceramic_of("block", None) == "pic255"


def impedance_answer(**more: Any) -> Any:
    pulled = SimpleNamespace(highest_stack_stress=5e6)
    values: dict[str, Any] = {
        "part": "a/own.step", "ceramic": "pic255", "spectra": {}, "measured": None, "with_modes": False,
        "amplitude": None, "preload": 500.0, "by_torque": False,
        "transducer": SimpleNamespace(dimensions=[SimpleNamespace(name="l", source="D", printed=True),
                                                  SimpleNamespace(name="w", source="guess", printed=False)]),
    }  # fmt: skip
    found = impedance.ImpedanceAnswer(**(values | more))
    found.__dict__["stresses"] = {"free": {"axial 1": pulled, "axial 2": SimpleNamespace(highest_stack_stress=0.0)}}
    return found


def test_a_stack_in_tension_under_its_preload_and_a_preload_by_torque_are_caveats() -> None:
    (line,) = impedance_answer().caveats()
    assert line.startswith("axial 1 (free): the stack is in tension by 5 MPa; ceramics and joints bear")
    assert impedance_answer(preload=0.0).caveats() == []
    by_torque = impedance_answer(by_torque=True).caveats()
    assert by_torque[1:] == ["the preload of 500 N follows from a torque, within about 30 %"]
    assert impedance_answer().assumptions() == {"w": "guess"}
    assert list(impedance_answer().figures()) == ["own-impedance"]
    assert impedance_answer()._stress_blocks() == ()


def test_arguments_of_a_face_are_positive_and_a_face_that_drives_nowhere_is_a_caveat(monkeypatch: MonkeyPatch) -> None:
    with running(horns.face, frequency="20 kHz"):
        assert horns._positive(frequency="20 kHz", amplitude=1e-6) == approx([20e3, 1e-6])
        with raises(InvalidInput, match=r"^amplitude must be positive$"):
            horns._positive(frequency="20 kHz", amplitude=0.0)
    friction: Any = SimpleNamespace(position=np.array([0.0, 1.0]), ratio=np.array([0.5, -0.5]))
    answer = horns.FaceAnswer(horn="steel", face=study_horn_face("steel"), friction=friction)
    monkeypatch.setattr(horns, "transition_region", lambda friction: (0.0, 1.0))
    assert answer.caveats() == ()
    monkeypatch.setattr(horns, "transition_region", lambda friction: (0.0, float("nan")))
    assert len(answer.caveats()) == 1
    data = answer.dataset()
    assert data["friction_ratio"].values == approx([0.5, -0.5])
    assert list(answer.files()) == ["horn-steel-face.nc"]


@pytest.mark.parametrize(("change", "is_sharp"), [(0.2, False), (0.21, True)])
def test_a_peak_stress_that_changes_by_more_than_a_fifth_has_no_limit(change: float, is_sharp: bool) -> None:
    design: Any = SimpleNamespace(stress_change=change)
    answer = horns.HornAnswer(design=design, material=SimpleNamespace(), tool_mass=0.0, amplitude=None, name="h")  # type: ignore[arg-type]
    assert bool(answer.caveats()) == is_sharp
    if is_sharp:
        assert answer.caveats()[0].startswith("the peak stress changed by 21% with the last refinement")
