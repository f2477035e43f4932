from . import (
    evidence as evidence,
    export as export,
    horn as horn,
    identify as identify,
    impedance as impedance,
    lab as lab,
    measure as measure,
)
