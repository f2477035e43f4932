"""Measured files as sheets: values with units and uncertainty, tables and figures, ready for page, JSON or terminal."""
