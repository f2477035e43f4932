"""Task `modes` in Python: numbers and pictures of the command, quantities in SI, bytes of files, and refusals."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, mark, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from tests.same import same, same_files

import sonolube as sl
from sonolube.errors import InvalidInput, MissingPackage, SonolubeError, UnknownName
from sonolube.figure import publication_style, render_figure
from sonolube.models.fem import cylinder
from sonolube.models.fem.results.part_modes import SupportedPart
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.parts.named_parts import DEFAULT_MATERIAL, supported_part

Program = Callable[..., Any]

BAR: dict[str, Any] = {"sizes": {"length": "60mm", "radius": 6e-3}, "count": 2, "tolerance": 0.05}
BAR_OPTIONS = ("--set", "length=60mm", "--set", "radius=6mm", "--count", "2", "--tolerance", "0.05")


def test_modes_in_python_have_the_numbers_and_the_very_pictures_of_the_command(
    sonolube: Program, tmp_path: Path
) -> None:
    elastic = ("--young-modulus", "50GPa", "--poisson-ratio", "0.2", "--density", "2000kg/m3")
    command = sonolube("modes", "cylinder", *BAR_OPTIONS, *elastic, "--out", tmp_path, "--json").answer
    found = sl.modes("cylinder", youngs_modulus=50e9, poisson_ratio=0.2, density=2000.0, **BAR)
    files = command.pop("files")
    same(found.json_object(), command)
    by_text = sl.modes("cylinder", youngs_modulus="50 GPa", poisson_ratio="20 %", density="2000 kg/m3", **BAR)
    same(by_text.object(), found.object())
    with publication_style(None):
        pictures = [render_figure(sl.plot(found, title=title), "png") for title in ("bending 1", "bending 2")]
    assert pictures == [Path(file).read_bytes() for file in files]
    with raises(UnknownName, match="unknown figure 'bendin 1'"):
        sl.plot(found, title="bendin 1")


def test_the_dataset_of_modes_has_shapes_and_what_is_assumed_of_a_part(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    tribometer = supported_part("tribometer_actuator", {}, material=DEFAULT_MATERIAL)
    assert "62 layers" in tribometer.assumptions["outer_radius"]
    assumed = {"radius": "scaled from a drawing", "length": "of the catalogue"}
    monkeypatch.setattr(SupportedPart, "assumptions", assumed)  # a transducer takes a minute to solve
    found = sl.modes("cylinder", **BAR)
    with xr.open_dataset(found.to_netcdf(tmp_path / "kept.nc"), engine="h5netcdf") as kept:
        assert kept.attrs["assumptions"] == "radius: scaled from a drawing\nlength: of the catalogue"
        assert list(kept["mode"].to_numpy()) == ["bending 1", "bending 2"]
        assert kept["natural_frequency"].attrs["units"] == "Hz"
        assert kept["mode_shape"].dims == ("mode", "point", "direction")
        assert kept["surface_point"].to_numpy()[:, 2].max() == approx(0.06)


def test_step_files_and_points_may_be_bytes(tmp_path: Path) -> None:
    step, points = tmp_path / "bar.step", tmp_path / "points.csv"
    cylinder(radius=6e-3, length=0.06).shape.WriteStep(str(step))
    points.write_text("0,0,0\n0,0,30\n")
    stages: list[str] = []
    arguments: dict[str, Any] = {"count": 1, "tolerance": 0.05, "toward": "x"}
    found = sl.modes(
        NamedBytes("bar.step", step.read_bytes()),
        points=NamedBytes("points.csv", points.read_bytes()),
        progress=lambda stage, done, total: stages.append(stage),
        **arguments,
    )
    by_path = sl.modes(step, points=points, **arguments)
    same(found.object(), by_path.object() | {"part": "bar.step"})
    same_files(found.files(), by_path.files())
    assert list(found.files()) == ["bar-shapes.csv"]
    assert stages
    assert all(stage.startswith("meshing and solving") for stage in stages)


@mark.parametrize(
    ("arguments", "line"),
    [
        ({"sizes": {"length": "60mm"}}, "a cylinder needs radius; give each by sizes, such as radius=20mm"),
        ({"material": "pzt_4"} | BAR, "^material pzt_4: a piezoelectric ceramic needs its poling"),
        ({"density": "3mm"}, "^density 3mm is a length"),
        ({"toward": "x"}, "^toward has no meaning without points"),
        ({"body_mass": 1.0}, "^body_mass has no meaning without contact"),
        ({"contact": "tip"}, "^contact tip: cylinder has no drive"),
        ({"axis": "w"}, "unknown axis 'w'"),
    ],
)
def test_a_part_that_cannot_be_made_is_refused_in_the_words_of_python(arguments: dict[str, Any], line: str) -> None:
    with raises(SonolubeError, match=line):
        sl.modes("cylinder", **arguments)


def test_materials_of_a_transducer_are_its_own() -> None:
    arguments: tuple[dict[str, Any], ...] = ({"material": "brass"}, {"youngs_modulus": 2e11})
    for each in arguments:
        with raises(InvalidInput, match=rf"^{next(iter(each))} has no meaning for stack, which has its own"):
            sl.modes("stack", **each)


def test_modes_for_a_rig_name_the_command_that_computes_them() -> None:
    body: dict[str, Any] = {"body_mass": 1.0, "body_stiffness": "4 kN/m", "body_damping": 20.0}
    found = sl.modes("stack", sizes={"length": 0.03}, count=1, tolerance=0.5, contact="tip", **body)
    structure = found.object()["structure"]
    options = "--set length=0.03m --count 1 --tolerance 0.5 --contact tip --body-mass 1.0kg"
    further = "--body-stiffness '4 kN/m' --body-damping '20.0N s/m'"
    assert structure["command"] == f"sonolube modes stack {options} {further}"
    assert structure["natural_frequency"][-1] == approx(np.sqrt(4e3) / (2 * np.pi))


def test_a_mesher_that_is_not_installed_is_named(monkeypatch: MonkeyPatch) -> None:
    for module in ("netgen", "netgen.occ", "netgen.meshing"):
        monkeypatch.setitem(sys.modules, module, None)
    with raises(MissingPackage, match=r"^bodies and their meshes, .* not installed: pip install netgen-mesher$"):
        sl.modes("cylinder", **BAR)
