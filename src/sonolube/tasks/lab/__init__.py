"""Tasks of the laboratory: protocols run on a rig or a virtual one, and their records: `sl.lab.run` and its kind."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
