from .chapters import SECTIONS as SECTIONS, reproduction as reproduction
from .claim import Claim as Claim, ClaimVerdict as ClaimVerdict, Finding as Finding
from .claims import CLAIMS as CLAIMS
from .row import Alternative as Alternative, Row as Row, RowKind as RowKind, Verdict as Verdict
from .section import ChapterFigure as ChapterFigure, Reproduction as Reproduction, Section as Section
