"""Task `horn face`: friction along the face of a Poisson horn, with its transition and motor regions (D 2.1)."""

from collections.abc import Mapping, Sequence
from math import isnan
from typing import Annotated, Any, Unpack

from sonolube.errors import InvalidInput
from sonolube.report import Drawing
from sonolube.report.results.parts import horn_face
from sonolube.reproduction.chapter2.horn_figures import face_friction_chart
from sonolube.reproduction.chapter2.horn_friction import FaceFriction, friction_on_face, transition_region
from sonolube.reproduction.cube import Horn
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.parameters import Number, Parameter, Quantity, Watched
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, shown, task

_ASSUMED = {
    "horn": "ends tapered to 3/4 in over their last inch, handbook constants, by which both have the printed mode",
    "contact": "springs of the contact of Table 3.1 with Mindlin's ratio, of the load of the dissertation's section"
    " 3.1.4; nothing is fitted",
    "elastic_loss": "loss factor 0.001",
}


@task
def face(
    horn: Annotated[Horn, Parameter("Material of the horn: aluminium or steel.", "HORN")],
    *,
    frequency: Annotated[Number, Quantity("Of the drive on the horn's end.", "frequency")] = "20kHz",
    amplitude: Annotated[Number, Quantity("Of the driven end, zero to peak.", "vibration_amplitude")] = "8.5um",
    sliding_speed: Annotated[Number, Quantity("Of the block towards the node.", "sliding_speed")] = "5mm/s",
    **watch: Unpack[Watched],
) -> "FaceAnswer":
    """Friction of a block along the face of a Poisson horn: its transition and motor regions.

    Example: sonolube horn face aluminium

    Examples
    --------
    >>> import sonolube as sl
    >>> ratio = sl.horn.face("aluminium")["friction_ratio"]
    >>> round(float(ratio.min()), 2), round(float(ratio.max()), 2)  # negative where the horn drives the block
    (-0.35, 0.68)
    """
    at, height, speed = _positive(frequency=frequency, amplitude=amplitude, sliding_speed=sliding_speed)
    with stage("solving"):
        found = friction_on_face(horn, frequency=at, axial_amplitude=height, sliding_speed=speed)
    return FaceAnswer(horn=horn, friction=found)


def _positive(**given: Number) -> list[float]:
    """Values in SI of arguments that must be positive."""
    values = {name: in_si(name, value) for name, value in given.items()}
    for name, value in values.items():
        if not value > 0:
            raise InvalidInput(f"{shown(name)} must be positive")
    return list(values.values())


@answer
class FaceAnswer(Answer):
    """Friction along the face of a Poisson horn, and its regions beside those of Table 2.1."""

    horn: Horn
    friction: FaceFriction

    def blocks(self) -> Sequence[Block]:
        """Node, regions, and the greatest motor force."""
        return horn_face.face_blocks(self.horn, self.friction)

    def object(self) -> dict[str, Any]:
        """Node, limits of the transition region computed and measured, least friction ratio."""
        return horn_face.face_object(self.horn, self.friction)

    def caveats(self) -> Sequence[str]:
        """A side of the face that drives nowhere."""
        if not any(map(isnan, transition_region(self.friction))):
            return ()
        return ("the face does not drive the block on a side: its transition region reaches the end of the face there",)

    def assumptions(self) -> Mapping[str, str]:
        """Shape, contact and loss that D does not print."""
        return _ASSUMED

    def figures(self) -> Mapping[str, Drawing]:
        """Friction over the position on the face."""
        return {f"horn-{self.horn}-face": Drawing(chart=lambda: face_friction_chart(self.horn, self.friction))}

    def files(self) -> Mapping[str, Dataset]:
        """Friction ratio over the position as netCDF."""
        import xarray as xr

        data = {"friction_ratio": ("position", self.friction.ratio, {"units": "1"})}
        coordinates = {"position": ("position", self.friction.position, {"units": "m"})}
        return {f"horn-{self.horn}-face.nc": xr.Dataset(data, coordinates, {"title": f"Face of the {self.horn} horn"})}
