"""Sheets of surface files: parameters of ISO 25178-2 and, of profiles, of ISO 21920, spectra and summits."""

import math
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Rule, envelope, one_panel
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import SurfaceFile, read_surface_file
from sonolube.models import surfaces
from sonolube.models.surfaces import HeightMap, ProfileEvaluation, ProfileSpectrum
from sonolube.report.measured import sheet, surface_figures as figures
from sonolube.report.measured.sheet import captioned
from sonolube.report.measured.surface_figures import WAVENUMBER, length_scale
from sonolube.text.units import format_si, to_si

_LABELS: Mapping[str, Mapping[str, str]] = tomllib.loads(
    Path(__file__).with_name("surface_labels.toml").read_text(encoding="utf-8")
)
_PROFILE_BINS = 5000  # along the page, more than it resolves


@captioned("Profile", "Above, the primary profile without form; below, the profile evaluated, with its sections.")
def profile_figure(found: ProfileEvaluation, *, spacing: float) -> Chart:
    """Primary profile above the one evaluated."""
    x = spacing * np.arange(found.primary.size, dtype=np.float64)
    across, per_metre = length_scale(x)
    edges = found.start * spacing + found.section_length * np.arange(found.section_count + 1)
    marks = [Rule(value=per_metre * float(edge), colour="0.5") for edge in edges]
    zero = Rule(value=0.0, along="y", colour="0.5", dash=0)
    panels = []
    for heights, start, colour, others in (
        (found.primary, 0, 0, ()),
        (found.evaluated, found.start, 1, (*marks, zero)),
    ):
        unit, scale = length_scale(heights)
        place, height = envelope(per_metre * x[start : start + heights.size], scale * heights, bins=_PROFILE_BINS)
        parts: tuple[Part, ...] = (Line(x=place, y=height, colour=colour, weight=0.6), *others)
        panels.append(Panel(x=Axis("x", across), y=Axis("Height", unit), parts=parts))
    return Chart(panels=tuple(panels), size=(7.4, 4.2), shares_x=True)


@captioned("Power spectrum", "Of the primary profile, two-sided; dashed, the cutoff of the L-filter.")
def spectrum_figure(found: ProfileSpectrum, *, cutoff: float | None) -> Chart:
    """Power spectral density of a profile."""
    inner = (found.wavenumber > 0) & (found.profile_spectral_density > 0)
    curve = Line(x=found.wavenumber[inner], y=found.profile_spectral_density[inner], weight=0.6)
    filtered = () if cutoff is None else (Rule(value=1 / cutoff, colour="0.3", dash=1),)
    density = Axis("Power spectral density", "m³", logarithmic=True)
    return one_panel(WAVENUMBER, density, (curve, *filtered), size=(4.6, 3.2))


def is_profile(surface: HeightMap) -> bool:
    """Whether a height map is one row or one column."""
    return 1 in surface.height.shape


def profile_sheet(
    file: SurfaceFile,
    *,
    source: dict[str, str],
    degree: int,
    robust: bool,
    short_cutoff_length: float | None,
    long_cutoff_length: float | None,
) -> sheet.Sheet:
    """Profile parameters and power spectrum of a file that holds one profile."""
    heights = file.height_map.height
    spacing = file.height_map.spacing_x if heights.shape[0] == 1 else file.height_map.spacing_y
    found = surfaces.evaluate_profile(
        height=heights.ravel(),
        spacing=spacing,
        degree=degree,
        robust=robust,
        short_cutoff_length=short_cutoff_length,
        long_cutoff_length=long_cutoff_length,
    )
    parts = [
        sheet.Sheet(caveats=file.caveats),
        _parameters(found),
        _settings(found, spacing),
        sheet.Sheet(figures=(profile_figure(found, spacing=spacing),)),
        sheet.attempted(partial(_spectrum, found, spacing), what="spectrum"),
    ]
    setting_class = f"{found.setting_class} of ISO 21920-3" if found.setting_class else "none of ISO 21920-3"
    return sheet.joined(parts, title=file.path.name, source=source | {"setting class": setting_class})


def _parameters(found: ProfileEvaluation) -> sheet.Sheet:
    """Parameters of the roughness profile, R, or of the primary profile, P."""
    letter = "P" if found.long_cutoff_length is None else "R"
    values = {name: getattr(found.parameters, name) for name in _LABELS["evaluated_profile"]}
    missing = () if values["mean_profile_element_spacing"] else (f"{letter}sm: no complete profile element",)
    return sheet.Sheet(
        values=tuple(
            sheet.quantity_value(name, value, label=letter + _LABELS["evaluated_profile"][name])
            for name, value in values.items()
            if value is not None
        ),
        caveats=found.caveats,
        not_found=missing,
    )


def _settings(found: ProfileEvaluation, spacing: float) -> sheet.Sheet:
    """Cutoffs and lengths of the evaluation."""
    lengths = {
        "long_cutoff_length": (found.long_cutoff_length, "Cutoff of the L-filter, lambda_c"),
        "short_cutoff_length": (found.short_cutoff_length, "Cutoff of the S-filter, lambda_s"),
        "section_length": (found.section_length, f"Section length, of {found.section_count} evaluated"),
        "evaluation_length": (found.evaluated.size * spacing, "Evaluation length"),
    }
    return sheet.Sheet(
        values=tuple(
            sheet.Value(name, label, length, "m") for name, (length, label) in lengths.items() if length is not None
        )
    )


def _spectrum(found: ProfileEvaluation, spacing: float) -> sheet.Sheet:
    """Figure of the power spectrum of the primary profile."""
    row = HeightMap(height=found.primary[None, :], spacing_x=spacing, spacing_y=spacing)
    return sheet.Sheet(figures=(spectrum_figure(surfaces.profile_spectrum(row), cutoff=found.long_cutoff_length),))


_COARSENINGS = (1, 2, 4, 8)  # times the pixel, at which summits are sought


@dataclass(frozen=True, kw_only=True, slots=True)
class SurfaceSettings:
    """Settings of the evaluation of a height map.

    Parameters
    ----------
    spacing_x, spacing_y : float or None
        Distance of neighbouring columns and rows, for files that do not say. [m]
    length_unit : str or None
        Unit of the lengths, for files that do not say.
    degree : int
        Of the form taken off first: 1 a plane, 2 with cylinder and sphere.
    robust : bool
        Whether pixels far from the form lose their weight.
    short_cutoff_length : float or None
        Shorter waves are taken off, as noise. [m]
    long_cutoff_length : float or None
        Longer waves are taken off, as waviness. [m]
    """

    spacing_x: float | None = None
    spacing_y: float | None = None
    length_unit: str | None = None
    degree: int = 1
    robust: bool = False
    short_cutoff_length: float | None = None
    long_cutoff_length: float | None = None


def spacings(text: str | float | None, *, name: str) -> tuple[float | None, float | None]:
    """Distances of columns and rows from a number or text such as "0.5um" or "0.5um,0.6um"; None without it. [m]"""
    if text is None or not isinstance(text, str):
        return text, text
    first, _, second = text.partition(",")
    along = to_si(first, unit="m", name=name)
    return along, to_si(second, unit="m", name=name) if second else along


def surface_sheet(path: Path, *, settings: SurfaceSettings) -> sheet.Sheet:
    """Areal and profile parameters, spectra and summits of a surface file, or profile parameters of one profile."""
    file = surface_file(path, settings)
    if is_profile(file.height_map):
        return profile_sheet(
            file,
            source=surface_source(file),
            degree=settings.degree,
            robust=settings.robust,
            short_cutoff_length=settings.short_cutoff_length,
            long_cutoff_length=settings.long_cutoff_length,
        )
    levelled = surfaces.remove_form(file.height_map, degree=settings.degree, robust=settings.robust)
    surface = _filtered(levelled, settings)
    sections = [sheet.Sheet(caveats=(*file.caveats, *_spikes(levelled))), _part(surfaces.height_parameters(surface))]
    for measure in (
        surfaces.hybrid_parameters,
        surfaces.spatial_parameters,
        surfaces.functional_parameters,
        surfaces.feature_parameters,
    ):
        name = measure.__name__.replace("_", " ")
        sections.append(sheet.attempted(lambda measure=measure: _part(measure(surface)), what=name))  # type: ignore[misc]
    sections += [
        sheet.attempted(partial(_summits, surface), what="summits"),
        sheet.attempted(partial(_profiles, surface), what="profile parameters"),
        sheet.attempted(partial(_sampling, surface), what="summits at coarser sampling"),
        sheet.attempted(partial(_waviness, levelled), what="waviness"),
        _figures(surface),
    ]
    return sheet.joined(sections, title=path.name, source=surface_source(file))


def _spikes(levelled: HeightMap) -> tuple[str, ...]:
    """Caveat on pixels that stand out of their neighbours, with the roughness and the summits without them."""
    heights = surfaces.spike_heights(levelled)
    count = int(np.count_nonzero(heights))
    if not count:
        return ()
    without = levelled.with_height(levelled.height - heights)
    rms, highest = surfaces.height_parameters(without).rms_height, float(np.max(np.abs(heights)))
    told = f"without them Sq is {format_si(rms, 'm')}"
    with suppress(InvalidInput):  # no summits
        told += f" and the summit radius {format_si(surfaces.summit_statistics(without).summit_radius, 'm')}"
    return (
        f"{count} of {heights.size} pixels stand up to {format_si(highest, 'm')} out of their neighbours: spikes, which"
        f" all parameters contain; {told}; take them off in the profilometer's software",
    )


def surface_file(path: Path, settings: SurfaceSettings) -> SurfaceFile:
    """Height map of a file, with spacing and unit by the settings where the file does not say."""
    return read_surface_file(
        path, spacing_x=settings.spacing_x, spacing_y=settings.spacing_y, length_unit=settings.length_unit
    )


def surface_source(file: SurfaceFile) -> dict[str, str]:
    """Origin of a height map: format, instrument, pixels, field, lateral unit and digest."""
    rows, columns = file.height_map.height.shape
    steps = file.height_map.spacing_x, file.height_map.spacing_y
    return {
        "format": file.format_name,
        "title": file.title,
        "instrument": file.instrument,
        "measured": f"{file.measured_at:%Y-%m-%d %H:%M}" if file.measured_at else "",
        **_grid((columns, rows), steps),
        "lateral unit": file.lateral_unit,
        "not measured": f"{file.height_map.missing_fraction:.2%}",
        "sha256": file.sha256,
    }


def _grid(points: tuple[int, int], steps: tuple[float, float]) -> dict[str, str]:
    """Pixels and field of a map, or points and length of a profile."""
    sizes = [format_si(count * step, "m", digits=4) for count, step in zip(points, steps, strict=True)]
    distances = [format_si(step, "m", digits=4) for step in steps]
    if 1 not in points:
        return {"pixels": f"{points[0]} x {points[1]}, {' x '.join(distances)}", "field": " x ".join(sizes)}
    along = 0 if points[1] == 1 else 1
    return {"points": f"{points[along]}, {distances[along]} apart", "length": sizes[along]}


def _filtered(levelled: surfaces.HeightMap, settings: SurfaceSettings) -> surfaces.HeightMap:
    """Surface between the cutoff lengths."""
    short, long = settings.short_cutoff_length, settings.long_cutoff_length
    if short is not None and long is not None and short >= long:
        raise InvalidInput(f"the short cutoff, {short:.3g} m, must be below the long one, {long:.3g} m")
    surface = levelled
    if short is not None:
        surface = surfaces.low_pass(surface, cutoff_length=short)
    if long is not None:
        surface = surfaces.high_pass(surface, cutoff_length=long)
    return surface


def _part(record: object) -> sheet.Sheet:
    """Areal parameters of a record, labelled with their symbols."""
    names = [each.name for each in fields(record) if each.name in _LABELS["areal"]]  # type: ignore[arg-type]
    small = not getattr(record, "decays_in_all_directions", True)
    return sheet.Sheet(
        values=tuple(sheet.quantity_value(name, getattr(record, name), label=_LABELS["areal"][name]) for name in names),
        caveats=("Str is an upper bound: the map is too small for its texture",) if small else (),
    )


def _summits(surface: surfaces.HeightMap) -> sheet.Sheet:
    """Density, radius and heights of the summits, and the bandwidth of the spectrum."""
    found, moments = surfaces.summit_statistics(surface), surfaces.spectral_moments(surface)
    for_contact = surfaces.contact_roughness(surface)
    names = ("summit_density", "summit_radius", "summit_height_deviation", "mean_summit_height")
    return sheet.Sheet(
        values=(
            *(sheet.field_value(found, name) for name in names),
            sheet.field_value(moments, "bandwidth", "Bandwidth of the spectrum, Nayak's alpha"),
            sheet.field_value(for_contact, "roughness_parameter"),
        ),
        rig_entries=sheet.rig_entries("contact.roughness", asdict(for_contact)),
    )


def _profiles(surface: surfaces.HeightMap) -> sheet.Sheet:
    """Mean and deviation of profile parameters over all rows and columns."""
    rows = []
    for along in ("rows", "columns"):
        if min(surface.height.shape) > 1 or surface.height.shape[along == "rows"] > 1:
            found = surfaces.profile_statistics(surface, along=along)
            for kind, record in (("mean", found.mean), ("deviation", found.standard_deviation)):
                values = (getattr(record, name) for name in _LABELS["profiles"])
                rows.append((f"{found.profile_count} {along}", kind, *values))
    columns = (
        sheet.Column("profiles", "Profiles"),
        sheet.Column("statistic", ""),
        *sheet.quantity_columns(_LABELS["profiles"]),
    )
    return sheet.Sheet(tables=(sheet.Table("profiles", "Profile parameters", columns, tuple(rows)),))


def _sampling(surface: surfaces.HeightMap) -> sheet.Sheet:
    """Roughness for the contact models at multiples of the sampling interval."""
    pixel = math.sqrt(surface.spacing_x * surface.spacing_y)
    rows: list[tuple[float, ...]] = []
    for times in _COARSENINGS:
        try:
            found = surfaces.sampling_dependence(surface, sampling_interval=times * pixel)
        except InvalidInput:
            break
        rows.append(tuple(float(getattr(found, name)[0]) for name in _LABELS["sampling"]))
    title = "Roughness for the contact models, by sampling interval"
    table = sheet.Table("sampling", title, sheet.quantity_columns(_LABELS["sampling"]), tuple(rows))
    return sheet.Sheet(tables=(table,)) if rows else sheet.Sheet()


def _waviness(levelled: surfaces.HeightMap) -> sheet.Sheet:
    """Wavelengths of the waviness along rows and columns."""
    rows = [
        (along, float(length))
        for along in ("rows", "columns")
        for length in surfaces.dominant_wavelengths(levelled, along=along)
    ]
    columns = (sheet.Column("along", "Along"), *sheet.quantity_columns({"waviness_length": "Wavelength"}))
    return sheet.Sheet(tables=(sheet.Table("waviness", "Waviness", columns, tuple(rows)),))


def _figures(surface: surfaces.HeightMap) -> sheet.Sheet:
    """Heights, Abbott curve, power spectrum and autocorrelation."""
    caption = "Share of the surface at or above each height, with the core by its equivalent line."
    abbott = sheet.captioned("Abbott curve", caption)(figures.abbott)
    pictures = [figures.heights(surface), abbott(surfaces.material_ratio_curve(surface))]
    try:
        spectrum = surfaces.radial_spectrum(surfaces.areal_spectrum(surface))
        correlation = surfaces.autocorrelation(surface)
    except InvalidInput as refusal:
        return sheet.Sheet(figures=tuple(pictures), not_found=(f"spectrum: {refusal}",))
    pictures += [figures.spectrum(spectrum), figures.correlation(correlation)]
    return sheet.Sheet(figures=tuple(pictures))
