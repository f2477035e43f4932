"""Variables of a repeat: its steps written out for every combination of their values."""

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, Final

MAX_STEPS: Final = 10_000
"""Number of steps of a repeat, written out for all values of its variables."""

_NAME: Final = re.compile(r"[A-Za-z]\w{0,63}")


def written_out(content: Mapping[str, Any]) -> dict[str, Any]:
    """Content of a repeat with its steps written out for the values of its variables, which it then has no more."""
    over, steps = content.get("over"), content.get("steps")
    if not over or not isinstance(over, Mapping) or not isinstance(steps, Sequence) or isinstance(steps, str):
        return dict(content)
    for name, values in over.items():
        if not _is_list_of_texts(values):
            raise ValueError(f'over.{name}: must be a list of texts, such as ["3 N", "6 N"]')
        if not _NAME.fullmatch(name):
            raise ValueError(f"over: {name[:40]!r} is no name of a variable; letters, digits and _, such as speed")
        if f"{{{name}}}" not in "".join(_texts(steps)):
            raise ValueError(f"over: no step uses {{{name}}}")
    count = len(steps)
    for values in over.values():
        count *= len(values)
    if count > MAX_STEPS:
        raise ValueError(f"over: {count} steps with all values; at most {MAX_STEPS}")
    repeated = [
        _substituted(step, dict(zip(over, values, strict=True))) for values in product(*over.values()) for step in steps
    ]
    return {key: value for key, value in content.items() if key != "over"} | {"steps": repeated}


def _is_list_of_texts(values: object) -> bool:
    """Whether values of a variable are a list of texts that is not empty."""
    return isinstance(values, list | tuple) and bool(values) and all(isinstance(each, str) for each in values)


def _texts(content: object) -> Iterator[str]:
    """All texts within lists and tables."""
    if isinstance(content, str):
        yield content
    elif isinstance(content, Mapping):
        for value in content.values():
            yield from _texts(value)
    elif isinstance(content, list | tuple):
        for value in content:
            yield from _texts(value)


def _substituted(content: Any, values: Mapping[str, str]) -> Any:
    """Content with the values of variables in its texts."""
    if isinstance(content, str):
        for name, value in values.items():
            content = content.replace(f"{{{name}}}", value)
        return content
    if isinstance(content, Mapping):
        return {key: _substituted(value, values) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_substituted(value, values) for value in content]
    return content
