"""Sizes of the parts of D with their sources, and bodies whose sizes have their defaults in a table of these."""

import tomllib
from collections.abc import Callable, Iterable
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, Final

from sonolube.models.fem import SourcedDimension, Transducer

SIZES: Final = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
"""Tables of the file beside this module by part."""


def sourced_dimensions(part: str) -> tuple[SourcedDimension, ...]:
    """Dimensions of a part of D with their sources, in the order of its table."""
    return tuple(SourcedDimension(name=name, **entry) for name, entry in SIZES[part].items())


def sized(dimensions: Iterable[SourcedDimension]) -> Callable[[Callable[..., Transducer]], Callable[..., Transducer]]:
    """Decorator of a function of a mapping of sizes: it then takes each size as a keyword, by default that of a table.

    The sizes stand in the signature in the order of the table, before the keywords with defaults of the function.
    """
    defaults = {each.name: each.value for each in dimensions}

    def decorated(body: Callable[..., Transducer]) -> Callable[..., Transducer]:
        bare = signature(body)
        own = list(bare.parameters.values())[1:]
        sizes = [
            Parameter(name, Parameter.KEYWORD_ONLY, default=value, annotation=float) for name, value in defaults.items()
        ]
        required = [each for each in own if each.default is each.empty]
        whole = bare.replace(parameters=[*required, *sizes, *(each for each in own if each not in required)])

        @wraps(body)
        def made(**given: Any) -> Transducer:
            whole.bind(**given)  # refuses what is no size
            others = {name: value for name, value in given.items() if name not in defaults}
            return body({name: given.get(name, value) for name, value in defaults.items()}, **others)

        made.__signature__ = whole  # type: ignore[attr-defined]
        del made.__wrapped__  # whose source has other defaults than the signature
        return made

    return decorated
