from .acquisition_and_operator import Acquire as Acquire, Check as Check, Prompt as Prompt
from .edits import (
    ProtocolField as ProtocolField,
    ProtocolStep as ProtocolStep,
    edited_protocol_text as edited_protocol_text,
    protocol_fields as protocol_fields,
    protocol_steps as protocol_steps,
)
from .output_steps import (
    Drive as Drive,
    MotorSpeed as MotorSpeed,
    Sweep as Sweep,
    VoltageSteps as VoltageSteps,
    Wait as Wait,
)
from .quantity_text import exact_text as exact_text
from .record import (
    STEP_KINDS as STEP_KINDS,
    Limits as Limits,
    Metadata as Metadata,
    Protocol as Protocol,
    Repeat as Repeat,
)
from .text import (
    protocol_by_name_or_file as protocol_by_name_or_file,
    protocol_faults as protocol_faults,
    protocol_from as protocol_from,
    protocol_names as protocol_names,
    protocol_path as protocol_path,
    protocol_schema as protocol_schema,
    protocol_text as protocol_text,
    read_protocol as read_protocol,
)
from .time_line import (
    PROMPT_DURATIONS as PROMPT_DURATIONS,
    SetPoint as SetPoint,
    duration as duration,
    flattened as flattened,
    protocol_at as protocol_at,
    step_at as step_at,
)
