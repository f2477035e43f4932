"""Drawings of horns: the profile that another program reads has the volume of the solid, and texts stand apart."""

import io
from collections.abc import Mapping
from math import pi
from pathlib import Path

import numpy as np
import pytest
from matplotlib.transforms import Bbox
from pytest import approx, mark

from sonolube.design.horns.profile import HornProfile, horn_drawing, horn_profile, profile_dxf
from sonolube.design.horns.shapes import SHAPES, TunableBody, body_from_geometry, horn_body

NOTES = ["horn of brass, 1 kg", "⌀ in mm"]
SIZES: Mapping[str, Mapping[str, float]] = {
    "thin": {"radius": 1e-3},
    "usual": {},
    "fat": {"radius": 60e-3, "length": 20e-3, "end_length": 35e-3, "flange_thickness": 0.4e-3},
}


def body_of(shape: str, **sizes: float) -> TunableBody:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    return horn_body(shape, frequency=20e3, wave_speed=5e3, sizes=sizes)


def profile_of(body: TunableBody) -> HornProfile:
    profile = horn_profile(body, length=body.length)
    assert profile is not None
    return profile


@mark.parametrize("shape", SHAPES)
def test_the_dxf_profile_has_lengths_and_volume_of_the_solid(shape: str) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed")
    from ezdxf.path import make_path

    body = body_of(shape)
    drawing = ezdxf.read(io.StringIO(profile_dxf(profile_of(body), NOTES)))
    assert drawing.dxfversion == "AC1009"
    assert not drawing.audit().errors
    (outline,), (centre,) = (drawing.modelspace().query(kind) for kind in ("POLYLINE", "LINE"))
    assert outline.is_closed
    assert centre.dxf.start.y == centre.dxf.end.y == 0
    z, r = np.array([(point.x, point.y) for point in make_path(outline).flattening(1e-5)]).T
    low, high = (1e3 * end for end in _extent(body))
    assert (z.min(), z.max(), r.min()) == approx((0.0, high - low, 0.0), abs=1e-6)
    z_1, r_1 = np.roll(z, -1), np.roll(r, -1)
    turned = pi / 3 * abs(((z - z_1) * (r**2 + r * r_1 + r_1**2)).sum())
    flat = abs((z * r_1 - z_1 * r).sum()) * 1e3 * body.sizes.get("thickness", 0.0)
    volume = flat if shape == "block" else turned
    assert volume == approx(1e9 * body.geometry_at(body.length).volume, rel=1e-5)
    assert "%%c" in [text.dxf.text for text in drawing.modelspace().query("TEXT")][1]


def test_the_step_file_reads_back_with_the_volume_and_without_the_time(tmp_path: Path) -> None:
    body = body_of("stepped_horn")
    from sonolube.models.fem import read_step, step_text

    solid = body.geometry_at(body.length)
    (tmp_path / "horn.step").write_text(step_text(solid))
    assert read_step(tmp_path / "horn.step").volume == approx(solid.volume, rel=1e-9)
    assert step_text(solid) == step_text(solid)
    assert "1970-01-01T00:00:00" in step_text(solid)


@mark.parametrize("proportions", SIZES)
@mark.parametrize("shape", SHAPES)
def test_texts_of_a_drawing_stand_apart_beside_its_view(shape: str, proportions: str) -> None:
    usual = profile_of(body_of(shape)).stations
    sizes = {name: size for name, size in SIZES[proportions].items() if name in _sizes_of(shape)}
    profile = profile_of(body_of(shape, **sizes))
    assert len(profile.stations) == len(usual)
    figure = horn_drawing(profile, notes=NOTES)
    figure.draw_without_rendering()
    (axes,) = figure.axes
    view = axes.patches[0].get_window_extent()
    assert view.width > 0
    boxes = [text.get_window_extent() for text in axes.texts]
    for place, box in enumerate(boxes):
        assert min(box.x0, box.y0) >= 0
        assert box.x1 <= figure.bbox.width
        assert box.y1 <= figure.bbox.height
        assert not Bbox.intersection(box, view)
        assert not [axes.texts[k] for k in range(place) if Bbox.intersection(box, boxes[k])]
    shown = {text.get_text() for text in axes.texts}
    assert f"{1e3 * profile.stations[-1]:.2f}" in shown
    assert {f"{1e3 * width:.2f}" for _, width in profile.widths} <= {text.lstrip("⌀width ") for text in shown}


def test_a_drawing_is_to_the_scale_that_it_states_and_symmetric() -> None:
    figure = horn_drawing(profile_of(body_of("booster")), notes=NOTES)
    (axes,) = figure.axes
    assert any("scale 1:2 " in text.get_text() for text in axes.texts)
    corners = axes.patches[0].get_path().vertices
    inches = figure.dpi_scale_trans.inverted().transform(axes.transData.transform(corners))
    profile = profile_of(body_of("booster"))
    assert 25.4 * np.ptp(inches, axis=0) == approx([500 * profile.stations[-1], 500 * profile.widths[1][1]])
    middle = np.asarray(axes.lines[0].get_ydata())[0]
    assert np.asarray(corners)[:, 1].mean() == approx(middle, rel=0.05)


def test_a_body_from_a_file_has_no_profile() -> None:
    solid = body_of("cylinder")
    body = body_from_geometry(solid.geometry_at(solid.length), axis="z")
    assert horn_profile(body, length=body.length) is None


def _extent(body: TunableBody) -> tuple[float, float]:
    from sonolube.models.fem.parts.length_adjustment import extent_along

    return extent_along(body.geometry_at(body.length), axis=body.axis)


def _sizes_of(shape: str) -> set[str]:
    body = body_of(shape)
    return {*body.sizes, body.tuned_size}
