from .mock_up_unit import (
    MockUpUnit as MockUpUnit,
    c_compiler as c_compiler,
    controller_unit as controller_unit,
    plant_unit as plant_unit,
)
from .plant import (
    PinHeat as PinHeat,
    PlantRanges as PlantRanges,
    PlantTables as PlantTables,
    plant_ranges as plant_ranges,
)
from .tabulation import plant_tables as plant_tables
