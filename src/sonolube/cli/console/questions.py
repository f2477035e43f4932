"""Questions on a terminal for what the options of a command do not give."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import typer

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.printable_text import printable

Value = TypeVar("Value")


@dataclass(frozen=True, kw_only=True)
class Question:
    """Question for what an option gives.

    Parameters
    ----------
    option : str
        As typed, such as "--load".
    text : str
        What is asked for, with an example.
    default : str
        Answer that an empty line stands for.
    """

    option: str
    text: str
    default: str


def is_terminal() -> bool:
    """Whether somebody can answer questions."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def ask(question: Question, read: Callable[[str], Value]) -> Value:
    """Answer to a question, asked again until it can be read.

    Parameters
    ----------
    question : Question
    read : callable
        Of the text that was typed; raises an error of sonolube for what is none.

    Returns
    -------
    object
        What `read` returns.

    Raises
    ------
    InvalidInput
        At the end of input.
    """
    while True:
        typer.echo(f"{question.text} [{question.default}]: ", nl=False, err=True)
        line = sys.stdin.readline()
        if not line:
            typer.echo(err=True)
            raise InvalidInput(f"the input ended at {question.option}; nothing is written")
        try:
            return read(line.strip() or question.default)
        except SonolubeError as refusal:
            typer.echo(f"  {printable(' '.join(str(refusal).split()))}", err=True)
