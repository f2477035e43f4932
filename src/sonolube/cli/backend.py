"""The option that chooses who computes, and the line that says when a GPU asked for is not used."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from typing import Annotated

import typer


class Backend(StrEnum):
    """Who computes."""

    CPU = "cpu"
    GPU = "gpu"


BackendName = Annotated[
    Backend,
    typer.Option(
        "--backend", help="Who finds the vibrations; gpu needs an NVIDIA GPU and sonolube[gpu], else the cpu does."
    ),
]


@contextmanager
def told_if_unused() -> Iterator[None]:
    """Turn the warning that a GPU is not used into one line for the user."""
    from sonolube.errors import GpuUnused

    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", GpuUnused)
        yield
    others = [each for each in raised if not issubclass(each.category, GpuUnused)]
    for text in dict.fromkeys(str(each.message) for each in raised if issubclass(each.category, GpuUnused)):
        typer.echo(f"backend gpu: {text}", err=True)
    for each in others:
        warnings.warn_explicit(each.message, each.category, each.filename, each.lineno, source=each.source)
