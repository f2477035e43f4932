from .captions import FigureCaption as FigureCaption, figure as figure, figures as figures
from .corrections import Correction as Correction, Erratum as Erratum, errata as errata, erratum as erratum
from .literature_review import PreviousStudy as PreviousStudy, previous_studies as previous_studies
from .printed_number import PrintedNumber as PrintedNumber, parse_printed as parse_printed
from .printed_tables import Column as Column, Role as Role, Table as Table, table as table, table_ids as table_ids
from .rounding import (
    ComputedValue as ComputedValue,
    as_exact as as_exact,
    as_setting as as_setting,
    propagate_rounding as propagate_rounding,
)
from .running_text import Statement as Statement, statement as statement, statements as statements
from .values import (
    PublishedValue as PublishedValue,
    column_numbers as column_numbers,
    published_number as published_number,
    published_value as published_value,
    si_value as si_value,
)
