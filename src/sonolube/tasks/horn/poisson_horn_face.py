"""Task `horn face`: friction along the face of a Poisson horn, with its transition and motor regions (D 2.1)."""

from collections.abc import Mapping, Sequence
from math import isnan
from typing import TYPE_CHECKING, Annotated, Any

from sonolube.errors import InvalidInput
from sonolube.facts.published import si_value
from sonolube.report import Drawing
from sonolube.report.blocks import Block, Rows
from sonolube.reproduction.chapter2.horn_figures import face_friction_chart
from sonolube.reproduction.chapter2.horn_friction import FACE_END, FaceFriction, friction_on_face, transition_region
from sonolube.reproduction.chapter2.horn_rows import REGION_ROWS
from sonolube.reproduction.cube import Horn
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.parameters import Number, Parameter, Stop, Watch
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, shown, task
from sonolube.units import format_like

if TYPE_CHECKING:
    import xarray as xr

_ASSUMED = {
    "horn": "ends tapered to 3/4 in over their last inch, handbook constants, by which both have the printed mode",
    "contact": "springs of the contact of Table 3.1 with Mindlin's ratio, of the load of D 3.1.4; nothing is fitted",
    "elastic_loss": "loss factor 0.001",
}


@task
def face(
    horn: Annotated[Horn, Parameter(help="Material of the horn: aluminium or steel.", kind="HORN")],
    *,
    frequency: Annotated[
        Number, Parameter(help="Of the drive on the horn's end.", unit="Hz", quantity="frequency")
    ] = "20kHz",
    amplitude: Annotated[
        Number, Parameter(help="Of the driven end, zero to peak.", unit="m", quantity="vibration_amplitude")
    ] = "8.5um",
    sliding_speed: Annotated[
        Number, Parameter(help="Of the block towards the node.", unit="m/s", quantity="sliding_speed")
    ] = "5mm/s",
    progress: Watch = None,
    cancelled: Stop = None,
) -> "FaceAnswer":
    """Friction of a block along the face of a Poisson horn: the transition and motor regions of D Table 2.1.

    Example: sonolube horn face aluminium
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
        ends = (-FACE_END, FACE_END)  # where the face drives nowhere
        low, high = (end if isnan(at) else at for at, end in zip(self._region(), ends, strict=True))
        measured = self._measured()
        node, *known = format_like((self.friction.node, low, high, *measured, *ends), "m")
        rows = [
            ("Node of the axial motion", node),
            ("Friction at the node, of that at rest", f"{self.friction.at(self.friction.node):.0%}"),
            ("Transition region", f"{known[0]} to {known[1]}"),
            ("the same, measured", f"{known[2]} to {known[3]} (Table 2.1)"),
            ("Motor region, left", f"{known[4]} to {known[0]}"),
            ("Motor region, right", f"{known[1]} to {known[5]}"),
            ("Greatest motor force, of the friction at rest", f"{max(0.0, -self.friction.ratio.min()):.0%}"),
        ]
        return [f"Poisson horn of {self.horn}, positions from the centre of the face", Rows(rows)]

    def object(self) -> dict[str, Any]:
        """Node, limits of the transition region computed and measured, least friction ratio."""
        low, high = (None if isnan(limit) else limit for limit in self._region())
        start, end = self._measured()
        return {
            "horn": self.horn,
            **si({"node_position": self.friction.node}, unit="m"),
            "transition_region": si({"start": low, "end": high}, unit="m"),
            "measured_transition_region": si({"start": start, "end": end}, unit="m"),
            **si({"friction_ratio_at_node": self.friction.at(self.friction.node)}, unit=""),
            **si({"least_friction_ratio": float(self.friction.ratio.min())}, unit=""),
        }

    def caveats(self) -> Sequence[str]:
        """A side of the face that drives nowhere."""
        if not any(map(isnan, self._region())):
            return ()
        return ("the face does not drive the block on a side: its transition region reaches the end of the face there",)

    def assumptions(self) -> Mapping[str, str]:
        """Shape, contact and loss that D does not print."""
        return _ASSUMED

    def figures(self) -> Mapping[str, Drawing]:
        """Friction over the position on the face."""
        return {f"horn-{self.horn}-face": Drawing(chart=lambda: face_friction_chart(self.horn, self.friction))}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Friction ratio over the position as netCDF."""
        import xarray as xr

        data = {"friction_ratio": ("position", self.friction.ratio, {"units": "1"})}
        coordinates = {"position": ("position", self.friction.position, {"units": "m"})}
        return {f"horn-{self.horn}-face.nc": xr.Dataset(data, coordinates, {"title": f"Face of the {self.horn} horn"})}

    def _region(self) -> tuple[float, float]:
        """Limits of the transition region."""
        return transition_region(self.friction)

    def _measured(self) -> tuple[float, float]:
        """Limits of the transition region in Table 2.1."""
        start, end = (si_value(f"table-2.1-{side}-{REGION_ROWS[self.horn]}") for side in ("start", "end"))
        return start, end
