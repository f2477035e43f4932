"""Task `regime`: lubrication regime of a rig, by vibration, lubricant or both, and the kind of wear to expect."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.friction import BoundaryLubricant
from sonolube.models.wear import WearMechanismAssessment
from sonolube.report import Drawing
from sonolube.rig import LubricationMap, LubricationPoint, Rig, lubrication_map, lubrication_point, wear_of_materials
from sonolube.rig.datasets import labels
from sonolube.rig.figures import lubrication_chart
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows, Table
from sonolube.tasks.parameters import Number, Parameter, RigFile, rig_of
from sonolube.tasks.task import in_si, plausible, shown, task
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_QUANTITIES = ("vibration_amplitude", "sliding_speed", "nominal_pressure", "asperity_load_fraction")
_FILM = Parameter(help="Coefficient of friction of the lubricant film.", unit="", kind="NUMBER")
_PRESSURE = Parameter(help="Pressure at which asperities carry all the load.", unit="Pa")
_GAIN = Parameter(
    help="Least reduction of a lubricant's friction that is worth the power of vibration.", unit="", kind="SHARE"
)


@task
def regime(
    rig: RigFile,
    *,
    film_coefficient: Annotated[Number, _FILM],
    asperity_pressure: Annotated[Number, _PRESSURE],
    smallest_gain: Annotated[Number, _GAIN] = "0",
    pin: Annotated[str | None, Parameter(help="Material of the pin, for its wear.", kind="MATERIAL")] = None,
    disc: Annotated[str | None, Parameter(help="Material of the disc, for its wear.", kind="MATERIAL")] = None,
) -> "RegimeAnswer":
    """Lubrication regime: dry, vibrated, lubricated or both, and the kind of wear to expect.

    Example: sonolube regime examples/rigs/tribometer.toml --film-coefficient 0.25 --asperity-pressure 10MPa
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
        result=lubrication_point(known, lubricant=lubricant, smallest_gain=gain),
        wear=wear_of_materials(material(pin), material(disc)) if pin is not None and disc is not None else None,
        surroundings=lubrication_map(known, lubricant=lubricant, smallest_gain=gain),
    )


@answer
class RegimeAnswer(Answer):
    """Coefficients of friction of a rig dry, vibrated, lubricated and both, the best of them, and its wear."""

    rig: Rig
    result: LubricationPoint
    wear: WearMechanismAssessment | None
    surroundings: LubricationMap

    def blocks(self) -> Sequence[Block]:
        """Coefficient of friction of each method, the best marked, and the kind of wear."""
        result = self.result
        coefficients = [
            [name, f"{float(value):.3g}", "best" if name == result.best else ""]
            for name, value in result.coefficients._asdict().items()
        ]
        return [
            f"{self.rig.title}, {format_si(result.nominal_pressure, 'Pa')}, {format_si(result.sliding_speed, 'm/s')}",
            Table(["method", "coefficient of friction", ""], coefficients),
            Rows(
                [
                    ("on asperities", f"{100 * result.asperity_load_fraction:.3g} % of the load through the lubricant"),
                    ("friction model", result.friction_model),
                    ("amplitude", f"{format_si(result.vibration_amplitude, 'm')}: {result.amplitude_origin}"),
                    *([] if self.wear is None else _wear_rows(self.wear)),
                ]
            ),
        ]

    def object(self) -> dict[str, Any]:
        """Coefficients of friction by method, the best of them, and the kind of wear."""
        result, wear, methods = self.result, self.wear, self.result.coefficients._asdict()
        return {
            "rig": self.rig.title,
            "best": result.best,
            "friction_model": result.friction_model,
            "amplitude_source": result.amplitude_source,
            "amplitude_origin": result.amplitude_origin,
            **si({name: getattr(result, name) for name in _QUANTITIES}),
            "friction_coefficient": si({name: float(value) for name, value in methods.items()}, unit=""),
            **({} if wear is None else {"wear": _wear_object(wear)}),
        }

    def caveats(self) -> Sequence[str]:
        """Caveats of the regime."""
        return self.result.caveats

    def figures(self) -> Mapping[str, Drawing]:
        """Map of the best method about the rig's speed and pressure."""
        chart = lambda: lubrication_chart(self.rig, self.result, self.surroundings)  # noqa: E731
        return {f"{self.rig.name}-regime": Drawing(chart=chart)}

    def dataset(self) -> "xr.Dataset":
        """Return the coefficients of friction over `lubrication`, and the operating point."""
        methods = self.result.coefficients._asdict()
        found = super().dataset().assign_coords(lubrication=list(methods))
        coefficients = [float(value) for value in methods.values()]
        return found.assign(friction_coefficient=("lubrication", coefficients, labels("friction_coefficient")))


def _wear_rows(wear: WearMechanismAssessment) -> list[tuple[str, str]]:
    """Kind of wear, effect of vibration on it, and their reasons."""
    return [
        ("wear", f"{wear.mechanism}; vibration: {wear.vibration_effect} in such pairs (a rule, not a law)"),
        *(("because", reason) for reason in wear.reasons),
        *(("evidence", line) for line in wear.evidence),
    ]


def _wear_object(wear: WearMechanismAssessment) -> dict[str, Any]:
    """Kind of wear, effect of vibration on it, and their reasons, for JSON."""
    return {
        "kind": str(wear.mechanism),
        "effect": str(wear.vibration_effect),
        "reasons": list(wear.reasons),
        "evidence": list(wear.evidence),
    }
