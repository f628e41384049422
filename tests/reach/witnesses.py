"""All witnesses."""

from __future__ import annotations

from reach import of_axes_and_tools, of_controllers, of_mcuwin, of_setups, of_states, of_wincnc
from reach.witness import Witness

ROOMS = (of_axes_and_tools, of_controllers, of_setups, of_wincnc, of_mcuwin, of_states)
WITNESSES: list[Witness] = [witness for room in ROOMS for witness in room.w]
