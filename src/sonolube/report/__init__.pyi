from .measurement import (
    MeasurementReport as MeasurementReport,
    measurement_caveats as measurement_caveats,
    measurement_object as measurement_object,
    measurement_page as measurement_page,
)
from .page import Drawing as Drawing, Page as Page, PageTable as PageTable, rendered_files as rendered_files
from .pin_on_disc_sheet import (
    PinOnDiscSheet as PinOnDiscSheet,
    pin_on_disc_rows as pin_on_disc_rows,
    read_pin_on_disc_sheet as read_pin_on_disc_sheet,
)
from .reproduction import (
    reproduction_files as reproduction_files,
    validation_object as validation_object,
    write_report as write_report,
)
from .reproduction_text import summary_lines as summary_lines
