"""Idioms of macro files that shops have: each is read, and makes unknown only what it touches."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command import in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 300
[axes.y]
min = 0
max = 300
[axes.z]
min = -100
max = 0
[controller]
dialect = "eding"
accepts = [%s]
"""
TOOLS = "".join(f"[tools.{n}]\nlength = {40 + n}\ndiameter = {n}\n" for n in range(1, 6))
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
start = {x = 0, y = 0, z = 0}
g92 = {x = 0, y = 0, z = 0}
tool = 1
active_work = 1
[work.1]
x = 0
y = 0
z = -90
[parameters]
"""
HEAD = "G21 G17 G90 G94 G40 G49 G50 G69 G54\n"


def check(folder: Path, text: str, *, accepts: str = "", stated: str = "", macro: str = "") -> tuple[int, str]:
    (folder / "mill.toml").write_text(MACHINE % accepts + TOOLS)
    (folder / "setup.toml").write_text(SETUP + stated)
    if macro:
        (folder / "macro.cnc").write_text(macro)
    (folder / "job.cnc").write_text(f"{HEAD}{text}")
    done = in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "setup.toml"], folder)
    return done.exit, done.out


ASK = 'dlgmsg "tool" "number" 5016\nif [#5398 == -1]\nM30\nendif\n'
GUARD = 'if [[#5016 < 1] or [#5016 > 3]]\nerrmsg "1 to 3"\nendif\n'


@pytest.mark.parametrize("guard", [True, False], ids=["guard", "stated"])
@pytest.mark.parametrize(
    ("line", "after", "wanted"),
    [
        # Every place that it may be written to holds the old number or the new one.
        ("#[5400 + #5016] = 45", "G53 G0 Z[#5401 - 45]\nG53 G0 Z[#5403 - 45]", 0),
        ("#[5400 + #5016] = 45", "G53 G0 Z[#5402 - 44]", 2),
        ("#[5400 + #5016] = 45", "G53 G0 Z[#5404 - 44]", 0),
        ("#[5500 + #5016] = 2", "G53 G0 Z[#5502 - 2]\nG53 G0 Z[#5501 - 2]", 0),
        ("#[5500 + #5016] = 9", "G53 G0 Z[#5501 - 5]", 2),
        ("#1 = 5 #2 = 6 #3 = 7 #[#5016] = 9", "G53 G0 X#1\nG53 G0 X#2\nG53 G0 X[#3]", 0),
        ("#1 = 5 #2 = 6 #3 = 7\n#[#5016] = 400", "G53 G0 X#2", 2),
        ("#1 = 5 #2 = 6 #3 = 7\n#[#5016] = 400", "G53 G0 X#[#5016 - 1 + 4 - 3]", 2),
        # Reading one of several: between what they hold.
        ("#1 = 5 #2 = 6 #3 = 7", "G53 G0 X#[#5016]", 0),
        ("#1 = 5 #2 = 600 #3 = 7", "G53 G0 X#[#5016]", 2),
        ("#4 = #[5400 + #5016]", "G53 G0 Z[#4 - 43]", 0),
        ("#4 = #[5400 + #5016]", "G53 G0 Z[#4 - 42]", 2),
    ],
)  # fmt: skip
def test_a_variable_whose_number_the_operator_types(
    guard: bool, line: str, after: str, wanted: int, tmp_path: Path
) -> None:
    stated = "" if guard else "5016 = [1, 3]\n"
    exit_code, out = check(tmp_path, f"{ASK}{GUARD if guard else ''}{line}\n{after}\nM30\n", stated=stated)
    assert exit_code == wanted, out
    assert "GP232" not in out
    assert "is a whole number" in out


def test_a_variable_whose_number_nobody_bounds_is_unknown(tmp_path: Path) -> None:
    assert check(tmp_path, f"{ASK}#[5400 + #5016] = 45\nG53 G0 X1\nM30\n")[0] == 2
    # Numbers among which one can not be written: the controller may stop there.
    assert check(tmp_path, f"{ASK}#[5000 + #5016] = 45\nG53 G0 X1\nM30\n", stated="5016 = [1, 3]\n")[0] == 2


@pytest.mark.parametrize("number", [5000, 5007, 5060, 5070, 5152, 5199, 5300, 5379, 5387])
def test_what_the_list_of_parameters_leaves_out_is_free(number: int, tmp_path: Path) -> None:
    """3.1.1: other parameters are free to use; macro files read and write them."""
    exit_code, out = check(tmp_path, f"#{number} = 7\nG53 G0 X#{number}\nif [#{number} == 7]\nM9\nendif\nM30\n")
    assert exit_code == 0, out
    assert check(tmp_path, f"#{number} = 700\nG53 G0 X#{number}\nM30\n")[0] == 1
    assert check(tmp_path, f"G53 G0 X#{number}\nM30\n")[0] == 2


@pytest.mark.parametrize("number", [5400, 5500, 5600, 5700, 5800, 5999])
def test_numbers_beside_the_tool_table_are_unknown(number: int, tmp_path: Path) -> None:
    for text in (f"#1 = #{number}\n", f"#{number} = 3\n", f"if [#{number} > 2]\nG53 G0 X1\nendif\n"):
        exit_code, out = check(tmp_path, f"{text}G53 G0 X1\nM30\n")
        assert exit_code == 2 and "GP113" in out, out
        if number < 5800:
            assert check(tmp_path, f"{text}G53 G0 X1\nM30\n", accepts='"tool-zero"')[0] == 0
    # What such a number holds is not known, whoever wrote it.
    assert check(tmp_path, f"#{number} = 3\nG53 G0 X#{number}\nM30\n")[0] == 2


CHANGE = """sub change_tool
 M5
 G53 G0 Z0
 dlgmsg "insert the tool" "in the spindle:" 5008 "new:" 5011
 if [#5398 == 1]
  M6 T[#5011]
  G43
 else
  errmsg "no tool"
 endif
endsub
"""


def test_a_dialog_that_shows_the_tools(tmp_path: Path) -> None:
    job = "M6 T2\nG0 X10 Y10\nG0 Z{}\nM30\n"
    exit_code, out = check(tmp_path, job.format(5), macro=CHANGE)
    assert exit_code == 2 and "shown-tools" in out, out
    exit_code, out = check(tmp_path, job.format(5), macro=CHANGE, accepts='"shown-tools"')
    assert exit_code == 0, out
    # The length of tool 2, 42 mm, is in force: Z49 is 1 mm past the limit, Z48 is at it.
    assert check(tmp_path, job.format(48), macro=CHANGE, accepts='"shown-tools"')[0] == 0
    assert check(tmp_path, job.format(49), macro=CHANGE, accepts='"shown-tools"')[0] == 1


@pytest.mark.parametrize(("tool", "exit_code"), [("3", 0), ("[#5011 + 2]", 0), ("5", 1), ("[#5011 + 4]", 1)])
def test_a_tool_that_a_program_writes(tool: str, exit_code: int, tmp_path: Path) -> None:
    """Tools are 40 mm and their number long; Z47 leaves 3 mm up to the limit."""
    text = f"T1\n#5011 = {tool}\nM6\nG43\nG0 Z47\nM30\n"
    assert check(tmp_path, text)[0] == 2
    done, out = check(tmp_path, text, accepts='"written-tools"')
    assert done == exit_code, out
    spindle = f"#5008 = {tool.replace('5011', '5008')}\nG43\nG0 Z47\nM30\n"
    done, out = check(tmp_path, spindle, accepts='"written-tools"')
    assert done == exit_code, out


RETRY = """sub touch
 G90 G53 G0 Z-10
 G53 G38.2 Z{} F100
 if [#5067 == 1]
  G53 G0 Z-5
 else
  dlgmsg "nothing found, again?"
  if [#5398 == 1]
   gosub touch
  else
   errmsg "not measured"
  endif
 endif
endsub
"""


def test_a_macro_that_calls_itself_when_asked_to_is_not_refuted(tmp_path: Path) -> None:
    """No section says how deep calls may be. One that always calls itself never comes back."""
    job = "gosub touch\nM30\n"
    exit_code, out = check(tmp_path, job, macro=RETRY.format(-50))
    assert exit_code == 2 and "unknown GP117" in out, out
    assert check(tmp_path, job, macro=RETRY.format(-101))[0] == 1
    exit_code, out = check(tmp_path, job, macro="sub touch\ngosub touch\nendsub\n")
    assert exit_code == 1 and "error GP117" in out, out


TITLES = " ".join(f'"value {n}" {n}' for n in range(1, 16))
NEWER = (
    ("long-dialogs", f'dlgmsg "many" {TITLES}', 15),
    ("tool-info", "GetToolInfo num 15", 15),
    ("tool-info", "gettoolinfo FIRST 15 ; the lowest", 15),
    ("tool-info", "GetToolInfo next 15", 15),
    ("modbus", "modbus s1 f3 a2 n1 u15", 15),
    ("modbus", "Modbus S1 F2 A23 N4 U12", 15),
    ("modbus", "modbus s1 f16 a2 n1 u5011", 0),
    ("modbus", "modbus s1 f5 a23 v1", 0),
    ("pc-programs", 'Exec ".\\ask.exe" "-b=yes,no -d=\\"go?\\"" 60000', 5399),
    ("height-commands", "ZHC off", 0),
    ("height-commands", "ZHCINITEX [#15 + 3] 5 4 3", 0),
    ("height-commands", "ZHCcheck 20", 0),
)  # fmt: skip


@pytest.mark.parametrize(("entry", "line", "number"), NEWER, ids=[line for _, line, _ in NEWER])
def test_a_command_of_a_newer_version(entry: str, line: str, number: int, tmp_path: Path) -> None:
    """UNKNOWN by the manual; where the shop says that its controller has it, only what it writes is not known."""
    moved = f"G53 G0 X250\n#27 = 20 #15 = 20 #5399 = 20\n{line}\nG91 G0 X10\nG90 G53 G0 X#27\n"
    written = f"G53 G0 Y#{number}\n" if number else ""
    assert check(tmp_path, f"{moved}M30\n")[0] == 2
    exit_code, out = check(tmp_path, f"{moved}M30\n", accepts=f'"{entry}"')
    assert exit_code == 0, out
    assert entry in out
    assert check(tmp_path, f"{moved}{written}M30\n", accepts=f'"{entry}"')[0] == (2 if number else 0)
    # The place is still known.
    assert check(tmp_path, f"{moved}G91 G0 X300\nM30\n", accepts=f'"{entry}"')[0] == 1


@pytest.mark.parametrize("line", ["modbus s1 f99 a1 n1 u1", "GetToolInfo length 15", "modbus s1 f3 a2 n900 u1"])
def test_another_form_of_it_stays_unknown(line: str, tmp_path: Path) -> None:
    assert check(tmp_path, f"{line}\nG53 G0 X1\nM30\n", accepts='"modbus", "tool-info"')[0] == 2


NOTHING = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 20, y = 20, z = -20}\n[parameters]\n'
"""Neither the work zero nor the tool's length is stated."""
PLACES = (
    # Back to what was shown, whatever the zeros are.
    ("G53 G38.2 Z-50 F100\nG0 Z#5063\n", 0),
    ("G53 G38.2 Z-50 F100\nG0 Z[#5063 + 20]\n", 0),
    ("G53 G38.2 Z-50 F100\nG0 Z[5 + #5063]\n", 0),
    ("G53 G38.2 Z-50 F100\nG0 Z[#5063 + 21]\n", 2),
    ("G53 G38.2 Z-50 F100\nG0 Z[#5063 - 50]\n", 0),
    ("G53 G38.2 Z-50 F100\nG0 Z[#5063 - 51]\n", 2),
    ("#1 = #5001 #2 = #5003\nG53 G0 Z0\nG53 G0 X90\nG0 X#1\nG0 Z#2\n", 0),
    ("#1 = #5003\nG0 Z[#1 + 20]\n", 0),
    ("#1 = #5003\nG0 Z[#1 + 21]\n", 1),
    ("#1 = #5003\nG0 Z[#1 - 81]\n", 1),
    ("#1 = #5001\nG20\nG0 X#1\n", 2),
    ("#1 = #5001\nG0 Y#1\n", 2),
    ("#1 = #5003\nG91 G0 Z#1\n", 2),
    ("#1 = #5003\nG53 G0 Z#1\n", 2),
    ("#1 = #5003\nG55\nG0 Z#1\n", 2),
    ("#1 = #5003\nG92 Z5\nG0 Z#1\n", 2),
    ("#1 = #5003\nG10 L20 P1 Z5\nG0 Z#1\n", 2),
    ("#1 = #5003\nG43 H2\nG0 Z#1\n", 2),
    ("#1 = #5003\nG0 Z[#1 * 1.5]\n", 2),
    ("#1 = #5003\nG0 Z[20 - #1]\n", 2),
    ("G53 G38.2 Z-50 F100\n#1 = #5073\nG53 G0 Z0\nG53 G0 Z#1\n", 0),
    ("G53 G38.2 Z-50 F100\nG53 G0 Z[#5053 + 20]\n", 0),
    ("G53 G38.2 Z-50 F100\nG53 G0 Z[#5053 + 21]\n", 2),
    ("G53 G38.2 Z-50 F100\nG0 Z#5053\n", 0),  # on a condition: it is a number of the machine
)


@pytest.mark.parametrize(("text", "wanted"), PLACES, ids=[text for text, _ in PLACES])
def test_back_to_a_place_that_was_shown(text: str, wanted: int, tmp_path: Path) -> None:
    """The number depends on zeros that nobody stated, the place does not: #5063 is where the probe has touched."""
    (tmp_path / "mill.toml").write_text(MACHINE % "" + TOOLS)
    (tmp_path / "setup.toml").write_text(NOTHING)
    (tmp_path / "job.cnc").write_text(f"G21 G17 G90 G94 G40 G50 G69\n{text}M30\n")
    done = in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "setup.toml"], tmp_path)
    assert done.exit == wanted, done.out
