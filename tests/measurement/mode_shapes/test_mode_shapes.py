"""Modes of other programs: our own bar written in each format and read back, closed forms, CalculiX, refusals."""

import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
from pytest import approx, raises
from tests.mode_files import frd_text, write_universal_file

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.mode_shapes.formats import ModeShapes, UnitSystem, read_mode_shapes
from sonolube.measurement.mode_shapes.participation import (
    contact_participation,
    direction_vector,
    find_node,
    modal_lists,
    port_participation,
)
from sonolube.models.dynamics import Structure, contact_receptance, drive_receptance, modal_structure
from sonolube.models.fem import PARTS, Mesh, Model, box_mesh, generate_mesh, isotropic_medium, natural_modes

LENGTH, FORCE, CAPACITANCE = 0.06, 12.0, 4e-9
MILLIMETRES = UnitSystem(length_unit="mm", force_unit="N")
AT = np.geomspace(3e3, 60e3, 200)
QUALITY = 500.0
DIGITS = 5e-6  # half a step of the last of six digits; a frequency's changes a resonant term by 2 Q of that


@cache
def bar() -> tuple[Mesh, Floats, Floats]:
    """A bar of steel: mesh, frequencies of all modes, and shapes of a modal mass of 1 kg."""
    mesh = box_mesh(length=LENGTH, width=0.01, thickness=0.008, divisions=(8, 2, 2))
    steel = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)
    found = natural_modes(Model(mesh=mesh, media={"block": steel}), count=6)
    return mesh, found.natural_frequency, found.shapes


def structure(modes: ModeShapes, *, tip: str, port: tuple[str, str]) -> Structure:
    first, second = (find_node(modes, each, name="port") for each in port)
    outward = direction_vector("+x", name="direction")
    lists = modal_lists(
        modes,
        contact=contact_participation(modes, [find_node(modes, tip, name="tip")], outward=outward),
        drive=FORCE * port_participation(modes, (first, second), name="port"),
        quality_factor=QUALITY,
    )
    return modal_structure(
        frequencies=lists["natural_frequency"],
        damping_ratios=lists["damping_ratio"],
        drive_participation=lists["drive_participation"],
        contact_participation=lists["contact_participation"],
        clamped_capacitance=CAPACITANCE,
    )


def own_structure() -> Structure:
    """The same without a file: contact at the end, stack from the far end to the middle, along the axis."""
    mesh, frequency, shapes = bar()
    tip, back, middle = (int(np.argmin(np.linalg.norm(mesh.nodes - p, axis=1))) for p in ENDS)
    return modal_structure(
        frequencies=np.where(frequency < 1.0, 0.0, frequency),
        damping_ratios=np.where(frequency < 1.0, 0.0, 1e-3),
        drive_participation=FORCE * (shapes[:, middle, 0] - shapes[:, back, 0]),
        contact_participation=-shapes[:, tip, 0],
        clamped_capacitance=CAPACITANCE,
    )


ENDS = np.array([[LENGTH / 2, 0, 0], [-LENGTH / 2, 0, 0], [0, 0, 0]])
PLACES: dict[str, Any] = {"tip": "30, 0, 0 mm", "port": ("-3e-2 m, 0 m, 0 m", "0, 0, 0 mm")}


def exported(kind: str, folder: Path) -> ModeShapes:
    """The bar in mm, N and tonnes, shapes of a modal mass of one tonne and more, read back."""
    mesh, frequency, shapes = bar()
    scale = np.arange(1.0, len(shapes) + 1)
    numbers: dict[str, Any] = {
        "frequency": frequency,
        "position": 1e3 * mesh.nodes,
        "shape": scale[:, None, None] * shapes * np.sqrt(1e3),
        "mass": scale**2,
    }
    path = folder / f"bar.{kind}"
    if kind == "frd":
        path.write_text(frd_text(**numbers))
        return read_mode_shapes(path, units=MILLIMETRES)
    if kind == "15":
        write_universal_file(path, nodes=15, **numbers)
        return read_mode_shapes(path, units=MILLIMETRES)
    write_universal_file(path, factors=(1e3, 1.0), **numbers)
    return read_mode_shapes(path)


@pytest.mark.parametrize("kind", ["unv", "15", "frd"])
def test_a_bar_written_in_each_format_has_its_frequencies_participations_and_response(
    kind: str, tmp_path: Path
) -> None:
    mesh, frequency, shapes = bar()
    modes = exported(kind, tmp_path)
    assert modes.natural_frequency[:6] == approx(np.zeros(6))
    assert modes.natural_frequency[6:] == approx(frequency[6:], rel=1e-5)
    assert modes.modal_mass == approx(1e3 * np.arange(1.0, 13) ** 2, rel=1e-5)
    assert modes.position == approx(mesh.nodes, abs=1e-8)
    normal = modes.shape / np.sqrt(modes.modal_mass)[:, None, None]
    assert normal[6:] == approx(shapes[6:], abs=1e-5 * np.abs(shapes).max())
    read, own = structure(modes, **PLACES), own_structure()
    for response in (contact_receptance, drive_receptance):
        expected = response(own, frequency=AT)
        error = np.abs(response(read, frequency=AT) - expected)
        assert np.all(error < 2 * QUALITY * DIGITS * np.abs(expected) + 4 * DIGITS * np.abs(expected).max())


def test_a_stepped_horn_written_in_each_format_has_the_tip_that_it_was_written_with(tmp_path: Path) -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    sizes = {"length": 0.06, "end_length": 0.065, "radius": 0.02, "end_radius": 0.01}
    mesh = generate_mesh(PARTS["stepped_horn"](**sizes), element_size=0.02)
    steel = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)
    found = natural_modes(Model(mesh=mesh, media={mesh.regions[0]: steel}), count=6)
    elastic = slice(found.rigid_body_count, None)
    axis = int(np.argmax(np.ptp(mesh.nodes, axis=0)))
    face = mesh.face_nodes(f"+{'xyz'[axis]}")
    own = -found.shapes[:, face, axis].mean(axis=1)
    numbers: dict[str, Any] = {"frequency": found.natural_frequency, "position": mesh.nodes, "shape": found.shapes}
    write_universal_file(tmp_path / "horn.unv", factors=(1.0, 1.0), mass=np.ones(len(own)).tolist(), **numbers)
    (tmp_path / "horn.frd").write_text(frd_text(mass=np.ones(len(own)).tolist(), **numbers))
    for name, units in (("horn.unv", None), ("horn.frd", UnitSystem(length_unit="m", force_unit="N"))):
        modes = read_mode_shapes(tmp_path / name, units=units)
        tip = [find_node(modes, str(number + 1), name="tip") for number in face]
        read = contact_participation(modes, tip, outward=direction_vector(f"+{'xyz'[axis]}", name="direction"))
        assert modes.natural_frequency[elastic] == approx(found.elastic_frequency, rel=DIGITS)
        assert read[elastic] == approx(own[elastic], abs=2 * DIGITS * np.abs(found.shapes).max())
        responses = [
            contact_receptance(
                modal_structure(
                    frequencies=np.where(frequency > 1, frequency, 0.0),
                    damping_ratios=0.5 / QUALITY,
                    drive_participation=0 * tips,
                    contact_participation=tips,
                    clamped_capacitance=CAPACITANCE,
                ),
                frequency=AT,
            )
            for frequency, tips in ((modes.natural_frequency, read), (found.natural_frequency, own))
        ]
        error = np.abs(responses[0] - responses[1])
        assert np.all(error < 2 * QUALITY * DIGITS * np.abs(responses[1]) + 4 * DIGITS * np.abs(responses[1]).max())


def test_the_first_axial_mode_of_a_bar_has_the_participations_of_its_closed_form(tmp_path: Path) -> None:
    # cos(pi x/L) of a bar of the mass M has the modal mass M/2; its ends part by 2
    x = np.linspace(0, 1, 21)
    position, shape = np.zeros((21, 3)), np.zeros((1, 21, 3))
    position[:, 2], shape[0, :, 2] = 100 * x, np.cos(np.pi * x)
    mass = 0.3
    write_universal_file(
        tmp_path / "rod.unv", frequency=[25e3], position=position, shape=shape, mass=[0.5e-3 * mass], damping=[2e-3]
    )
    modes = read_mode_shapes(tmp_path / "rod.unv", units=MILLIMETRES)
    ends = find_node(modes, "1", name="port"), find_node(modes, "21", name="port")
    lists = modal_lists(
        modes,
        contact=contact_participation(modes, [ends[1]], outward=direction_vector("0,0,2", name="direction")),
        drive=FORCE * port_participation(modes, ends, name="port"),
    )
    assert lists["contact_participation"] == approx(np.sqrt(2 / mass))  # the end moves inwards: away
    assert lists["drive_participation"] == approx(-2 * FORCE * np.sqrt(2 / mass))
    assert lists["damping_ratio"] == approx(2e-3)
    back = port_participation(modes, (ends[1], ends[0]), name="port")
    assert back == approx(port_participation(modes, ends, name="port"))


def complex_file(path: Path, *, skew: float) -> None:
    """One complex mode of 1 kHz, 1 % damping and 2 kg, turned by 40 degrees, with a part out of phase."""
    omega = 2e3 * np.pi
    turn = np.exp(1j * np.radians(40))
    shape = turn * np.array([1.0, -0.5, 0.25]) + 1j * turn * skew * np.array([0.25, 0.5, 0.0])
    data: dict[str, Any] = {
        "eig": complex(-0.01 * omega, np.sqrt(1 - 1e-4) * omega),
        "modal_a": 2j * omega * 2.0 * turn**2,
        "modal_b": 0j,
    }
    sets = [
        pyuff.prepare_164(units_code=1, length=1.0, force=1.0, temp=1.0, temp_offset=0.0),
        pyuff.prepare_55(
            **{"model_type": 1, "analysis_type": 3, "data_ch": 2, "spec_data_type": 8, "data_type": 5},
            **{"n_data_per_node": 3, "load_case": 1, "mode_n": 1, "node_nums": [4, 5, 6]},
            **{"r1": shape, "r2": 0 * shape, "r3": 0 * shape},
            **data,
        ),
    ]
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")


@pytest.mark.parametrize(("skew", "caveats"), [(0.0, 0), (0.2, 1)])
def test_of_a_complex_mode_the_real_part_at_its_best_phase_is_taken(skew: float, caveats: int, tmp_path: Path) -> None:
    complex_file(tmp_path / "mode.unv", skew=skew)
    modes = read_mode_shapes(tmp_path / "mode.unv")
    assert modes.natural_frequency == approx([1e3], rel=1e-5)
    assert modes.damping_ratio == approx([0.01], rel=1e-4)
    assert modes.modal_mass == approx([2.0], rel=1e-5)
    assert modes.shape[0, :, 0] * np.sign(modes.shape[0, 0, 0]) == approx([1.0, -0.5, 0.25], abs=1e-5)
    assert len(modes.caveats) == caveats
    assert all("out of phase" in each for each in modes.caveats)
    with raises(InvalidInput, match="the file has no positions of nodes"):
        find_node(modes, "0,0,0mm", name="tip")


def test_a_hysteretic_loss_factor_is_twice_the_damping_ratio(tmp_path: Path) -> None:
    path = tmp_path / "bar.unv"
    write_universal_file(path, frequency=[1e3], position=np.eye(3), shape=np.ones((1, 3, 3)), mass=[1.0])
    text = path.read_text().replace(
        "1.00000e+00  0.00000e+00  0.00000e+00\n", "1.00000e+00  0.00000e+00  4.00000e-03\n"
    )
    path.write_text(text)
    assert read_mode_shapes(path, units=MILLIMETRES).damping_ratio == approx([2e-3])


def three_modes(path: Path, **changes: Any) -> Path:
    numbers: dict[str, Any] = {
        "frequency": [1e3, 2e3, 3e3],
        "position": 10 * np.arange(12.0).reshape(4, 3),
        "shape": np.arange(36.0).reshape(3, 4, 3),
        "mass": [1.0, 2.0, 3.0],
    }
    if path.suffix == ".frd":
        path.write_text(frd_text(**numbers | changes))
    else:
        write_universal_file(path, **numbers | changes)
    return path


@pytest.mark.parametrize(
    ("name", "changes", "units", "complaint"),
    [
        ("a.unv", {}, None, "states no units"),
        ("a.unv", {"factors": (1e3, 1.0)}, MILLIMETRES, "states its units in data set 164; leave out length_unit"),
        ("a.unv", {"factors": (0.0, 1.0)}, None, "164"),
        ("a.unv", {"frequency": [], "shape": []}, MILLIMETRES, "holds no mode shape"),
        ("a.unv", {"frequency": [1e3, -2e3, 3e3]}, MILLIMETRES, "a mode has a negative frequency"),
        ("a.unv", {"mass": [1.0, -2.0, 3.0]}, MILLIMETRES, "negative frequency, modal mass or damping"),
        ("a.unv", {"frequency": [1e3, np.nan, 3e3]}, MILLIMETRES, "is not finite"),
        ("a.frd", {}, None, "results of CalculiX have no units; give length_unit and force_unit"),
        ("a.frd", {"frequency": [], "shape": []}, MILLIMETRES, "holds no natural mode"),
        ("a.frd", {"frequency": [1e3, np.inf, 3e3]}, MILLIMETRES, "is not finite"),
        ("a.frd", {"shape": np.full((3, 4, 3), np.nan)}, MILLIMETRES, "not finite"),
    ],
)
def test_modes_without_what_a_structure_needs_are_refused_in_one_line(
    name: str, changes: dict[str, Any], units: UnitSystem | None, complaint: str, tmp_path: Path
) -> None:
    path = three_modes(tmp_path / name, **changes)
    with raises(InvalidInput, match=complaint) as refusal:
        read_mode_shapes(path, units=units)
    assert str(refusal.value).startswith(f"{path}: ")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        (" 2    1MODAL      1", " 2    1MODAL      2", "binary form"),
        (" -4  DISP ", " -4  DISPI", "complex modes"),
        (" -3\n 9999", " 9999", "has no end"),
        (" 2    1MODAL", " 0    1MODAL", ""),
        (" -1         4", " -1        x4", "cannot be read as CalculiX result"),
    ],
)
def test_a_damaged_result_of_calculix_is_refused_and_a_static_step_left_out(
    old: str, new: str, complaint: str, tmp_path: Path
) -> None:
    path = three_modes(tmp_path / "a.frd")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    if not complaint:
        assert read_mode_shapes(path, units=MILLIMETRES).natural_frequency == approx([2e3, 3e3])
        return
    with raises(InvalidInput, match=complaint):
        read_mode_shapes(path, units=MILLIMETRES)


def test_short_result_files_and_any_order_of_modes_are_read(tmp_path: Path) -> None:
    path = three_modes(tmp_path / "a.frd", frequency=[3e3, 1e3, 2e3])
    text = path.read_text()
    lines = [line[:3] + line[8:] if line[:3] == " -1" else line for line in text.splitlines()]
    heads = [line[:-1] + "0" if line[:6] in ("    2C", "  100C") else line for line in lines]
    (tmp_path / "short.frd").write_text("\n".join(heads))
    long, short = (read_mode_shapes(each, units=MILLIMETRES) for each in (path, tmp_path / "short.frd"))
    assert short.natural_frequency.tolist() == [1e3, 2e3, 3e3]
    assert short.modal_mass == approx([2e3, 3e3, 1e3])
    assert np.array_equal(short.shape, long.shape)
    assert np.array_equal(short.node, long.node)


@pytest.mark.parametrize(
    ("place", "complaint"),
    [
        ("5", "tip 5: no such node; numbers of nodes are 1 to 4"),
        ("9" * 30, "no such node"),
        ("1,2", "must be the number of a node, or a point"),
        ("tip", "must be the number of a node, or a point"),
        ("0,0,200mm", "the nearest node, 3 at 60 mm, 70 mm, 80 mm, is 151 mm away; the point lies outside the body"),
        ("0,0,1kg", "is a mass"),
        ("0,0,0", "unit"),
    ],
)
def test_a_place_without_a_node_is_refused(place: str, complaint: str, tmp_path: Path) -> None:
    modes = read_mode_shapes(three_modes(tmp_path / "a.unv"), units=MILLIMETRES)
    with raises(InvalidInput, match=complaint) as refusal:
        find_node(modes, place, name="tip")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("text", ["", "w", "1,0", "0,0,0", "1,nan,0", "+x,0,0", "1e400,0,0"])
def test_a_direction_that_is_none_is_refused(text: str) -> None:
    with raises(InvalidInput, match="must look like"):
        direction_vector(text, name="direction")


def test_what_a_file_does_not_state_is_asked_for_and_nothing_else(tmp_path: Path) -> None:
    stated = read_mode_shapes(three_modes(tmp_path / "a.unv", damping=[0.01] * 3), units=MILLIMETRES)
    bare = read_mode_shapes(three_modes(tmp_path / "b.unv", mass=None), units=MILLIMETRES)
    some: dict[str, Any] = {"contact": np.ones(3), "drive": np.ones(3)}
    cases: tuple[tuple[ModeShapes, dict[str, Any], str], ...] = (
        (bare, {"quality_factor": 100.0}, "states no modal mass of 3 of 3 modes; give modal_mass"),
        (bare, {"modal_mass": 1.0}, "states no damping of 3 of 3 modes; give quality_factor"),
        (stated, {"modal_mass": 1.0}, "states the modal mass of every mode; leave it out"),
        (stated, {"quality_factor": 9.0}, "states the damping of every mode; leave it out"),
    )
    for modes, values, complaint in cases:
        with raises(InvalidInput, match=complaint):
            modal_lists(modes, **some, **values)
    with raises(InvalidInput, match="contact moves in none of the 3 elastic modes"):
        modal_lists(stated, contact=np.zeros(3), drive=np.ones(3))
    filled = modal_lists(bare, **some, modal_mass=4.0, quality_factor=50.0)
    assert filled["contact_participation"] == approx([0.5] * 3)
    assert filled["damping_ratio"] == approx([0.01] * 3)


@pytest.mark.external
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed: apt-get install calculix-ccx")
def test_modes_that_calculix_computes_have_the_response_of_our_own(tmp_path: Path) -> None:
    # CalculiX integrates the stiffness at four points of an element, fewer than exact integration needs
    mesh, frequency, _ = bar()
    nodes = [f"{k},{x:.12g},{y:.12g},{z:.12g}" for k, (x, y, z) in enumerate(1e3 * mesh.nodes, 1)]
    elements = [",".join(map(str, [k, *(cell + 1)])) for k, cell in enumerate(mesh.elements, 1)]
    material = ["*MATERIAL, NAME=M", "*ELASTIC", "200000.,0.29", "*DENSITY", "7.9e-9"]
    step = ["*SOLID SECTION, ELSET=ALL, MATERIAL=M", "*STEP", "*FREQUENCY", "12", "*NODE FILE", "U", "*END STEP", ""]
    lines = ["*NODE, NSET=N", *nodes, "*ELEMENT, TYPE=C3D10, ELSET=ALL", *elements, *material, *step]
    (tmp_path / "bar.inp").write_text("\n".join(lines))
    subprocess.run(["ccx", "bar"], cwd=tmp_path, check=True, capture_output=True)
    modes = read_mode_shapes(tmp_path / "bar.frd", units=MILLIMETRES)
    assert modes.natural_frequency[:6].tolist() == [0.0] * 6
    assert modes.natural_frequency[6:] == approx(frequency[6:], rel=3e-3)
    assert modes.modal_mass == approx(1e3)  # one tonne
    read, own = structure(modes, **PLACES), own_structure()
    products = [each.drive_vector * each.contact_vector for each in (read, own)]  # no sign of a shape
    axial = int(np.argmax(np.abs(products[1])))
    assert products[0][axial] == approx(products[1][axial], rel=3e-3)
    rigid = np.sum(read.contact_vector[:6] ** 2)  # 1/mass, with what turning adds at the tip
    assert rigid == approx(np.sum(own.contact_vector[:6] ** 2), rel=1e-3)
