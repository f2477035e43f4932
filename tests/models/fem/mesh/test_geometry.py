"""Bonded bodies, STEP files and impossible geometries."""

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pytest import MonkeyPatch, approx, mark, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")


from tests.models.fem.ritz import annular_section, ritz_frequencies

from sonolube.errors import InvalidInput
from sonolube.models.fem import (
    Model,
    Slot,
    block,
    bond,
    cylinder,
    generate_mesh,
    isotropic_medium,
    natural_modes,
    read_step,
    ring,
    stepped_horn,
    translate,
)
from sonolube.models.fem.mesh.geometry import step_text
from sonolube.models.fem.solver.assembly import tributary_areas

R, r, L = 0.02, 0.01, 0.06

FILLET = 0.004


def test_bonded_bodies_share_their_face_and_vibrate_as_one() -> None:
    halves = {
        "lower": cylinder(radius=0.01, length=0.02),
        "upper": translate(cylinder(radius=0.01, length=0.02), by=(0.0, 0.0, 0.02)),
    }
    mesh = generate_mesh(bond(halves), element_size=0.005)
    steel = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)
    two = natural_modes(Model(mesh=mesh, media={"lower": steel, "upper": steel}), count=6).elastic_frequency
    one = ritz_frequencies(
        annular_section(outer_radius=0.01, inner_radius=0.0, order=12), length=0.04, medium=steel, order=12
    )
    assert tributary_areas(mesh, "lower|upper").sum() == approx(math.pi * 1e-4, rel=5e-3)
    assert two == approx(one[:6], rel=1e-2)


def test_a_body_is_read_back_from_its_step_file(tmp_path: Path) -> None:
    part = stepped_horn(radius=R, end_radius=r, length=L, end_length=L)
    part.shape.WriteStep(str(tmp_path / "horn.step"))
    assert read_step(tmp_path / "horn.step").volume == approx(part.volume, rel=1e-6)


def test_impossible_bodies_are_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"thickness must be positive, got 0\.0 m"):
        block(length=0.1, width=0.04, thickness=0.0)
    with raises(InvalidInput, match="the wall has no thickness"):
        ring(outer_radius=0.01, inner_radius=0.01, length=0.01)
    with raises(InvalidInput, match="must be one closed body"):
        block(length=0.1, width=0.04, thickness=0.02, slots=(Slot(length=0.01, width=0.05),))
    with raises(InvalidInput, match="overlap"):
        bond({"one": cylinder(radius=R, length=L), "other": cylinder(radius=r, length=L)})
    (tmp_path / "empty.step").write_text("nothing")
    with raises(InvalidInput, match="STEP"):
        read_step(tmp_path / "empty.step")
    with raises(InvalidInput, match="no such file"):
        read_step(tmp_path / "none.step")


def test_an_open_surface_from_a_step_file_is_refused(tmp_path: Path) -> None:
    cylinder(radius=R, length=L).shape.faces[0].WriteStep(str(tmp_path / "open.step"))
    with raises(InvalidInput, match="no closed solid"):
        read_step(tmp_path / "open.step")


def test_a_step_file_of_a_sheet_without_thickness_is_refused(tmp_path: Path) -> None:
    block(length=R, width=r, thickness=FILLET).shape.faces[0].WriteStep(str(tmp_path / "sheet.step"))
    with raises(InvalidInput, match="no closed solid"):
        read_step(tmp_path / "sheet.step")


@mark.parametrize(
    ("code", "message"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "the CAD kernel ends on it without an answer"),
        ("import sys; sys.stderr.write('damaged.step: no header'); sys.exit(3)", "damaged.step: no header"),
    ],
)
def test_a_step_file_that_ends_the_kernel_is_refused_and_the_program_goes_on(
    code: str, message: str, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    # stand-in of the kernel's process: which damaged files end it depends on the kernel's version
    run = subprocess.run
    monkeypatch.setattr(subprocess, "run", lambda _command, **options: run([sys.executable, "-c", code], **options))
    (tmp_path / "damaged.step").write_text("ISO-10303-21;")
    with raises(InvalidInput, match=message):
        read_step(tmp_path / "damaged.step")


@mark.parametrize("place", [0, 5, 11])
def test_a_step_file_whose_surface_lacks_an_edge_is_refused_before_it_is_meshed(tmp_path: Path, place: int) -> None:
    text = step_text(block(length=0.04, width=0.01, thickness=0.01))
    edges = re.findall(r"#\d+ = EDGE_CURVE", text)
    path = tmp_path / "open.step"
    path.write_text(text.replace(edges[place], edges[place].replace("EDGE_CURVE", "EDGX_CURVE"), 1), encoding="utf-8")
    with raises(InvalidInput, match=r"open\.step: an edge of a face is missing, so that it is open"):
        read_step(path)
