"""McuWIN: the errors, warnings and states that the manual names, and which finding stands for each.

Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133, 6, 13.1.1 and 14. A message without a finding is one that only the
running controller can give; ``why`` says what it depends on.
"""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Code
from gproof.ir.record import record


@record(frozen=True, slots=True)
class ControllerMessage:
    """What the controller can say.

    number: as the manual writes it; section: of the manual; codes: findings that say the same before the job runs; why:
    there is none.
    """

    kind: str
    number: str
    text: str
    section: str
    codes: tuple[Code, ...] = ()
    why: str = ""

    @property
    def name(self) -> str:
        """``Error 2074``."""
        return f"{self.kind} {self.number}"


_M = ControllerMessage
_HARDWARE = "what drives, encoders and switches do while the job runs"
_OPERATOR = "what the operator and the machine's inputs do"
_PROGRESS = "reports the progress of the job"
_INSTALLED = "how the controller's programs and its board are set up"
_TASK = "what the application code of a task does"

MESSAGES = (
    _M("Error", "1", "Unknown function code", "13.1.1.1", (codes.UNKNOWN_CODE,)),
    _M("Warning", "1", "Encode error", "13.1.1.2", why=_HARDWARE),
    _M("Error", "2", "Lag error", "13.1.1.3", why=_HARDWARE),
    _M("Status", "2", "Wait until door is closed", "13.1.1.4", why=_OPERATOR),
    _M("Error", "4", "Hardware limit switch", "13.1.1.5", (codes.SOFT_LIMIT,)),
    _M("Status", "4", "Program was started", "13.1.1.6", why=_PROGRESS),
    _M("Error", "8", "Software limit switch", "13.1.1.7", (codes.SOFT_LIMIT,)),
    _M("Status", "8", "Program was ended", "13.1.1.8", why=_PROGRESS),
    _M("Status", "10", "Emergency stop", "13.1.1.9", why=_OPERATOR),
    _M("Warning", "10", "Position error detected", "13.1.1.10", why=_HARDWARE),
    _M("Error", "20", "Conflict in configuration data", "13.1.1.11", (codes.BAD_VALUE,)),
    _M("Status", "20", "Referencing was started", "13.1.1.12", why=_PROGRESS),
    _M("Error", "21", "Loading a program", "13.1.1.13", (codes.PROGRAM_TOO_LARGE, codes.PROGRAM_SIZE)),
    _M("Error", "40", "Error with reference run", "13.1.1.14", why=_HARDWARE),
    _M("Status", "40", "Wait until spindle speed is reached", "13.1.1.15", why=_PROGRESS),
    _M("Error", "80", "Version conflict McuWIN - SAP", "13.1.1.16", why=_INSTALLED),
    _M("Status", "80", "Error bit detected in ErrorReg", "13.1.1.17", (codes.NO_WAY,)),
    _M("Error", "100", "Configuration error", "13.1.1.18", why=_INSTALLED),
    _M("Status", "100", "Error bit detected in IFS register", "13.1.1.19", why=_HARDWARE),
    _M("Error", "200", "Error in tool radius correction", "13.1.1.20", (codes.NOT_ENABLED,)),
    _M("Status", "400", "Feed block active", "13.1.1.21", why=_OPERATOR),
    _M("Error", "800", "Amplifier not ready", "13.1.1.22", why=_HARDWARE),
    _M("Status", "1000", "Runtime error in SAP task", "13.1.1.23", why=_TASK),
    _M("Status", "2000", "Parameter error at runtime", "13.1.1.24", (codes.ARC_RADIUS_MISMATCH, codes.ILLEGAL_VALUE)),
    _M("Error", "4000", "Invalid S-value", "13.1.1.25", (codes.SPINDLE_RANGE,)),
    _M("Error", "80000000", "System was stopped", "13.1.1.26", why=_INSTALLED),
    _M("Error", "190", "No M02, M30 or M17", "14 (2.5.3.90)", (codes.NO_MODULE_END,)),
    _M("Error", "2074", "Text in place of a parameter", "6", (codes.BRACKET_PARAMETER,)),
    _M("Error", "2075", "G04 without a parameter", "14 (2.5.3.100)", (codes.WORD_MISSING,)),
)
