"""What the command `regime` says and draws."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.cli.output import closing_lines
from sonolube.figure import publication_style, write_figure
from sonolube.friction import LubricationMethod
from sonolube.rig import LubricationMap, LubricationPoint, Rig
from sonolube.units import format_si
from sonolube.wear.mechanism import WearMechanismAssessment

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SHADES = {"dry": "0.75", "ultrasonic": "#9ecae1", "lubricant": "#fdd0a2", "combined": "#c7e9c0"}


def regime_object(
    rig: Rig, result: LubricationPoint, wear: WearMechanismAssessment | None, written: list[Path]
) -> dict[str, Any]:
    """Return the ways of lubrication as they go into JSON."""
    assessed = {} if wear is None else {"wear": _wear_object(wear)}
    return {
        "rig": rig.title,
        "best": result.best,
        "friction_model": result.friction_model,
        "sliding_speed": {"value": result.sliding_speed, "unit": "m/s"},
        "nominal_pressure": {"value": result.nominal_pressure, "unit": "Pa"},
        "asperity_load_fraction": {"value": result.asperity_load_fraction, "unit": ""},
        "friction_coefficient": {
            name: {"value": float(value), "unit": ""} for name, value in result.coefficients._asdict().items()
        },
        **assessed,
        "caveats": list(result.caveats),
        "assumptions": dict(rig.assumptions),
        "files": [str(path) for path in written],
    }


def regime_lines(
    rig: Rig, result: LubricationPoint, wear: WearMechanismAssessment | None, written: list[Path]
) -> list[str]:
    """Return the ways of lubrication as lines, the best of them marked."""
    coefficients = result.coefficients._asdict()
    return [
        f"{rig.title}, {format_si(result.nominal_pressure, 'Pa')}, {format_si(result.sliding_speed, 'm/s')}",
        "  coefficient of friction",
        *[f"    {name:<10}  {float(value):.3g}{_marked(name, result)}" for name, value in coefficients.items()],
        f"  on asperities  {100 * result.asperity_load_fraction:.3g} % of the load through the lubricant",
        f"  friction model {result.friction_model}",
        *([] if wear is None else _wear_lines(wear)),
        *closing_lines(written, assumptions=rig.assumptions, caveats=result.caveats),
    ]


def write_regimes(rig: Rig, result: LubricationPoint, about: LubricationMap, *, folder: Path, name: str) -> list[Path]:
    """Write the map as a figure and return the files."""
    with publication_style():
        return write_figure(_figure(rig, result, about), folder=folder, name=name)


def _marked(name: str, result: LubricationPoint) -> str:
    return "  best" if name == result.best else ""


def _wear_lines(wear: WearMechanismAssessment) -> list[str]:
    return [
        f"  wear           {wear.mechanism}; vibration: {wear.vibration_effect} in pairs like this (a rule, not a law)",
        *[f"    because {reason}" for reason in wear.reasons],
        *[f"    evidence: {line}" for line in wear.evidence],
    ]


def _wear_object(wear: WearMechanismAssessment) -> dict[str, Any]:
    return {
        "kind": str(wear.mechanism),
        "effect": str(wear.vibration_effect),
        "reasons": list(wear.reasons),
        "evidence": list(wear.evidence),
    }


def _figure(rig: Rig, result: LubricationPoint, about: LubricationMap) -> "Figure":
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = [str(method) for method in LubricationMethod]
    figure = Figure(figsize=(5.2, 4.0))
    axes = figure.subplots()
    axes.pcolormesh(
        1e3 * about.sliding_speed,
        1e-6 * about.nominal_pressure,
        np.searchsorted(np.sort(names), about.best),
        cmap=ListedColormap([_SHADES[name] for name in sorted(names)]),
        vmin=-0.5,
        vmax=len(names) - 0.5,
        rasterized=True,
    )
    (point,) = axes.plot(
        1e3 * result.sliding_speed, 1e-6 * result.nominal_pressure, "ko", label="the rig", linestyle="none"
    )
    shown = [Patch(color=_SHADES[name], label=name) for name in names if np.any(about.best == name)]
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Nominal pressure [MPa]", xscale="log", yscale="log")
    axes.grid(visible=False)
    figure.legend(handles=[*shown, point], loc="outside lower center", ncols=5)
    figure.suptitle(rig.title, fontsize=9)
    return figure
