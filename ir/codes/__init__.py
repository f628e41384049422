"""Every finding code, one file a hundred. Numbers and names are stable and never reused.

1xx language, 2xx meaning, 3xx limits and areas, 4xx geometry, 5xx motion and time, 6xx machine files and
setup, 7xx translation, 8xx boards and certificates. ``docs/codes/GPnnn.md`` explains each with programs
that a test runs. The last column is the property that an error or unknown of this code decides.
"""

from __future__ import annotations

from gproof.ir.codes.c100_language import *  # noqa: F403
from gproof.ir.codes.c200_meaning import *  # noqa: F403
from gproof.ir.codes.c300_limits import *  # noqa: F403
from gproof.ir.codes.c400_geometry import *  # noqa: F403
from gproof.ir.codes.c500_motion import *  # noqa: F403
from gproof.ir.codes.c600_files import *  # noqa: F403
from gproof.ir.codes.c700_printing import *  # noqa: F403
from gproof.ir.codes.c800_boards import *  # noqa: F403
from gproof.ir.codes.declared import CODES as CODES
from gproof.ir.codes.declared import RETIRED as RETIRED
from gproof.ir.codes.declared import SENTENCES as SENTENCES
from gproof.ir.codes.declared import code as code
from gproof.ir.codes.declared import saying as saying
