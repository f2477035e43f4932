"""Evidence tasks: `sl.evidence.list`, `sl.evidence.check`, `sl.evidence.plot` and `sl.evidence.learn`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
