"""Virtual tribometer: devices whose friction is that of a rig's prediction, with the disturbances of a real test."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
