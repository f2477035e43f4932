from .printed_tables import (
    Column as Column,
    Correction as Correction,
    Erratum as Erratum,
    PrintedNumber as PrintedNumber,
    Role as Role,
    Table as Table,
    errata as errata,
    erratum as erratum,
    parse_printed as parse_printed,
    table as table,
    table_ids as table_ids,
)
from .running_text import (
    FigureCaption as FigureCaption,
    PreviousStudy as PreviousStudy,
    Statement as Statement,
    figure as figure,
    figures as figures,
    previous_studies as previous_studies,
    statement as statement,
    statements as statements,
)
from .values import (
    ComputedValue as ComputedValue,
    PublishedValue as PublishedValue,
    as_exact as as_exact,
    as_setting as as_setting,
    column_numbers as column_numbers,
    propagate_rounding as propagate_rounding,
    published_number as published_number,
    published_value as published_value,
    si_value as si_value,
)
