"""Tasks that export a rig to other programs: `sl.export.fmu`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
