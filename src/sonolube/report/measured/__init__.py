"""Sheets of measured files: values with units and uncertainty, tables, figures and caveats."""
