"""Task `regime`: lubrication regime of a rig, by vibration, lubricant or both, and the kind of wear to expect."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from sonolube import rig as rigs
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.friction import BoundaryLubricant
from sonolube.models.wear import WearMechanismAssessment
from sonolube.report import Drawing
from sonolube.report.results import regime as results
from sonolube.rig.datasets import labels
from sonolube.rig.figures import lubrication_chart
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Table, answer
from sonolube.tasks.parameters import Number, Parameter, Quantity, RigFile, rig_of
from sonolube.tasks.task import in_si, plausible, shown, task
from sonolube.text.units import format_si

_FILM = Quantity("Coefficient of friction of the lubricant film.", "", kind="NUMBER")
_PRESSURE = Quantity("Pressure at which asperities carry all the load.", "Pa")
_GAIN = Quantity("Least reduction of a lubricant's friction that is worth the power of vibration.", "", kind="SHARE")


@task
def regime(
    rig: RigFile,
    *,
    film_coefficient: Annotated[Number, _FILM],
    asperity_pressure: Annotated[Number, _PRESSURE],
    smallest_gain: Annotated[Number, _GAIN] = "0",
    pin: Annotated[str | None, Parameter("Material of the pin, for its wear.", "MATERIAL")] = None,
    disc: Annotated[str | None, Parameter("Material of the disc, for its wear.", "MATERIAL")] = None,
) -> "RegimeAnswer":
    """Lubrication regime: dry, vibrated, lubricated or both, and the kind of wear to expect.

    Example: sonolube regime examples/rigs/tribometer.toml --film-coefficient 0.25 --asperity-pressure 10MPa

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.regime("examples/rigs/tribometer.toml", film_coefficient=0.25, asperity_pressure="10MPa")
    >>> coefficient = answer["friction_coefficient"]
    >>> str(coefficient.idxmin().item()), round(float(coefficient.min()), 2)
    ('ultrasonic', 0.12)
    """
    if (pin is None) != (disc is None):
        raise InvalidInput(f"{shown('pin')} and {shown('disc')} belong together: give both or neither")
    known = rig_of(rig)
    lubricant = BoundaryLubricant(
        film_coefficient=plausible("film_coefficient", film_coefficient),
        full_asperity_pressure=plausible("asperity_pressure", asperity_pressure),
    )
    gain = in_si("smallest_gain", smallest_gain)
    return RegimeAnswer(
        rig=known,
        result=rigs.lubrication_point(known, lubricant=lubricant, smallest_gain=gain),
        wear=rigs.wear_of_materials(material(pin), material(disc)) if pin is not None and disc is not None else None,
        surroundings=rigs.lubrication_map(known, lubricant=lubricant, smallest_gain=gain),
    )


@answer
class RegimeAnswer(Answer):
    """Coefficients of friction of a rig dry, vibrated, lubricated and both, the best of them, and its wear."""

    rig: rigs.Rig
    result: rigs.LubricationPoint
    wear: WearMechanismAssessment | None
    surroundings: rigs.LubricationMap

    def blocks(self) -> Sequence[Block]:
        """Coefficient of friction of each method, the best marked, and the kind of wear."""
        result = self.result
        return [
            f"{self.rig.title}, {format_si(result.nominal_pressure, 'Pa')}, {format_si(result.sliding_speed, 'm/s')}",
            Table(["method", "coefficient of friction", ""], results.method_rows(result)),
            Rows(results.regime_rows(result, self.wear)),
        ]

    def object(self) -> dict[str, Any]:
        """Coefficients of friction by method, the best of them, and the kind of wear."""
        return {"rig": self.rig.title, **results.regime_object(self.result, self.wear)}

    def caveats(self) -> Sequence[str]:
        """Caveats of the regime."""
        return self.result.caveats

    def figures(self) -> Mapping[str, Drawing]:
        """Map of the best method about the rig's speed and pressure."""
        chart = lambda: lubrication_chart(self.rig, self.result, self.surroundings)  # noqa: E731
        return {f"{self.rig.name}-regime": Drawing(chart=chart)}

    def dataset(self) -> Dataset:
        """Coefficients of friction over `lubrication`, and the operating point."""
        methods = self.result.coefficients._asdict()
        found = super().dataset().assign_coords(lubrication=list(methods))
        coefficients = [float(value) for value in methods.values()]
        return found.assign(friction_coefficient=("lubrication", coefficients, labels("friction_coefficient")))
