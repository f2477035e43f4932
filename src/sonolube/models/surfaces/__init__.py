"""Surface metrology: height maps, filters, ISO 25178 and 21920 parameters, spectra, asperities and wear grooves."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
