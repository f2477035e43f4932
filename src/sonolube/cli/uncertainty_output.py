"""What the command `uncertainty` says and writes."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.design_page import notes_of, status_counts, status_tables
from sonolube.cli.output import closing_lines
from sonolube.design import (
    IntervalEstimate,
    SobolIndices,
    band_figure,
    histogram_figure,
    outcome_statistics,
    sobol_figure,
    sobol_indices,
)
from sonolube.errors import InvalidInput
from sonolube.figure import publication_style
from sonolube.identification import Posterior, SingularDirection
from sonolube.report import Finding, FindingTable, write_findings
from sonolube.rig import Rig, write_netcdf
from sonolube.units import format_si
from sonolube.vocabulary import quantities, quantity

if TYPE_CHECKING:
    import xarray as xr

_BAND = (0.05, 0.5, 0.95)
_SPREAD_CAPTION = (
    "Histogram of the samples that have a result, shares that lie below with intervals of 95 %, and the mean."
)
_BAND_CAPTION = "Median of the samples, and how far they spread, over what was swept."
_SOBOL_CAPTION = "What each uncertain entry brings to the variance, with intervals of 95 %."
_NOTABLE = 1e-4  # of a distribution, from which on it is told that so much is cut off


@dataclass(frozen=True, kw_only=True, slots=True)
class Identified:
    """Draws of a rig's structure from what facts leave of it, and the ways in which they leave it free."""

    posterior: Posterior
    unidentifiable_directions: tuple[SingularDirection, ...]

    def draws_by_key(self) -> dict[str, Floats]:
        """Return the draws by their keys in a rig file."""
        return {f"structure.{name}": values for name, values in self.posterior.draws.items()}


def write_uncertainty(
    rig: Rig,
    result: "xr.Dataset",
    drawn: Identified | None,
    *,
    asked: list[tuple[str, str]],
    folder: Path,
    name: str,
) -> list[Path]:
    """Write the report with its figures, and the samples, and return the files; refuse samples without any result."""
    if not np.isfinite(result[result.attrs["outcome"]].values).any():
        raise InvalidInput(f"no sample has a result: {next(reason for reason, _ in _failures(result))}")
    told = uncertainty_object(rig, result, drawn, [])
    with publication_style():
        figures = [
            Finding(
                name=name,
                caption=_BAND_CAPTION if result.attrs["swept"] else _SPREAD_CAPTION,
                figure=band_figure(result) if result.attrs["swept"] else histogram_figure(result),
            )
        ]
        if "block" in result.dims:
            ranking = sobol_figure(result, _indices(result))
            figures.append(Finding(name=f"{name}-sobol", caption=_SOBOL_CAPTION, figure=ranking))
    meaning, unit = quantity(told["of"]).meaning, told["unit"]
    written = write_findings(
        title=f"Uncertainty of the {meaning[:1].lower()}{meaning[1:]}: {rig.title}",
        asked=asked,
        facts=_facts(told, unit),
        tables=[
            *_uncertain_table(told),
            *_sobol_table(told, unit),
            *status_tables(told["statuses"], _failures(result)),
        ],
        figures=figures,
        notes=notes_of(_caveats(told), rig.assumptions),
        folder=folder,
        name="uncertainty",
    )
    return [*written, write_netcdf(result, path=folder / f"{name}.nc")]


def uncertainty_object(rig: Rig, result: "xr.Dataset", drawn: Identified | None, written: list[Path]) -> dict[str, Any]:
    """Return spread, indices, statuses and what was assumed, as they go into JSON."""
    of, joint = result.attrs["outcome"], {} if drawn is None else drawn.draws_by_key()
    told: dict[str, Any] = {
        "rig": rig.title,
        "of": of,
        "unit": quantity(of).unit,
        "points": int(result[of].size),
        "statuses": status_counts(result),
        "without_result": [{"reason": reason, "points": count} for reason, count in _failures(result)],
        "contact_lost": _contact_lost(result),
        "uncertain": {
            key: {"distribution": law.text, "truncated_fraction": law.truncated_fraction}
            for key, law in rig.uncertainty.items()
            if key in result.attrs["uncertain"] and key not in joint
        },
    }
    if drawn is not None:
        told["identified"] = {
            "potential_scale_reduction": drawn.posterior.potential_scale_reduction,
            "settled": drawn.posterior.has_converged,
            "free": [f"structure.{name}" for name in drawn.posterior.unidentified],
            "unidentifiable_directions": [dict(direction.exponents) for direction in drawn.unidentifiable_directions],
            "quantiles": {key: np.quantile(values, _BAND).tolist() for key, values in drawn.draws_by_key().items()},
        }
    if result.attrs["swept"]:
        told["band"] = _band(result)
    else:
        found = outcome_statistics(result)
        told |= {
            "mean": _estimated(found.mean),
            "standard_deviation": _estimated(found.standard_deviation),
            "quantiles": {str(share): _estimated(each) for share, each in found.quantiles.items()},
            "relative_error": found.relative_error,
            "converged": found.has_converged,
        }
    if "block" in result.dims:
        told["sobol"] = _ranking(result)
    return told | {"assumptions": dict(rig.assumptions), "files": [str(path) for path in written]}


def uncertainty_lines(rig: Rig, result: "xr.Dataset", drawn: Identified | None, written: list[Path]) -> list[str]:
    """Return the same as lines."""
    told = uncertainty_object(rig, result, drawn, written)
    meaning, unit = quantity(told["of"]).meaning, told["unit"]
    return [
        f"{rig.title}, {told['points']} points: {meaning[:1].lower()}{meaning[1:]}",
        *(_band_lines(told, unit) if "band" in told else _spread_lines(told, unit)),
        *(f"  without result: {row['points']}: {row['reason']}" for row in told["without_result"]),
        *_status_lines(told),
        "  uncertain",
        *(f"    {key:<34} {law['distribution']}{_cut(law)}" for key, law in told["uncertain"].items()),
        *_identified_lines(told),
        *_sobol_lines(told, unit),
        *closing_lines(written, assumptions=rig.assumptions),
    ]


def _indices(result: "xr.Dataset") -> SobolIndices:
    return sobol_indices(result[result.attrs["outcome"]].values, seed=result.attrs["seed"])


def _ranking(result: "xr.Dataset") -> list[dict[str, Any]]:
    """Return the entries by the share of the variance that would go were each known, the most first."""
    found = _indices(result)
    rows = [
        {
            "key": key,
            "first": _estimated(IntervalEstimate(value=first, lower=ends[0], upper=ends[1])),
            "total": _estimated(IntervalEstimate(value=total, lower=whole[0], upper=whole[1])),
            "deviation_if_known": found.standard_deviation * float(np.sqrt(np.clip(1 - first, 0, 1))),
        }
        for key, first, ends, total, whole in zip(
            result.attrs["uncertain"],
            found.first_order.tolist(),
            found.first_order_interval.tolist(),
            found.total_order.tolist(),
            found.total_order_interval.tolist(),
            strict=True,
        )
    ]
    return sorted(rows, key=lambda row: -row["first"]["value"])


def _estimated(known: IntervalEstimate) -> dict[str, float]:
    return {"value": known.value, "lower": known.lower, "upper": known.upper}


def _failures(result: "xr.Dataset") -> list[tuple[str, int]]:
    failed = np.isnan(result[result.attrs["outcome"]].values)
    codes, counts = np.unique(result["reason"].values[failed], return_counts=True)
    texts = result["reason_text"].values
    return [(str(texts[code]), int(count)) for code, count in zip(codes, counts, strict=True)]


def _contact_lost(result: "xr.Dataset") -> float | None:
    """Return the share of the points with a vibration that leave the contact for part of the time."""
    if "contact_loss_fraction" not in result:
        return None
    lost = result["contact_loss_fraction"].values
    known = np.isfinite(lost)
    return float(np.mean(lost[known] > 0)) if known.any() else None


def _band(result: "xr.Dataset") -> dict[str, Any]:
    """Return median and 90 % interval where the interval is narrowest and widest, and its mean width."""
    values = result[result.attrs["outcome"]]
    known = values.values
    open_points = np.isfinite(known).any(axis=0)
    low, median, high = np.full((3, *known.shape[1:]), np.nan)
    low[open_points], median[open_points], high[open_points] = np.nanquantile(known[:, open_points], _BAND, axis=0)
    width = high - low
    places = {"narrowest": np.nanargmin(width), "widest": np.nanargmax(width)} if open_points.any() else {}
    told: dict[str, Any] = {"mean_width": float(np.nanmean(width)) if open_points.any() else None}
    for word, flat in places.items():
        place = np.unravel_index(int(flat), width.shape)
        at = {
            str(result[name].attrs["key"]): result[name].values[index].item()
            for name, index in zip(values.dims[1:], place, strict=True)
        }
        told[word] = {
            "at": at,
            "median": float(median[place]),
            "lower": float(low[place]),
            "upper": float(high[place]),
        }
    return told


def _facts(told: dict[str, Any], unit: str) -> list[tuple[str, str]]:
    """Return the spread of an outcome, or its band where it is narrowest and widest."""
    facts = [("points", f"{told['points']}")]
    if "band" in told:
        facts += _band_facts(told, unit)
    else:
        facts += [(name, " ".join(_with_interval(each, unit).split())) for name, each in _spread_rows(told).items()]
        facts.append(("how far the samples carry it", _verdict(told)))
    if told["contact_lost"]:
        facts.append(("contact lost", f"for part of the time in {told['contact_lost']:.1%} of the points"))
    return facts


def _uncertain_table(told: dict[str, Any]) -> list[FindingTable]:
    rows = [(key, law["distribution"] + _cut(law)) for key, law in told["uncertain"].items()]
    rows += [(key, text) for key, text in _identified_rows(told)]
    if not rows:
        return []
    return [FindingTable(title="What is uncertain", heads=("entry", "distribution"), rows=tuple(rows))]


def _sobol_table(told: dict[str, Any], unit: str) -> list[FindingTable]:
    rows = tuple(
        (row["key"], _percent(row["first"]), _percent(row["total"]), format_si(row["deviation_if_known"], unit))
        for row in told.get("sobol", ())
    )
    heads = ("entry", "share of the variance alone", "with the others", "deviation were it known")
    return [FindingTable(title="Which to measure better", heads=heads, rows=rows)] if rows else []


def _caveats(told: dict[str, Any]) -> list[str]:
    caveats = []
    if not told.get("converged", True):
        caveats.append(_verdict(told))
    if "identified" in told and not told["identified"]["settled"]:
        caveats.append(_agreement(told["identified"]))
    return caveats


def _spread_rows(told: dict[str, Any]) -> dict[str, dict[str, float]]:
    return {
        "mean": told["mean"],
        "standard deviation": told["standard_deviation"],
        **{
            ("median" if share == "0.5" else f"{100 * float(share):.0f} % lie below"): each
            for share, each in told["quantiles"].items()
        },
    }


def _verdict(told: dict[str, Any]) -> str:
    error = told["relative_error"]
    return (
        f"intervals of 95 % within {error:.1%} of the spread"
        if told["converged"]
        else f"not converged: an interval takes {error:.1%} of the spread; take more --samples"
    )


def _spread_lines(told: dict[str, Any], unit: str) -> list[str]:
    rows = _spread_rows(told)
    return [*(f"  {name:<20} {_with_interval(each, unit)}" for name, each in rows.items()), f"  {_verdict(told)}"]


def _with_interval(each: dict[str, float], unit: str) -> str:
    value, low, high = (format_si(each[name], unit) for name in ("value", "lower", "upper"))
    return f"{value:<10} ({low} to {high})"


def _band_facts(told: dict[str, Any], unit: str) -> list[tuple[str, str]]:
    facts = []
    for word in ("narrowest", "widest"):
        row = told["band"].get(word)
        if row is not None:
            low, median, high = (format_si(row[name], unit) for name in ("lower", "median", "upper"))
            facts.append((word, f"{median}, 90 % within {low} to {high}, at {_place(row['at'])}"))
    return facts


def _band_lines(told: dict[str, Any], unit: str) -> list[str]:
    return [f"  {word:<10} {text}" for word, text in _band_facts(told, unit)]


def _place(at: dict[str, Any]) -> str:
    told = []
    for key, value in at.items():
        known = quantities().get(key.rpartition(".")[2])
        told.append(value if isinstance(value, str) else format_si(value, known.unit if known else ""))
    return ", ".join(told)


def _status_lines(told: dict[str, Any]) -> list[str]:
    share = {name: count / told["points"] for name, count in told["statuses"].items()}
    lines = [f"  {', '.join(f'{name} {part:.1%}' for name, part in share.items())} of the points"]
    if told["contact_lost"]:
        lines.append(f"  contact lost for part of the time in {told['contact_lost']:.1%} of them")
    return lines


def _cut(law: dict[str, Any]) -> str:
    return (
        f"; {law['truncated_fraction']:.1%} of it is impossible and cut off"
        if law["truncated_fraction"] > _NOTABLE
        else ""
    )


def _identified_rows(told: dict[str, Any]) -> list[tuple[str, str]]:
    """Return what facts leave of each parameter of the structure."""
    rows = []
    found = told.get("identified", {"quantiles": {}})
    for key, (low, median, high) in found["quantiles"].items():
        unit = quantity(key.rpartition(".")[2]).unit
        ends = f"{format_si(low, unit)} to {format_si(high, unit)}"
        free = "; no fact settles it" if key in found["free"] else ""
        rows.append((key, f"{format_si(median, unit)}, 90 % within {ends}{free}"))
    return rows


def _identified_lines(told: dict[str, Any]) -> list[str]:
    if "identified" not in told:
        return []
    found = told["identified"]
    lines = [f"    {key:<34} {text}" for key, text in _identified_rows(told)]
    for direction in found["unidentifiable_directions"]:
        moved = " ".join(f"{name}^{exponent:+.2f}" for name, exponent in direction.items() if abs(exponent) > 0.1)
        lines.append(f"    left free by the facts, to a factor of e and more: {moved}")
    return [*lines, f"    {_agreement(found)}"]


def _agreement(found: dict[str, Any]) -> str:
    agree = "agree" if found["settled"] else "do not agree yet: take the ends with caution"
    return f"independent populations of draws {agree} ({found['potential_scale_reduction']:.2f})"


def _sobol_lines(told: dict[str, Any], unit: str) -> list[str]:
    if "sobol" not in told:
        return []
    lines = ["  which to measure better: share of the variance alone, with the others; deviation were it known"]
    for row in told["sobol"]:
        alone, whole = (_percent(row[kind]) for kind in ("first", "total"))
        lines.append(f"    {row['key']:<34} {alone:<20} {whole:<20} {format_si(row['deviation_if_known'], unit)}")
    return lines


def _percent(share: dict[str, float]) -> str:
    value, low, high = (100 * max(share[name], 0.0) for name in ("value", "lower", "upper"))
    return f"{value:5.1f} % ({low:.0f} to {high:.0f})"
