"""Tasks of the laboratory: protocols run on a rig or a virtual one, and their records: `sl.lab.run` and its kind."""

from typing import Any

import lazy_loader

from sonolube.former_names import moved_module

_loaded, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    try:
        return _loaded(name)
    except AttributeError:
        raise AttributeError(f"sonolube.lab has no attribute {name!r}{moved_module('lab')}") from None
