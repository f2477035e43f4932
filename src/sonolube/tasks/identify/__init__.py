"""Identification tasks: `sl.identify.rig` and `sl.identify.decay_length`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
