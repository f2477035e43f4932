"""Warning that a GPU is not used, as one line."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import typer


@contextmanager
def gpu_warning() -> Iterator[None]:
    """Print the warning that a GPU is not used as one line on standard error; pass other warnings on."""
    from sonolube.errors import GpuUnused

    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", GpuUnused)
        yield
    unused = [str(each.message) for each in raised if issubclass(each.category, GpuUnused)]
    for text in dict.fromkeys(unused):
        typer.echo(f"backend gpu: {text}", err=True)
    for each in raised:
        if not issubclass(each.category, GpuUnused):
            warnings.warn_explicit(each.message, each.category, each.filename, each.lineno, source=each.source)
