"""Laboratory: tests run by protocol on the devices of a rig or on a virtual tribometer, recorded and catalogued."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
