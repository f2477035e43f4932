"""Pictures of modes: bodies of any shape fill them beside their texts, and the surface that is drawn."""

import numpy as np
import pytest
from matplotlib.transforms import Bbox
from pytest import approx

from sonolube.figure import fit_to_style, publication_style
from sonolube.models.fem import box_mesh
from sonolube.models.fem.results.figures import mode_figure, shaped_surface

SHAPES = {"cube": (30, 30, 30), "plate": (60, 50, 2), "tall": (10, 10, 120), "rod": (160, 6, 6), "slender": (4, 4, 200)}


@pytest.mark.parametrize("style", ["journal", "slides"])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_body_fills_the_picture_beside_texts_that_stand_apart(shape: str, style: str) -> None:
    length, width, thickness = (1e-3 * side for side in SHAPES[shape])
    mesh = box_mesh(length=length, width=width, thickness=thickness, divisions=(2, 2, 2))
    longest = int(np.argmax(np.ptp(mesh.nodes, axis=0)))
    bent = np.zeros_like(mesh.nodes)
    bent[:, (longest + 1) % 3] = np.cos(3 * mesh.nodes[:, longest] / np.ptp(mesh.nodes[:, longest]))
    with publication_style(style):
        figure = mode_figure(shaped_surface(mesh, bent), title=shape)
        fit_to_style(figure)
        figure.draw_without_rendering()
    axes, scale = figure.axes
    (body,) = axes.collections
    drawn = Bbox.union([path.get_extents(axes.transData) for path in body.get_paths()])
    assert max(drawn.width / figure.bbox.width, drawn.height / figure.bbox.height) > 0.8
    texts = [*figure.texts, scale.yaxis.label, *scale.get_yticklabels(), *scale.texts]
    boxes = [text.get_window_extent() for text in texts]
    assert {text.get_text() for text in texts} >= {"x", "y", "z", "0.0", "1.0"}
    for place, box in enumerate(boxes):
        assert min(box.x0, box.y0) >= 0
        assert box.x1 <= figure.bbox.width
        assert box.y1 <= figure.bbox.height
        assert not Bbox.intersection(box, drawn)
        assert not [texts[k] for k in range(place) if Bbox.intersection(box, boxes[k])]
    assert scale.get_window_extent().x0 >= drawn.x1


def test_the_surface_drawn_is_that_of_the_body_with_the_field_on_it() -> None:
    mesh = box_mesh(length=0.06, width=0.02, thickness=0.01, divisions=(3, 1, 1))
    surface = shaped_surface(mesh, np.stack([mesh.nodes, 2 * mesh.nodes]))
    corners = surface.points[surface.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.sum() == approx(2 * (0.06 * 0.02 + 0.06 * 0.01 + 0.02 * 0.01))
    assert surface.displacement[0] == approx(surface.points)
    assert surface.displacement[1] == approx(2 * surface.points)
