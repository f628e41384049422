"""Builds the reference firmware with avr-gcc; ``python -m gproof.backend.firmware.build`` writes the shipped images.

From a checkout. Debian: ``gcc-avr`` and ``avr-libc``. The same compiler gives the same bytes.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

from gproof.backend.firmware import CHIPS, dictionary

SOURCES = Path(__file__).resolve().parent
FLAGS = (
    "-std=c11", "-O2", "-flto", "-frandom-seed=gproof", "-fno-strict-aliasing", "-Wall", "-Wextra", "-Werror",
    "-Wstrict-prototypes", "-Wmissing-declarations",
)  # fmt: skip


def build(chip: str, folder: Path, *, certified: bool = True) -> Path:
    """Build for one chip of ``CHIPS`` into a folder; the path of the ELF file, with the hex file beside it.

    certified: with what a certified run needs; without, the firmware speaks Klipper's protocol and no more.
    CalledProcessError or FileNotFoundError when the compiler fails or is missing.
    """
    profile = "certified" if certified else "plain"
    dictionary.main(str(SOURCES / "messages.txt"), chip, profile, str(folder))
    sources = [path.name for path in sorted(SOURCES.glob("*.c")) if certified or path.name != "proof.c"]
    elf, image = folder / f"{chip}.elf", folder / f"{chip}.hex"
    define = ("-DCERTIFIED",) if certified else ()
    compiler = ("avr-gcc", f"-mmcu={dictionary.MCU[chip]}", *FLAGS, *define, "-I.", f"-I{folder}")
    run(*compiler, *sources, str(folder / "messages.c"), "-o", str(elf))
    run("avr-objcopy", "-O", "ihex", "-R", ".eeprom", str(elf), str(image))
    return elf


def run(*command: str) -> str:
    """Run a tool of the compiler in the folder of the sources; what it prints."""
    done = subprocess.run(command, cwd=SOURCES, check=True, capture_output=True, encoding="utf-8")
    return done.stdout


def sizes(elf: Path) -> tuple[int, int]:
    """Bytes of flash, and of RAM without the stack."""
    text, data, bss = (int(word) for word in run("avr-size", str(elf)).splitlines()[1].split()[:3])
    return text + data, data + bss


def main() -> None:
    """Write the shipped images."""
    for chip in CHIPS:
        with tempfile.TemporaryDirectory() as folder:
            built = build(chip, Path(folder)).with_suffix(".hex")
            (SOURCES / built.name).write_bytes(built.read_bytes())


if __name__ == "__main__":
    main()
