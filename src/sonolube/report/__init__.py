"""Reports: results as self-contained pages for people and as JSON for programs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sonolube.report.measurement import (
        MeasurementReport,
        measurement_caveats,
        measurement_lines,
        measurement_object,
        measurement_page,
        write_measurement_report,
    )
    from sonolube.report.page import Drawing, Page, PageTable, rendered_files
    from sonolube.report.pin_on_disc_sheet import PinOnDiscSheet, pin_on_disc_rows, read_pin_on_disc_sheet
    from sonolube.report.reproduction import reproduction_files, summary_lines, validation_object, write_report

__all__ = [
    "Drawing",
    "MeasurementReport",
    "Page",
    "PageTable",
    "PinOnDiscSheet",
    "measurement_caveats",
    "measurement_lines",
    "measurement_object",
    "measurement_page",
    "pin_on_disc_rows",
    "read_pin_on_disc_sheet",
    "rendered_files",
    "reproduction_files",
    "summary_lines",
    "validation_object",
    "write_measurement_report",
    "write_report",
]

_MODULES = {
    "page": ("Drawing", "Page", "PageTable", "rendered_files"),
    "pin_on_disc_sheet": ("PinOnDiscSheet", "pin_on_disc_rows", "read_pin_on_disc_sheet"),
    "reproduction": ("reproduction_files", "summary_lines", "validation_object", "write_report"),
}


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Public name, imported from its module when it is first used."""
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module = next((module for module, names in _MODULES.items() if name in names), "measurement")
        return getattr(import_module(f"{__name__}.{module}"), name)

    def __dir__() -> list[str]:
        """Public names, for documentation and completion."""
        return __all__
