"""Contact of rough and smooth bodies: separation, real area, stiffness, and periodic motions of the gap."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
