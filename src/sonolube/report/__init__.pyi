from .measurement import (
    MeasurementReport as MeasurementReport,
    PinOnDiscSheet as PinOnDiscSheet,
    measurement_caveats as measurement_caveats,
    measurement_object as measurement_object,
    measurement_page as measurement_page,
    pin_on_disc_rows as pin_on_disc_rows,
    read_pin_on_disc_sheet as read_pin_on_disc_sheet,
)
from .page import Drawing as Drawing, Page as Page, PageTable as PageTable, rendered_files as rendered_files
