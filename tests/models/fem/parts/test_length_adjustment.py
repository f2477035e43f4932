"""Bodies cut off or extended at their far end along any axis, against the volume of a box."""

import pytest
from pytest import approx

from sonolube.models.fem import PARTS, adjust_length
from sonolube.models.fem.parts.length_adjustment import extent_along


@pytest.mark.parametrize(("axis", "own"), [("x", 0.1), ("y", 0.03), ("z", 0.02)])
@pytest.mark.parametrize("share", [0.6, 1.5])
def test_a_box_of_another_length_along_any_axis_has_the_volume_of_that_box(axis: str, own: float, share: float) -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    box = PARTS["block"](length=0.1, width=0.03, thickness=0.02)
    low, _ = extent_along(box, axis=axis)
    changed = adjust_length(box, axis=axis, length=share * own)
    assert changed.volume == approx(share * 0.1 * 0.03 * 0.02, rel=1e-6)
    assert extent_along(changed, axis=axis) == approx((low, low + share * own))
