"""Task `map`: friction reduction of a rig over two quantities, beside measured runs."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from sonolube import design
from sonolube.checks import Floats
from sonolube.design import map_chart, map_kinds, map_layout, map_page, measured_map_chart
from sonolube.design.gaussian_process import FEWEST_RUNS
from sonolube.design.map_layouts import panels_text
from sonolube.design.maps import default_axes
from sonolube.design.point_statistics import extreme_point, failure_counts
from sonolube.design.runs_map import require_mappable, runs_map, runs_on_map
from sonolube.errors import InvalidInput
from sonolube.measurement.run_columns import runs_help
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.report import Drawing, Page, PageTable
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, commanded_quantity, operating_caveats
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import Backend, Parameter, RigFile, RunsSource, Stop, Watch, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.ranges import Values, refuse_replaced, values_by_key
from sonolube.tasks.results.rig_text import amplitude_object, amplitude_rows, friction_model_text, rig_settings
from sonolube.tasks.results.status_tables import status_tables
from sonolube.tasks.task import shown, task
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


_AXIS_KEYS = ("sliding.sliding_speed", "contact.normal_load", VOLTAGE.key, AMPLITUDE.key, "drive.frequency")
_MEASURED_CAPTION = "Friction reduction between the measured runs alone by a Gaussian process, with its uncertainty."
_SETTINGS = ("sliding_speed", "normal_load", "frequency", VOLTAGE.name, AMPLITUDE.name, "actuator_power")
_FORMS = ("png", "svg", "pdf")  # of figures, where none is given
_OVER = Parameter(
    help="Other values of an axis, first:last:count or one,two,...: sliding.sliding_speed, contact.normal_load,"
    " drive.frequency, drive.voltage_peak_to_peak or, without a voltage, vibration.vibration_amplitude. May come"
    " again.",
    kind="KEY=VALUES",
    is_mapping=True,
)
_RUNS = Parameter(
    help=runs_help(
        "Measured runs to draw as points, and to interpolate from six on, with the quantities of both axes; a voltage"
        " gives its power, a load its stress. Columns"
    ),
    kind="RUNS.csv",
    option="--runs --measured",
    is_file=True,
)


@task
def map(  # noqa: A001 - the command's name
    rig: RigFile,
    *,
    kind: Annotated[
        Literal["velocity-stress", "velocity-power", "velocity-amplitude", "frequency-voltage", "frequency-amplitude"]
        | None,
        Parameter(
            help="Quantities that the map runs over; velocity-power by default, velocity-amplitude without a voltage."
        ),
    ] = None,
    over: Annotated[Values | None, _OVER] = None,
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    form: Annotated[
        Sequence[Literal["png", "pdf", "svg", "html"]],
        Parameter(help="png, pdf, svg or an interactive html; may come again."),
    ] = (),
    backend: Backend = "cpu",
    progress: Watch = None,
    cancelled: Stop = None,
) -> "MapAnswer":
    """Map of friction reduction: over sliding speed or frequency, and stress, power, voltage or vibration amplitude.

    Example: sonolube map examples/rigs/power_map.toml --kind velocity-power
    """
    known = rig_of(rig)
    refuse_replaced(known, over or {})
    chosen = _kind(known, kind)
    axes = _axes(known, chosen, over or {})
    measured = runs_of(runs, mapping)
    if measured is not None:
        require_mappable(measured, kind=chosen, commanded=commanded_quantity(known))
    with stage("mapping"):
        mapped = design.MAPS[chosen](known, **axes, backend=backend)
    left_out: tuple[str, ...] = ()
    if measured is not None:
        measured, left_out = runs_on_map(measured, known, mapped)
    return MapAnswer(
        rig=known,
        mapped=mapped,
        runs=measured,
        interpolated=None if measured is None else runs_map(measured, kind=chosen),
        forms=tuple(form) or _FORMS,
        left_out=left_out,
    )


@answer
class MapAnswer(Answer):
    """Map of friction reduction: its greatest value, the ridge of sufficient power, and the measured runs."""

    rig: Rig
    mapped: "xr.Dataset"
    runs: "xr.Dataset | None"
    interpolated: "xr.Dataset | None"
    forms: tuple[str, ...]
    left_out: tuple[str, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """Greatest reduction, ridge, and points without a result."""
        failures = [("without result", f"{count}: {reason}") for reason, count in self._failures().items()]
        return [
            f"{self.rig.title}, {self.mapped['status'].size} points, {friction_model_text(self.rig)}",
            Rows([*amplitude_rows(self.rig), *self._facts(), *failures]),
        ]

    def object(self) -> dict[str, Any]:
        """Greatest reduction with the point where it occurs, and the number of points without a result."""
        return {
            "rig": self.rig.title,
            "map": self._kind,
            "friction_model": self.rig.friction_model.name,
            **amplitude_object(self.rig),
            "same_panels": bool(panels_text(self.mapped)),
            "points": int(self.mapped["status"].size),
            "without_result": int(self.mapped["friction_reduction"].isnull().sum()),
            "most_reduction": si(_greatest(self.mapped)),
        }

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point and of ratios on the map, and runs without a place on it."""
        ratios = 1 - self.mapped["friction_reduction"].values
        return (*operating_caveats(self.rig), *ratio_caveats(friction_ratio=ratios), *self.left_out)

    def figures(self) -> Mapping[str, Drawing]:
        """Contours of the map, and those between the measured runs."""
        forms = tuple(form for form in self.forms if form != "html")
        runs, between = self.runs, self.interpolated
        drawings = {
            self._name: Drawing(
                chart=lambda: map_chart(self.mapped, measured=runs), caption=self._caption(), forms=forms
            )
        }
        if runs is not None and between is not None:
            drawings[f"{self._name}-measured"] = Drawing(
                chart=lambda: measured_map_chart(between, runs), caption=_MEASURED_CAPTION, forms=forms
            )
        return drawings

    def files(self) -> "Mapping[str, str | xr.Dataset]":
        """Interactive page where it is wanted, and the datasets."""
        files: dict[str, str | xr.Dataset] = {}
        if "html" in self.forms:
            files[f"{self._name}.html"] = map_page(self.mapped)
        files[f"{self._name}.nc"] = self.mapped
        if self.interpolated is not None:
            files[f"{self._name}-measured.nc"] = self.interpolated
        return files

    def page(self) -> Page:
        """Page `map.html`."""
        across, up, panel = map_layout(self.mapped)
        return Page(
            name="map",
            title=f"Friction reduction over {_lower(across)} and {_lower(up)}: {self.rig.title}",
            settings=rig_settings(self.rig),
            facts=[("points", f"{self.mapped['status'].size}"), *self._facts(), *self._run_facts()],
            tables=[*_panel_tables(self.mapped, panel), *status_tables(self.mapped, self._failures())],
        )

    @property
    def _kind(self) -> str:
        """Kind of the map, such as "velocity-power"."""
        return str(self.mapped.attrs["map"])

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-{self._kind}"

    def _facts(self) -> list[tuple[str, str]]:
        """Greatest reduction, and the ridge where the map has one."""
        facts = [("panels", text)] if (text := panels_text(self.mapped)) else []
        values = [format_si(value, quantity(name).unit) for name, value in _greatest(self.mapped).items()]
        if values:
            facts.append(("most reduction", f"{values[0]} at {', '.join(values[1:])}"))
        ridge = _ridge(self.mapped)
        if ridge:
            facts.append(("ridge", f"{ridge}; beyond it doubling the power buys less than 5 %"))
        return facts

    def _run_facts(self) -> list[tuple[str, str]]:
        """Number of measured runs, their scatter and their leave-one-out error."""
        if self.runs is None:
            return []
        count = f"{self.runs.sizes['run']}"
        if self.interpolated is None:
            return [("measured runs", f"{count}; {FEWEST_RUNS} make a map of their own")]
        scatter, error = (100 * float(self.interpolated.attrs[name]) for name in ("scatter", "leave_one_out_error"))
        text = f"scatter {scatter:.2g} % about a smooth map, leave-one-out error {error:.2g} %"
        return [("measured runs", f"{count}; {text}")]

    def _failures(self) -> dict[str, int]:
        """Number of points without a result, by the reason."""
        return failure_counts(self.mapped, outcome="friction_reduction")

    def _caption(self) -> str:
        """Caption of the contours."""
        caption = "Friction reduction by the model."
        if _ridge(self.mapped):
            caption += " Dashed: the power beyond which doubling it reduces friction by less than another 5 %."
        return caption if self.runs is None else f"{caption} Circles: measured runs, with their reductions in percent."


def _kind(rig: Rig, kind: str | None) -> str:
    """Kind of map that was chosen, which the rig must have, or its default one."""
    quantity = commanded_quantity(rig)
    known = map_kinds(quantity)
    if kind is None or kind in known:
        return kind or known[0]
    if quantity is AMPLITUDE:
        raise InvalidInput(
            f"{shown('kind')} {kind} needs a drive voltage, and {rig.title} has an amplitude alone: take"
            f" {shown('kind')} {_listed(known)}, or give {VOLTAGE.key}"
        )
    raise InvalidInput(
        f"{shown('kind')} {kind} is for a rig without a drive voltage, and that of {rig.title} sets its amplitude:"
        f" take {shown('kind')} {_listed(known)}"
    )


def _listed(names: Sequence[str]) -> str:
    """Names in a sentence, the last after "or"."""
    return f"{', '.join(names[:-1])} or {names[-1]}"


def _axes(rig: Rig, kind: str, over: Values) -> dict[str, Floats]:
    """Values of each axis of a kind of map: those given, and the default ones of the others."""
    axes = default_axes(rig, kind=kind)
    across_and_up = list(axes)[:2]
    for key, given in values_by_key(over).items():
        name, values = key.rpartition(".")[2], np.atleast_1d(given)
        known = [each for each in _AXIS_KEYS if each.rpartition(".")[2] in axes]
        if key not in known:
            raise InvalidInput(f"{shown('over')} {key}: no axis of a {kind} map; its axes are {', '.join(known)}")
        if values.size < 2 and name in across_and_up:
            raise InvalidInput(f"{shown('over')} {key}: a {kind} map runs over it, and needs at least 2 values")
        axes[name] = values.astype(np.float64)
    return axes


def _greatest(mapped: "xr.Dataset") -> dict[str, float]:
    """Greatest reduction and the quantities where it occurs; empty where no point has a result."""
    point = extreme_point(mapped, outcome="friction_reduction", highest=True)
    if point is None:
        return {}
    names = ("friction_reduction", *_settings(mapped))
    return {name: float(point[name]) for name in names if point[name].ndim == 0}


def _settings(mapped: "xr.Dataset") -> tuple[str, ...]:
    """Quantities that a map runs over, and the power that goes with them."""
    return tuple(name for name in _SETTINGS if name in mapped.coords)


def _ridge(mapped: "xr.Dataset") -> str:
    """Range of the sufficient power; empty where the map does not reach it."""
    if "saturation_power" not in mapped or mapped["saturation_power"].isnull().all():
        return ""
    low, high = float(mapped["saturation_power"].min()), float(mapped["saturation_power"].max())
    return f"{format_si(low, 'W')} to {format_si(high, 'W')}"


def _panel_tables(mapped: "xr.Dataset", panel: str | None) -> list[PageTable]:
    """Greatest reduction in each panel, and the ridge where the map has one; none where all panels are the same."""
    if panel is None or panels_text(mapped):
        return []
    level = "actuator_power" if "actuator_power" in mapped.coords else AMPLITUDE.name
    names = [name for name in ("friction_reduction", "sliding_speed", level) if name != panel]
    rows = []
    for index in range(mapped.sizes[panel]):
        part = mapped.isel({panel: index})
        texts = {name: format_si(value, quantity(name).unit) for name, value in _greatest(part).items()}
        value = format_si(float(part[panel]), quantity(panel).unit)
        rows.append((value, *(texts.get(name, "") for name in names), _ridge(part)))
    heads = (quantity(panel).meaning, *(quantity(name).meaning for name in names), "Ridge")
    columns = slice(None) if any(row[-1] for row in rows) else slice(-1)
    return [PageTable(title="Most reduction", heads=heads[columns], rows=tuple(row[columns] for row in rows))]


def _lower(name: str) -> str:
    """Meaning of a quantity within a sentence, without what follows a comma."""
    meaning = quantity(name).meaning.partition(",")[0]
    return meaning[:1].lower() + meaning[1:]
