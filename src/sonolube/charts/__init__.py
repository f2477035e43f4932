"""Figures as data: panels with axes, curves, bands and points, drawn by Matplotlib or by a browser."""

from sonolube.charts.chart import Axis, Band, Bars, Chart, Field, Line, Note, Panel, Part, Points, Rule, Zone, one_panel
from sonolube.charts.chart_object import chart_object, chart_tables, envelope
from sonolube.charts.draw import draw_chart

__all__ = [
    "Axis",
    "Band",
    "Bars",
    "Chart",
    "Field",
    "Line",
    "Note",
    "Panel",
    "Part",
    "Points",
    "Rule",
    "Zone",
    "chart_object",
    "chart_tables",
    "draw_chart",
    "envelope",
    "one_panel",
]
