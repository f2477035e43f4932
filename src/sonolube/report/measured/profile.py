"""Sheets of line profiles: parameters of ISO 21920-2 with the settings of ISO 21920-3, and power spectrum."""

from functools import partial

from sonolube.measurement.surface_files.reader import SurfaceFile
from sonolube.models import surfaces
from sonolube.models.surfaces import HeightMap, ProfileEvaluation
from sonolube.report.measured import profile_figures as figures, sheet

_LABELS = {
    "arithmetic_mean_height": "a, arithmetic mean height",
    "rms_height": "q, root-mean-square height",
    "mean_section_height": "z, maximum height of a section, mean",
    "mean_section_peak_height": "p, peak height of a section, mean",
    "mean_section_pit_depth": "v, pit depth of a section, mean",
    "total_height": "t, total height",
    "skewness": "sk, skewness",
    "kurtosis": "ku, kurtosis",
    "mean_profile_element_spacing": "sm, mean profile element spacing",
}


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
        sheet.Sheet(figures=(figures.profile_figure(found, spacing=spacing),)),
        sheet.attempted(partial(_spectrum, found, spacing), what="spectrum"),
    ]
    setting_class = f"{found.setting_class} of ISO 21920-3" if found.setting_class else "none of ISO 21920-3"
    return sheet.joined(parts, title=file.path.name, source=source | {"setting class": setting_class})


def _parameters(found: ProfileEvaluation) -> sheet.Sheet:
    """Parameters of the roughness profile, R, or of the primary profile, P."""
    letter = "P" if found.long_cutoff_length is None else "R"
    values = {name: getattr(found.parameters, name) for name in _LABELS}
    missing = () if values["mean_profile_element_spacing"] else (f"{letter}sm: no complete profile element",)
    return sheet.Sheet(
        values=tuple(
            sheet.quantity_value(name, value, label=letter + _LABELS[name])
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
    return sheet.Sheet(
        figures=(figures.spectrum_figure(surfaces.profile_spectrum(row), cutoff=found.long_cutoff_length),)
    )
