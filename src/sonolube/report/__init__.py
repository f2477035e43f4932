"""Reports: results as a page that people read and a file that programs read."""

from sonolube.report.reproduction import summary, validation_object, write_report

__all__ = ["summary", "validation_object", "write_report"]
