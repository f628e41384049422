"""`gproof boards`: what there is, what a board says of itself without being touched, the firmware as a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.test_run_on_ports import emulator
from support.command import Done, in_this_process

from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper import connection
from gproof.backend.boards.klipper.connection import NOBODY
from gproof.backend.boards.registry import BOARDS
from gproof.cli.boards import _ranges


def gproof(folder: Path, *words: str) -> Done:
    return in_this_process(["boards", *words], folder)


def test_the_list_has_every_board_and_port(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from serial.tools import list_ports, list_ports_common

    one = list_ports_common.ListPortInfo("/dev/ttyACM7")
    one.description, one.hwid = "Arduino Mega\nrm -rf", "USB VID:PID=2341:0042"
    monkeypatch.setattr(list_ports, "comports", lambda: [one])
    done = gproof(tmp_path, "list")
    assert (done.exit, done.err) == (0, "")
    lines = done.out.splitlines()
    assert [line.split()[0] for line in lines[1 : 1 + len(BOARDS)]] == list(BOARDS)
    assert len(lines) == len(BOARDS) + 3
    assert lines[-1].startswith("  /dev/ttyACM7  Arduino Mega") and "rm -rf" in lines[-1]
    told = json.loads(gproof(tmp_path, "list", "--json").out)
    assert told["schema"] == "gproof-boards/1"
    assert {one["name"]: one["kind"] for one in told["boards"] if one["kind"] != "model"} == {
        "virtual": "virtual", "emulator": "emulator", "klipper": "real",
    }  # fmt: skip
    assert all(one["about"] for one in told["boards"])
    assert told["ports"][0]["hardware"] == "USB VID:PID=2341:0042"
    monkeypatch.setattr(list_ports, "comports", list)
    assert gproof(tmp_path, "list").out.splitlines()[-1] == "ports: none found"


def test_a_board_says_what_it_is_and_is_left_as_it_was(tmp_path: Path) -> None:
    log = tmp_path / "log"
    with emulator(
        "--chip", "atmega328p", "--frequency", "8000000", "--log", str(log), "--without", "queue_step"
    ) as port:
        told = json.loads(gproof(tmp_path, "probe", port, "--json").out)
        again = gproof(tmp_path, "probe", port)
    assert told.pop("uptime_ticks") > 0
    assert told.pop("pins") == [f"P{name}{k}" for name in "BCD" for k in range(8)]
    assert told == {
        "schema": "gproof-probe/1",
        "port": port,
        "baud": 250000,
        "board": "klipper",
        "identity": "atmega328p",
        "firmware": "gproof-emulator-1",
        "clock_hz": 8_000_000,
        "extension": 1,
        "state": "not-configured",
        "section": "no identity",
        "configuration_crc": None,
        "move_pool": None,
        "receive_window": 192,
        "motors_at_most": 12,
        "problems": ["the firmware has no command queue_step"],
    }
    assert again.exit == 0
    assert "  pins        PB0 to PB7, PC0 to PC7, PD0 to PD7\n" in again.out
    assert "  problem     the firmware has no command queue_step\n" in again.out
    kept = read(log.read_bytes())
    assert len(kept.steps.tick) == 0
    assert [event.kind for event in kept.events] == ["B"], "nothing but its start"


def test_a_shutdown_is_seen_and_not_cleared(tmp_path: Path) -> None:
    (tmp_path / "faults").write_text("0.01 shutdown\n")
    with emulator("--profile", "plain", "--faults", str(tmp_path / "faults")) as port:
        for _ in range(2):
            told = json.loads(gproof(tmp_path, "probe", port, "--json").out)
            assert (told["state"], told["extension"], told["section"]) == ("shutdown", None, None)
        assert "  state       in a shutdown\n" in gproof(tmp_path, "probe", port).out


def test_where_there_is_no_board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "PROBES", 5)
    done = gproof(tmp_path, "probe", "/dev/not-there")
    assert (done.exit, done.out, done.err) == (3, "", "gproof: error: /dev/not-there: there is no such port\n")
    with emulator() as port:
        done = gproof(tmp_path, "probe", port, "--baud", "9600")
    assert (done.exit, done.out, done.err) == (3, "", f"gproof: error: {port}: {NOBODY}\n")


def test_names_in_a_row() -> None:
    names = ["PA0", "PA1", "PA3", "gpio8", "gpio9", "gpio10", "LED", "ADC", "P" + "9" * 30]
    assert _ranges(names) == ["PA0 to PA1", "PA3", "gpio8 to gpio10", "LED", "ADC", "P" + "9" * 30]
    assert _ranges([]) == []


def test_the_firmware_is_written_whole_and_over_nothing(tmp_path: Path) -> None:
    for chip, flash in (("328p", 32_768), ("2560", 262_144)):
        done = gproof(tmp_path, "firmware", "--chip", chip, "-o", f"{chip}.hex")
        assert (done.exit, done.err) == (0, "")
        lines = (tmp_path / f"{chip}.hex").read_text().split()
        assert lines[-1] == ":00000001FF"
        # Intel hex: each line's bytes add up to 0; data ends within the chip's flash.
        rows = [bytes.fromhex(line[1:]) for line in lines]
        assert all(sum(row) % 256 == 0 for row in rows)
        assert 0 < sum(row[0] for row in rows if row[3] == 0) < flash
    kept = (tmp_path / "2560.hex").read_bytes()
    done = gproof(tmp_path, "firmware", "--chip", "328p", "-o", "2560.hex")
    assert (done.exit, done.err) == (3, "gproof: error: output 2560.hex: already exists; choose another name\n")
    assert (tmp_path / "2560.hex").read_bytes() == kept
    assert gproof(tmp_path, "firmware", "--chip", "328p", "-o", "nowhere/2560.hex").exit == 3
    assert gproof(tmp_path, "firmware", "--chip", "32", "-o", "x.hex").exit == 3
    assert sorted(path.name for path in tmp_path.iterdir()) == ["2560.hex", "328p.hex"]
