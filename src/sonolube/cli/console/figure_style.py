"""Option `--style` of all commands that draw figures."""

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import Any, get_type_hints

from sonolube.cli.console.options import FigureStyleName, Style
from sonolube.cli.console.outputs import OutputFolder, output_marks

_REPORT = "report"  # argument of a page with figures


def with_figure_style(command: Callable[..., None]) -> Callable[..., None]:
    """Command with the option `--style`, where it writes figures into a folder or a page.

    Parameters
    ----------
    command : callable
        With the mark `OutputFolder` at an argument, or a `report`; others are returned as they are.

    Returns
    -------
    callable
    """
    marks = output_marks(command)
    if _REPORT not in marks and not any(isinstance(mark, OutputFolder) for mark in marks.values()):
        return command

    @wraps(command)
    def run(*, style: FigureStyleName, **arguments: Any) -> None:
        from sonolube.figure import figure_style

        with figure_style(style.value):
            command(**arguments)

    hints = get_type_hints(command, include_extras=True)
    given = [each.replace(annotation=hints[name]) for name, each in signature(command).parameters.items()]
    option = Parameter("style", Parameter.KEYWORD_ONLY, default=FigureStyleName.JOURNAL, annotation=Style)
    run.__signature__ = signature(command).replace(parameters=[*given, option])  # type: ignore[attr-defined]
    run.__annotations__ = {**hints, "style": Style}
    return run


def without_artist_docstrings() -> None:
    """Have matplotlib leave lists of properties out of docstrings, which take a fifth of its import."""
    import matplotlib.artist

    matplotlib.artist.kwdoc = lambda artist: ""
