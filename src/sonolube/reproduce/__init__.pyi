from .chapters import SECTIONS as SECTIONS, reproduction as reproduction
from .row import Row as Row, Verdict as Verdict
from .section import ChapterFigure as ChapterFigure, Reproduction as Reproduction, Section as Section
