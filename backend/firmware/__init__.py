"""The reference firmware for AVR boards: its C sources, how it is built, and the built images that are shipped.

``docs/boards.md`` says what it adds to Klipper's protocol. The images are of the certified profile.
"""

from __future__ import annotations

from importlib import resources

CHIPS = ("328p", "2560")
"""ATmega328P (Arduino Uno, Nano) and ATmega2560 (Arduino Mega, RAMPS), both with a 16 MHz crystal."""


def image(chip: str) -> bytes:
    """The shipped image of a chip of ``CHIPS`` as an Intel hex file, for any AVR programmer."""
    if chip not in CHIPS:
        raise ValueError(f"no firmware for {chip!r}; there is {' and '.join(CHIPS)}")
    return resources.files(__name__).joinpath(f"{chip}.hex").read_bytes()
