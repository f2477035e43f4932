"""Reference solutions of rough contact: boundary elements on a height map, and contact laws compared with them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
