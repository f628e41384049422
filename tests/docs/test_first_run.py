"""The commands of docs/first-run.md, in their order, on an emulator behind the port that the page names."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from support.console import Shell, matches, steps
from support.goldens import ROOT

PAGE = ROOT / "docs" / "first-run.md"
PORT = "/dev/ttyACM0"
PINS = {"PF0", "PF1", "PD7"}


def shown(text: str) -> list[tuple[str, list[str]]]:
    """Commands of the ```sh blocks, and the files to save; what differs from board to board is left out."""
    return [(step.command, step.expected) for step in steps(text.replace("```sh\n", "```console\n"))]


def fits(expected: list[str], actual: list[str]) -> bool:
    """As ``matches``; a line that ends in `...` is the beginning of one."""
    begun = [line[:-3] for line in expected if line.endswith("...") and line != "..."]
    cut = [next((start + "..." for start in begun if line.startswith(start)), line) for line in actual]
    return matches(expected, cut)


def test_the_commands_do_what_the_page_says(tmp_path: Path) -> None:
    shell = Shell(tmp_path, here=True)
    board: subprocess.Popen[str] | None = None
    port = ""
    try:
        for command, expected in shown(PAGE.read_text(encoding="utf-8")):
            # A board that is configured keeps its pins: a change of wiring is a new power-up.
            if board is None or command.startswith("sed "):
                if board is not None:
                    board.terminate()
                    board.communicate()
                words = [sys.executable, "-m", "gproof.backend.boards.emulator", "--stay"]
                board = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
                assert board.stdout is not None
                before, port = port, board.stdout.readline().removeprefix("port: ").strip()
                if before:
                    # The port is no part of what a package is made for.
                    machine = tmp_path / "bench.toml"
                    machine.write_text(machine.read_text().replace(f'"{before}"', f'"{port}"'))
            printed = [line.replace(port, PORT) for line in shell.run(command.replace(PORT, port))]
            assert fits(expected, printed), (command, printed, expected)
    finally:
        if board is not None:
            board.terminate()
            board.communicate()


def test_the_pins_of_the_page_are_those_of_the_chip() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert all(pin in text for pin in PINS)
    assert "first-run.md" in (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
