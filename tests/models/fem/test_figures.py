"""Pictures of modes: text beside its axis on bodies of any shape, and the surface that is drawn."""

import numpy as np
import pytest
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import Axes3D
from pytest import approx

from sonolube.models.fem import box_mesh
from sonolube.models.fem.figures import mode_figure, shaped_surface

SHAPES = {"cube": (30, 30, 30), "plate": (60, 50, 2), "tall": (10, 10, 120), "rod": (160, 6, 6), "slender": (4, 4, 200)}


@pytest.mark.parametrize("shape", SHAPES)
def test_ticks_and_labels_of_a_mode_stand_apart_inside_the_picture(shape: str) -> None:
    length, width, thickness = (1e-3 * side for side in SHAPES[shape])
    mesh = box_mesh(length=length, width=width, thickness=thickness, divisions=(2, 2, 2))
    longest = int(np.argmax(np.ptp(mesh.nodes, axis=0)))
    bent = np.zeros_like(mesh.nodes)
    bent[:, (longest + 1) % 3] = np.cos(3 * mesh.nodes[:, longest] / np.ptp(mesh.nodes[:, longest]))
    figure = mode_figure(shaped_surface(mesh, bent), title=shape)
    figure.draw_without_rendering()
    axes = figure.axes[0]
    assert isinstance(axes, Axes3D)
    width_of_picture, height_of_picture = figure.bbox.size
    ticks: dict[str, list[Bbox]] = {}
    for name, axis in {"x": axes.xaxis, "y": axes.yaxis, "z": axes.zaxis}.items():
        low, high = sorted(axis.get_view_interval())
        drawn = [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        ticks[name] = [text.get_window_extent() for text in drawn if text.get_text()]
        assert ticks[name]
        for box in (*ticks[name], axis.label.get_window_extent()):
            assert min(box.x0, box.y0) >= 0
            assert box.x1 <= width_of_picture
            assert box.y1 <= height_of_picture
    every = [box for boxes in ticks.values() for box in boxes]
    assert not [1 for place, box in enumerate(every) for other in every[:place] if Bbox.intersection(box, other)]
    beside = axes.zaxis.label.get_window_extent()
    assert not any(Bbox.intersection(beside, box) for box in ticks["z"])


def test_the_surface_drawn_is_that_of_the_body_with_the_field_on_it() -> None:
    mesh = box_mesh(length=0.06, width=0.02, thickness=0.01, divisions=(3, 1, 1))
    surface = shaped_surface(mesh, np.stack([mesh.nodes, 2 * mesh.nodes]))
    corners = surface.points[surface.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.sum() == approx(2 * (0.06 * 0.02 + 0.06 * 0.01 + 0.02 * 0.01))
    assert surface.displacement[0] == approx(surface.points)
    assert surface.displacement[1] == approx(2 * surface.points)
