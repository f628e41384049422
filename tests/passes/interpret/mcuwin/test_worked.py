"""Short McuWIN programs with the place where each ends, worked out on paper from the manual before they were run.

X starts at 10, Y at 20, Z at -20 in machine coordinates; limits are 200 to either side, Z -150 ... 0; the zero offset
is 0. A vise is X 100 ... 190, Y -190 ... -100. Variables and inputs that a program does not set are not stated.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.interpret.core.worked_programs import agree

MACHINE = """\
schema = "gproof-machine/1"
units = "mm"
[axes.x]
kind = "linear"
min = -200.0
max = 200.0
max_velocity = 150.0
max_acceleration = 800.0
[axes.y]
kind = "linear"
min = -200.0
max = 200.0
max_velocity = 150.0
max_acceleration = 800.0
[axes.z]
kind = "linear"
min = -150.0
max = 0.0
max_velocity = 60.0
max_acceleration = 500.0
[[keep_out]]
name = "vise"
x = [100.0, 190.0]
y = [-190.0, -100.0]
[controller]
dialect = "mcuwin"
[din]
version = "2.5.3.133"
case_sensitive = true
line_numbers = false
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
angle_unit = "radians"
wait_unit = "ms"
tool_file = ""
persistence = "strict"
zero_offsets = [
    [100.0, 50.0, -20.0],
    [-60.0, -40.0, 0.0],
    [0.0, 0.0, 5.0],
    [12.5, -7.25, -1.0],
    [200.0, 120.0, -60.0],
]
[din.task0]
M0 = "stop"
M2 = "end"
M3 = "spindle_cw"
M4 = "spindle_ccw"
M5 = "spindle_off"
M6 = "tool_change"
M8 = "coolant_on"
M9 = "coolant_off"
M30 = "end"
S = "spindle_speed"
T = "tool_select"
G74 = "home"
"""
SETUP = """\
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z"]
start = {x = 10.0, y = 20.0, z = -20.0}
tool = 0
[g92]
x = 0.0
y = 0.0
z = 0.0
"""
START = {"x": 10.0, "y": 20.0, "z": -20.0}
TOOLS = "[ToolsXY]\nR0=0.0\nL0=0.0\nR1=3,0\nL1=10,0\nR2=5.0\nL2=2.0\n[ToolsZX]\nR1=3.0\nL1=10.0\n"

ENDS = {
    "G00 X5": "SAFE 5 . .",
    "G54\nG00 X5 Y6": "SAFE 105 56 .",
    "G92 X30\nG00 X5": "SAFE 35 . .",
    "G54\nG92 X30\nG00 X5 Y0": "SAFE 35 50 .",
    "G54\nG91\nG92 X30\nG90\nG00 X5": "SAFE 135 . .",
    "G92 X30\nG54\nG00 X5": "SAFE 105 . .",
    "G92 X30\nG53\nG00 X5": "SAFE 5 . .",
    "G91\nG53\nG00 X5": "UNKNOWN",
    "G91\nG00 X5\nX5": "SAFE 20 . .",
    "G91\nG54\nG00 X5": "SAFE 15 . .",
    "G92 X30": "SAFE . . .",
    "G92 X30\nX5\nG00 X1": "SAFE 6 . .",
    "G22\nG00 X5": "SAFE -5 . .",
    "G21\nG00 Y5": "SAFE . -5 .",
    "G23\nG00 X5 Y6\nG24\nG00 X5": "SAFE 5 -6 .",
    "G21\nG22\nG00 X5 Y6": "SAFE -5 -6 .",
    "G22\nG91\nG00 X5": "SAFE 5 . .",
    "G39 X2\nG22\nG00 X5": "SAFE 10 . .",
    "G39 X2\nG00 X5": "SAFE 5 . .",
    "G39 X2 Y3\nG23\nG00 X5 Y6\nG39\nG00 X5 Y6": "SAFE -5 -6 .",
    "G39 X2 Y3\nG23\nG00 X5 Y6": "SAFE 10 18 .",
    "G39 X2 Y3\nG21\nG00 X5 Y6": "SAFE 5 18 .",
    "G39 X50\nG22\nG00 X5": "UNSAFE",
    "G39 X2\nG24\nG22\nG00 X5": "UNKNOWN",
    "G22\nG54\nG00 X5": "SAFE ? . .",
    "G22\nG54\nG00 X120": "UNKNOWN",
    "G22\nG92 X30\nG00 X5": "UNKNOWN",
    "G00 X0 Y0\nG22\nG02 X20 Y0 I10 J0 F100": "SAFE -20 0 .",
    "G00 X0 Y195\nG22\nG02 X20 Y195 I10 J0 F100": "UNSAFE",
    "G00 X0 Y195\nG02 X20 Y195 I10 J0 F100": "UNSAFE",
    "G00 X0 Y195\nG03 X20 Y195 I10 J0 F100": "SAFE 20 195 .",
    "G70\nG01 X1 F100": "SAFE 25.4 . .",
    "G70\nG00 X1": "SAFE 1 . .",
    "G70\nG92 X1\nG00 X0": "UNKNOWN",
    "G70\nG01 X1 F10\nG71\nG01 X1": "!",
    "G70\nG91\nG01 X1 F10": "SAFE 35.4 . .",
    "G70\nG01 X10 F10": "UNSAFE",
    "G70\nG54\nG01 X1 F10": "SAFE 125.4 . .",
    "G98 X-5\nG00 X-7": "UNSAFE",
    "G99 X15\nG00 X17": "UNSAFE",
    "G99 X300\nG00 X250": "UNKNOWN",
    "G70\nG99 X5\nG00 X50": "UNKNOWN",
    "G54\nG99 X150\nG00 X60": "!",
    "G54\nG153\nG53\nG154\nG00 X5": "SAFE 105 . .",
    "G54\nG153\n$CD50 := 7;\nG154\nG00 X5": "SAFE 12 . .",
    "G54\nG153\nG53\nG154 X\nG00 X5 Y5": "UNKNOWN",
    "G54\nG153\nG53\nG154 X Y\nG00 X5 Y5": "UNKNOWN",
    "G54\nG153\nG53\nG154 X\nG53\nG00 X5 Y5": "UNKNOWN",
    "G54\nG153 X\nG00 X5": "UNSAFE",
    "G154 G00 X": "UNSAFE",
    "G161\nG02 X20 Y20 I15 J20 F100": "SAFE 20 . .",
    "G162\nG02 X20 Y20 I5 J0 F100": "SAFE 20 . .",
    "G161\nG91\nG02 X10 Y0 I5 J0 F100": "SAFE 20 . .",
    "G161\nG54\nG02 X-80 Y-30 I-85 J-30 F100": "SAFE 20 . .",
    "G161\nG162\nG02 X20 Y20 I5 J0 F100": "SAFE 20 . .",
    "G161\nG70\nG02 X(20/25.4) Y(20/25.4) I(15/25.4) J(20/25.4) F100": "SAFE 20 . .",
    "G02 X10 Y20 I5 J0 F100": "SAFE . . .",
    "G02 X10 Y20 I-106 J0 F100": "UNSAFE",
    "G02 X20 Y20 I6 J0 F100": "UNSAFE",
    "G02 X20 Y20 Z-30 I5 J0 F100": "SAFE 20 . -30",
    "G02 X20 Y20 Z10 I5 J0 F100": "UNSAFE",
    "G91\n$for CI600:=1 to 3 do begin\nG00 X5\n$end;": "SAFE 25 . .",
    "$for CI600:=3 downto 1 do begin\nG00 X(CI600*10)\n$end;": "SAFE 10 . .",
    "$if (CI600 > 5) then begin\nG54\n$end\nG00 X110": "UNSAFE",
    "$if (CI600 > 5) then begin\nG91\n$end\nG00 X195": "UNSAFE",
    "$if (CI600 > 5) then begin\nG70\n$end\nG01 X150 F100": "UNSAFE",
    "$if (CI600 > 5) then begin\nG92 X5\n$end else begin\nG92 X-5\n$end\nG00 X190": "SAFE",
    "$if (CI600 > 5) then begin\nG22\n$end\nG00 Y-150 X-150": "UNSAFE",
    "$if (CI600 > 5) then begin\nG161\n$end\nG02 X20 Y20 I5 J0 F100": "UNSAFE",
    "G91\nM98 L114 O3\nM30\n%114\nG00 X5\nM17\n%": "SAFE 25 . .",
    "M98 L114\nG00 X5\nM30\n%114\nG91\nM17\n%": "SAFE 15 . .",
    "M98 L114\nG00 X5\nM30\n%114\nG54\nM17\n%": "SAFE 105 . .",
    "G91\nM98 L114 O41\nM30\n%114\nG00 X5\nM17\n%": "UNSAFE",
    "CI600 := 1\nM98 L114\nG00 Y5\nM30\n%114\n$if (CI600 = 1) then begin\nM17\n$end\nG00 X300\nM17\n%": "SAFE . 5 .",
    "M96 L5\nG00 X300\nL5\nG00 X7": "SAFE 7 . .",
    "G00 X(X.rp + 5)": "UNKNOWN",
    "G00 X(X.tp + 5)": "SAFE 15 . .",
    "G54\nG00 X(X.tp + 5)": "UNKNOWN",
    "CD601 := 5\nG00 X(CD601*2)": "SAFE 10 . .",
    "CI601 := 5\nM901 601\nCI601 := 9\nM902 601\nG00 X(CI601)": "SAFE 5 . .",
    "CI601 := 5\nM902 601\nG00 X(CI601)": "UNKNOWN",
    "CD601 := 5\nM901 601\nCI601 := 9\nM904 601\nG00 X(CD601)": "UNKNOWN",
    "G00 X5\nG04 1\nX6": "UNSAFE",
    "G00 X5\nM3\nX6": "SAFE 6 . .",
    "G00 X5\nM96 L9\nG01 Y300 F100\nL9\nX6": "SAFE 6 . .",
    "G93\nG01 X5 F2": "UNSAFE",
    "G151\nG01 X50 F100\nX60\nG150": "UNKNOWN",
    "G59\nG00 X5": "UNSAFE",
    "G28\nG00 X5": "UNSAFE",
    "G00 X5\nM30\nG00 X300": "SAFE 5 . .",
    "G91\nG92 X10\nG92 X10\nG90\nG00 X0": "SAFE 20 . .",
    "$for CI600:=1 to 2 do begin\nG91\nG92 X10\nG90\n$end;\nG00 X0": "SAFE 20 . .",
    "$for CI600:=1 to 30 do begin\nG91\nG92 X10\nG90\n$end;\nG00 X0": "UNSAFE",
    "$repeat begin\nG91\nG00 X10\nCI600 := 7\n$end until (CI600 = 7);": "SAFE 20 . .",
    "CI600 := 0\n$while (CI600 < 3) do begin\nG54\nG91\nG92 X1\nG90\nCI600 := CI600 + 1\n$end;\nG00 X1": "SAFE 102 . .",
    "G53\nG00 X150 Y-150": "UNSAFE",
    "G55\nG00 X190 Y-90": "UNSAFE",
    "G55\nG53\nG00 X190 Y-90": "SAFE 190 -90 .",
    "G22\nG00 X-150 Y-150": "UNSAFE",
    "G92 Z-10\nG00 Z-141": "UNSAFE",
    "G58\nG00 X1": "UNSAFE",
    "G56\nG00 Z-3": "UNSAFE",
    "G57\nG00 X0 Y0 Z0": "SAFE 12.5 -7.25 -1",
    "G00 X0 Y0 Z0\nG57\nG91\nG00 X1": "SAFE 1 0 0",
    "G54\nG91\nG53\nG90\nG00 X5 Y6": "SAFE 5 6 .",
    "G99 X15\nG02 X10 Y20 I3 J0 F100": "UNSAFE",
    "$if (X.digib.5) then begin\nG99 X15\n$end\nG00 X17": "!",
    "G01 X5 F100\nG92 X30\nY1\nG00 X0 Y0": "SAFE 30 1 .",
    "G41\nG01 X20 F100\nG01 X30 Y30\nG40": "!",
    "G92 X30\nM30\n": "SAFE . . .",
    "G74\nG00 X5": "UNKNOWN",
    "$x.zerooffset := 5;\nG00 X1": "UNKNOWN",
    "$X.zerooffset := 5;\nG00 X1": "UNKNOWN",
    "G00 X(Y.tp)": "SAFE 20 . .",
    "G00 X(-5)": "SAFE -5 . .",
    "G00 X(2+3*4) Y(10-4-3)": "SAFE 14 3 .",
    "G00 X(7 div 2) Y(7 mod 4)": "SAFE 3 3 .",
    "G55\nG99 X50\nG00 X55": "UNKNOWN",
    "G54\nG98 X50\nG00 X-40": "UNSAFE",
    "G54\nG00 X0\nG98 X50\nG00 X-40": "UNKNOWN",
    "G54\nG99 X50\nG53\nG00 X51": "UNKNOWN",
    "G55\nG53\nG99 X50\nG00 X45": "SAFE 45 . .",
    "G55\nG98 X-150\nG00 X5": "SAFE -55 . .",
    "G54\nG99 X150\nG00 X40": "SAFE 140 . .",
    "G55\nG99 X50\nG00 X115": "UNSAFE",
    "G91\nG92 X-20\nG90\nG99 X50\nG00 X5": "SAFE -15 . .",
    "$if (X.digib.5) then begin\nG55\n$end\nG99 X50\nG00 X5": "UNKNOWN",
    "$if (X.digib.5) then begin\nG92 X10\n$end\nG00 X195": "!",
    "$if (X.digib.5) then begin\nM98 L114\n$end\nG00 X195\nM30\n%114\nG54\nM17\n%": "!",
    "$if (X.digib.5) then begin\nG39 X2\n$end\nG22\nG00 X150": "!",
    "$if (X.digib.5) then begin\nG51 X40\n$end\nG01 X150 F100": "!",
    "$while (X.digib.5) do begin\nG91\nG00 X5\n$end;": "!",
    "$repeat begin\nG91\nG00 X5\n$end until (X.digib.5);": "!",
    "$for CI600:=1 to CI601 do begin\nG91\nG00 X5\n$end;": "!",
    "M98 L114 O(CI600)\nM30\n%114\nG91\nG00 X5\nM17\n%": "!",
    "CI600 := 3\nM98 L114 O(CI600)\nM30\n%114\nG91\nG00 X5\nM17\n%": "SAFE 25 . .",
    "CI600 := 50\nM98 L114 OCI600\nM30\n%114\nG91\nG00 X5\nM17\n%": "UNSAFE",
    "M98 L114 O2\nM30\n%114\nM98 L115 O3\nM17\n%\n%115\nG91\nG00 X5\nM17\n%": "SAFE 40 . .",
    "M98 L114\nM30\n%114\nG00 X5\nM96 L9\nG00 X300\nL9\nM17\n%": "SAFE 5 . .",
    "G00 X5\nM98 L114\nX6\nM30\n%114\nG01 Y1 F100\nM17\n%": "SAFE 6 1 .",
    "$if (1 = 1) then begin\nG00 X5\n$end else begin\nG00 X300\n$end": "SAFE 5 . .",
    "CD601 := CD602\nG00 X(CD601)": "!",
    "M902 601\nG00 X(CI601)": "!",
    "M904 601\nG00 X(CD601)": "!",
    "CD601 := 150.0\nM903 601\nCD601 := 0\nM904 601\nM904 602\nG00 X(CD601 + 60)": "UNSAFE",
    "G54\nG153\nG55\nG154\nG00 X5": "SAFE 105 . .",
    "G92 X100\nG153\n$CD50 := 0;\nG00 X50": "SAFE 150 . .",
    "G92 X100\nG153\n$CD50 := 0;\nG154\nG00 X50": "SAFE 50 . .",
    "CD50 := 20\nG154\nG00 X5": "!",
    "G70\nG92 X4\nG71\nG01 X100 F100": "!",
    "G70\nG153\nG154\nG00 X5": "SAFE 5 . .",
    "G39 X2\nG22\nG91\nG00 X5": "SAFE 20 . .",
    "G22\nG00 X5\nG24\nG91\nG00 X5": "SAFE 0 . .",
    "G22\nG00 X5\nG24\nG00 Y5": "SAFE -5 5 .",
    "G00 X0\nG22\nG91\nG02 X20 Y0 I10 J0 F100": "SAFE -20 . .",
    "G00 X0 Y0\nG39 X2 Y1\nG23\nG02 X20 Y0 I10 J0 F100": "!",
    "G00 X0 Y0\nG39 X2\nG22\nG02 X20 Y0 I10 J0 F100": "!",
    "G22\nG98 X-5\nG00 X3": "!",
    "G91\nG98 X-5\nG00 X-17": "!",
    "G92 X30\nG99 X40\nG00 X15": "UNKNOWN",
    "G99 X15 \nG99 X500\nG00 X17": "!",
    "G99\nG00 X17": "!",
    "G53\nG99 X5\nG00 Y1": "!",
    "G00 Z-2\nG18\nG03 X20 Z-2 I5 K0 F100": "!",
    "G00 Z-2\nG19\nG02 Y30 Z-2 J5 K0 F100": "!",
    "G18\nG02 X20 Y20 I5 J0 F100": "!",
    "G02 X20 Z-20 I5 K0 F100": "!",
    "G02 X20 Y20 I5 J0 F100\nX30 I5 J0": "SAFE 30 . .",
    "G02 X20 Y20 I5 F100": "SAFE 20 . .",
    "G02 X20 Y20 R5 F100": "!",
    "G161\nG92 X30\nG02 X-10 Y20 I-15 J20 F100": "SAFE 20 . .",
    "G161\nG22\nG00 X0 Y0\nG02 X20 Y0 I10 J0 F100": "SAFE -20 0 .",
    "G161\nG02 X20 Y20 J20 F100": "!",
    "G161\n$if (X.digib.5) then begin\nG162\n$end\nG02 X20 Y20 I15 J20 F100": "!",
    "G150\nG01 X5 F100": "SAFE 5 . .",
    "G151\nG01 X5 F100\nG150\nG01 X150 Y-95": "!",
    "G96 S100\nG01 X5 F100": "SAFE 5 . .",
    "G04 3\nG00 X5": "SAFE 5 . .",
    "G04\nG00 X5": "UNSAFE",
    "G94\nG01 X5 F100": "SAFE 5 . .",
    "T1\nG00 X5": "SAFE 5 . .",
    "D1\nG00 X5": "SAFE 5 . .",
    "M77\nG00 X5": "!",
    "M06\nG00 X5": "SAFE 5 . .",
    "G00 X5 'Y300": "SAFE 5 . .",
    "G00 X5 (Y300)": "SAFE 5 . .",
    "G00 X(5 + 2) (Y300)": "SAFE 7 . .",
    "M3 (go)\nG00 X5": "UNSAFE",
    "G00 X.5 Y-.5": "SAFE .5 -.5 .",
    "$mvabs(X, 300);": "!",
    "$DINEND\nCD601 := 300;\n{$DINSTART}\nG00 X(CD601)": "UNSAFE",
    "G00 X5\n$DINEND\nCD601 := 3;\n{$DINSTART}\nX6": "UNSAFE",
    "$CI602 := 3;\nG00 X(CI602)": "SAFE 3 . .",
    "G54\nG00 X(X.tp)": "!",
    "G54\nG00 X(X.rp)": "!",
    "G91\nG00 X5\nG90\nG00 X(X.tp + 5)": "SAFE 20 . .",
    "CD601 := X.zerooffset\nG00 X(CD601 + 5)": "SAFE 5 . .",
    "G54\nCD601 := X.zerooffset\nG00 X(CD601)": "SAFE 200 . .",
    "G51 X40\nG01 X150 F100": "!",
    "G92 X300\nG91\nG00 X5\nG90\nG53\nG00 X1": "SAFE 1 . .",
    "G91\nG92 X30\nG54\nG92 X30\nG90\nG00 X0": "SAFE 130 . .",
    "G54\nG91\nG92 Y-200\nG90\nG00 X20 Y0": "UNSAFE",
    "G60 X Y\nG92 Z-30\nG53\nG00 Z-130": "!",
    "G60 X Y\nG01 X5 Z-300 F100": "!",
    "G01 X5 F0": "!",
    "G01 X5 F-100": "!",
    "F100\nG01 X5": "SAFE 5 . .",
    "G00 X5\nM02\nG00 X300": "SAFE 5 . .",
    "G00 X5\nM00\nG00 X300": "UNSAFE",
    "G00 X5\nM01\nG00 X300": "UNSAFE",
    "G00 X 5 Y 6": "SAFE 5 6 .",
    "N10 G00 X5\nN20 X6": "SAFE 6 . .",
    'WRITELN "x" X.rp\nG00 X5': "SAFE 5 . .",
    "G00 X5 F100 S1000 M3": "SAFE 5 . .",
}

WITH_NUMBERS = {
    "G00 X(CD601*30)": "SAFE ? . .",
    "G00 X(CD601*35)": "!",
    "M902 605\nG00 X(CI605)": "SAFE 7 . .",
    "M902 605\nG00 X(CI605 * 30)": "!",
    "$if (X.digib.5) then begin\nG00 X5\n$end else begin\nG00 X300\n$end": "SAFE 5 . .",
    "$for CI600:=1 to CI601 do begin\nG91\nG00 X31\n$end;": "SAFE",
    "$for CI600:=1 to CI601 do begin\nG91\nG00 X32\n$end;": "!",
    "$for CI600:=1 to CI601 do begin\nG91\nG92 X31\n$end;\nG90\nG00 X15": "!",
    "G92 X(CD601)\nG00 X195": "!",
    "G92 X(CD601)\nG00 X190": "SAFE ? . .",
    "M98 L114 O(CI601)\nM30\n%114\nG91\nG00 X32\nM17\n%": "!",
    "G99 X(CD601)\nG00 X3": "!",
    "G39 X(CD601)\nG22\nG00 X50": "!",
}

OFFSET = {
    "G00 X145": "SAFE 195 . .",
    "G00 X155": "UNSAFE",
    "G53\nG00 X155": "SAFE 155 . .",
    "G91\nG92 X10\nG90\nG00 X1": "SAFE 61 . .",
    "G92 X10\nG00 X1": "SAFE 11 . .",
    "G54\nG00 X1": "SAFE 101 . .",
    "G153\nG53\nG154\nG00 X1": "SAFE 51 . .",
    "G161\nG02 X-30 Y20 I-35 J20 F100": "SAFE 20 . .",
    "G22\nG00 X100": "SAFE ? . .",
    "G22\nG00 X-160": "!",
}

FROM_A_RANGE = {
    "G91\nG00 X20": "!",
    "G00 X195": "SAFE 195 . .",
    "G00 Y-150": "!",
    "G02 X195 Y20 I5 J0 F100": "!",
    "G22\nG91\nG00 X5": "SAFE ? . .",
    "G22\nG91\nG00 X-10": "!",
}

NOT_HOMED = {
    "G00 X5": "!",
    "G74\nG00 X5": "UNKNOWN",
}

IN_INCHES_OF_THE_AXIS = {
    "G00 X1": "SAFE 25.4 . .",
    "G01 X1 F100": "SAFE 1 . .",
    "G00 X8": "UNSAFE",
    "G70\nG01 X1 F100\nG00 X2": "SAFE 50.8 . .",
    "G91\nG00 X1": "SAFE 35.4 . .",
    "G99 X5\nG00 X2": "UNKNOWN",
    "G54\nG00 X1": "SAFE 125.4 . .",
}

WITH_ABSOLUTE_CENTRES = {
    "G02 X20 Y20 I15 J20 F100": "SAFE 20 . .",
    "G162\nG02 X20 Y20 I5 J0 F100": "SAFE 20 . .",
    "G91\nG02 X10 Y0 I5 J0 F100": "SAFE 20 . .",
    "G54\nG02 X-80 Y-30 I-85 J-30 F100": "SAFE 20 . .",
}

WITH_TOOLS = {
    "T1\nG00 X150 Y-98": "!",
    "T2\nG00 X150 Y-94": "!",
    "T1\nG00 X60 Y-60\nG42\nG01 X80 Y-96 F500\nG01 X180\nG40\nG00 X60": "!",
    "$if (X.digib.5) then begin\nT2\n$end\nG00 X150 Y-96": "!",
    "G00 X150 Y-98": "SAFE 150 -98 .",
}

SETUPS: dict[str, tuple[str, str]] = {
    "as it is": ("", ""),
    "numbers": (
        "[g92]",
        '[parameters]\n1601 = [2.0, 6.0]\n601 = [2.0, 6.0]\n[resident]\nCI605 = 7\n[inputs]\n"X.digib.5" = 1\n[g92]',
    ),
    "offset": ("[g92]\nx = 0.0", "[g92]\nx = 50.0"),
    "range": ("x = 10.0", "x = [10.0, 195.0]"),
    "not homed": ('homed = ["x", "y", "z"]', "homed = []"),
}
MACHINES: dict[str, tuple[str, str]] = {
    "as it is": ("", ""),
    "inches": ("[axes.y]", 'position_unit = "inch"\n[axes.y]'),
    "centres": ("absolute_centers = false", "absolute_centers = true"),
    "tools": ('tool_file = ""', 'tool_file = "ToolComp.INI"'),
}
"""What a setup or a machine file has in place of what SETUP and MACHINE have."""
TABLES: list[tuple[dict[str, str], str, str]] = [
    (ENDS, "as it is", "as it is"), (WITH_NUMBERS, "numbers", "as it is"), (OFFSET, "offset", "as it is"),
    (FROM_A_RANGE, "range", "as it is"), (NOT_HOMED, "not homed", "as it is"),
    (IN_INCHES_OF_THE_AXIS, "as it is", "inches"), (WITH_ABSOLUTE_CENTRES, "as it is", "centres"),
    (WITH_TOOLS, "as it is", "tools"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("program", "setup", "machine", "answer"),
    [(program, setup, machine, answer) for table, setup, machine in TABLES for program, answer in table.items()],
)
def test_a_program_ends_where_the_manual_says(
    program: str, setup: str, machine: str, answer: str, tmp_path: Path
) -> None:
    # A program that has subprograms after its end brings its M30 with it.
    end = "" if "%" in program else "M30\n%\n"
    files = {
        "machine.toml": MACHINE.replace(*MACHINES[machine], 1), "setup.toml": SETUP.replace(*SETUPS[setup], 1),
        "ToolComp.INI": TOOLS, "job.din": f"%\nG90\n{program}\n{end}",
    }  # fmt: skip
    agree(tmp_path, "job.din", files, answer, START)
