"""Reports: results as a page that people read and a file that programs read."""

from sonolube.report.findings import Finding, FindingTable, write_findings
from sonolube.report.measurement import (
    MeasurementReport,
    measurement_lines,
    measurement_object,
    write_measurement_report,
)
from sonolube.report.pin_on_disc_sheet import TestSheet, read_test_sheet, test_sheet_table
from sonolube.report.reproduction import summary, validation_object, write_report

__all__ = [
    "Finding",
    "FindingTable",
    "MeasurementReport",
    "TestSheet",
    "measurement_lines",
    "measurement_object",
    "read_test_sheet",
    "summary",
    "test_sheet_table",
    "validation_object",
    "write_findings",
    "write_measurement_report",
    "write_report",
]
