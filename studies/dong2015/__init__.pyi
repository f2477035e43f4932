from .chapters import (
    SECTIONS as SECTIONS,
    ChapterFigure as ChapterFigure,
    Reproduction as Reproduction,
    Section as Section,
    reproduction as reproduction,
)
from .claims import CLAIMS as CLAIMS, Claim as Claim, ClaimVerdict as ClaimVerdict, Finding as Finding
from .report import (
    reproduction_files as reproduction_files,
    summary_lines as summary_lines,
    validation_object as validation_object,
    write_report as write_report,
)
from .row import Alternative as Alternative, Row as Row, RowKind as RowKind, Verdict as Verdict
