"""Materials: engineering materials and piezoelectric ceramics, each property with the source it was read from."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
