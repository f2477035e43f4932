"""Command `regime`: lubrication regime of a rig, by vibration, lubricant or both, and the kind of wear to expect."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver, si
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Out, RigPath, loaded_rig
from sonolube.cli.console.outputs import OutputFolder
from sonolube.compilation import few_points
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.friction import BoundaryLubricant
from sonolube.models.wear import WearMechanismAssessment
from sonolube.report import Drawing
from sonolube.rig import LubricationMap, LubricationPoint, Rig, lubrication_map, lubrication_point, wear_of_materials
from sonolube.rig.figures import lubrication_figure
from sonolube.rig.file.plausible import plausible_si, require_plausible
from sonolube.units import format_si

_QUANTITIES = ("vibration_amplitude", "sliding_speed", "nominal_pressure", "asperity_load_fraction")


@few_points()
def regime(
    rig: RigPath,
    film: Annotated[float, typer.Option("--film-coefficient", help="Coefficient of friction of the lubricant film.")],
    pressure: Annotated[
        str,
        typer.Option(
            "--asperity-pressure", metavar="PRESSURE", help="Pressure at which asperities carry all the load."
        ),
    ],
    smallest_gain: Annotated[
        float, typer.Option(help="Least reduction of a lubricant's friction that is worth the power of vibration.")
    ] = 0.0,
    pin: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the pin, for its wear.")] = None,
    disc: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the disc, for its wear.")] = None,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-regime.*")] = OUT,
    json: Json = False,
) -> None:
    """Lubrication regime: dry, vibrated, lubricated or both, and the kind of wear to expect.

    Example: sonolube regime examples/rigs/tribometer.toml --film-coefficient 0.25 --asperity-pressure 10MPa
    """
    if (pin is None) != (disc is None):
        raise InvalidInput("--pin and --disc belong together: give both or neither")
    known = loaded_rig(rig, changes=changes, amplitude=amplitude)
    full = plausible_si(pressure, unit="Pa", name="--asperity-pressure")
    require_plausible(film, unit="", text=f"--film-coefficient {film:g}")
    lubricant = BoundaryLubricant(film_coefficient=film, full_asperity_pressure=full)
    answer = RegimeAnswer(
        rig=known,
        result=lubrication_point(known, lubricant=lubricant, smallest_gain=smallest_gain),
        wear=wear_of_materials(material(pin), material(disc)) if pin is not None and disc is not None else None,
        surroundings=lubrication_map(known, lubricant=lubricant, smallest_gain=smallest_gain),
        name=f"{rig.stem}-regime",
    )
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class RegimeAnswer(Answer):
    """Coefficients of friction of a rig dry, vibrated, lubricated and both, the best of them, and its wear."""

    rig: Rig
    result: LubricationPoint
    wear: WearMechanismAssessment | None
    surroundings: LubricationMap
    name: str

    def lines(self) -> list[str]:
        """Coefficient of friction of each method, the best marked, and the kind of wear."""
        result = self.result
        return [
            f"{self.rig.title}, {format_si(result.nominal_pressure, 'Pa')}, {format_si(result.sliding_speed, 'm/s')}",
            "  coefficient of friction",
            *[
                f"    {name:<10}  {float(value):.3g}{'  best' if name == result.best else ''}"
                for name, value in result.coefficients._asdict().items()
            ],
            f"  on asperities   {100 * result.asperity_load_fraction:.3g} % of the load through the lubricant",
            f"  friction model  {result.friction_model}",
            f"  amplitude       {format_si(result.vibration_amplitude, 'm')}: {result.amplitude_origin}",
            *([] if self.wear is None else _wear_lines(self.wear)),
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
        return {self.name: Drawing(draw=lambda: lubrication_figure(self.rig, self.result, self.surroundings))}


def _wear_lines(wear: WearMechanismAssessment) -> list[str]:
    """Kind of wear, effect of vibration on it, and their reasons."""
    return [
        f"  wear            {wear.mechanism}; vibration: {wear.vibration_effect} in such pairs (a rule, not a law)",
        *[f"    because {reason}" for reason in wear.reasons],
        *[f"    evidence: {line}" for line in wear.evidence],
    ]


def _wear_object(wear: WearMechanismAssessment) -> dict[str, Any]:
    """Kind of wear, effect of vibration on it, and their reasons, for JSON."""
    return {
        "kind": str(wear.mechanism),
        "effect": str(wear.vibration_effect),
        "reasons": list(wear.reasons),
        "evidence": list(wear.evidence),
    }
