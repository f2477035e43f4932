"""The dissertation's data: every table, the numbers of its text, its figures and its errata.

D is "Friction and Wear Reduction via Ultrasonic Lubrication", the dissertation that sonolube implements. Numbers are
kept as the digits printed, so that their resolution is known; what speaks against one stands beside it as a correction.
"""

from sonolube.published.captions import Figure, figure, figures
from sonolube.published.misprints import Correction, Erratum, errata, erratum
from sonolube.published.number import PrintedNumber, parse_printed
from sonolube.published.previous_studies import PreviousStudy, previous_studies
from sonolube.published.running_text import Statement, statement, statements
from sonolube.published.tidy_table import Column, Role, Table, table, table_ids

__all__ = [
    "Column",
    "Correction",
    "Erratum",
    "Figure",
    "PreviousStudy",
    "PrintedNumber",
    "Role",
    "Statement",
    "Table",
    "errata",
    "erratum",
    "figure",
    "figures",
    "parse_printed",
    "previous_studies",
    "statement",
    "statements",
    "table",
    "table_ids",
]
