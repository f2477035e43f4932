"""Bodies whose sizes have their defaults in a table of sourced dimensions."""

from collections.abc import Callable, Iterable
from functools import wraps
from inspect import Parameter, signature
from typing import Any

from sonolube.models.fem.parts.transducers import SourcedDimension, Transducer


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
        return made

    return decorated
