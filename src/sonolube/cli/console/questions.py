"""Questions on a terminal for what the options of a command do not give."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import typer

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.operating_system import TypedLines
from sonolube.text.printable_text import printable

if TYPE_CHECKING:
    from sonolube.facts.protocol import Prompt
    from sonolube.laboratory import RunControl

_POLL = 0.1  # s, between two looks at requests to end while an operator is asked


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


def ask(question: Question, read: Callable[[str], object]) -> str:
    """Answer to a question, asked again until it can be read."""
    while True:
        typer.echo(f"{question.text} [{question.default}]: ", nl=False, err=True)
        line = sys.stdin.readline()
        if not line:
            typer.echo(err=True)
            raise InvalidInput(f"the input ended at {question.option}; nothing is written")
        answer = line.strip() or question.default
        try:
            read(answer)
        except SonolubeError as refusal:
            typer.echo(f"  {printable(' '.join(str(refusal).split()))}", err=True)
        else:
            return answer


def operator_arguments() -> dict[str, Any]:
    """Arguments of a run by which a person at the terminal confirms its prompts; none where nobody can."""
    if not is_terminal():
        return {}
    from sonolube.laboratory import RunControl

    control = RunControl()
    return {"control": control, "operator": Operator(control)}


@dataclass(frozen=True, slots=True)
class Operator:
    """Person at the terminal who confirms prompts; requests to end the run are heard meanwhile.

    Parameters
    ----------
    control : RunControl
    """

    control: "RunControl"

    def __call__(self, prompt: "Prompt") -> bool:
        """Show a prompt, and return whether it is confirmed by an empty line or by yes."""
        sys.stderr.write(printable(f"\r\x1b[K{prompt.task}: {prompt.text}\n  done? [Y/n] "))
        sys.stderr.flush()
        lines = TypedLines()
        while not self.control.stop_reason:
            answer = lines.next(_POLL)
            if answer is not None:
                if not answer:
                    self.control.stop("the input has ended")
                return bool(answer) and answer.strip().lower() in ("", "y", "yes")
        return False
