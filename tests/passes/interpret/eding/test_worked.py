"""Short Eding CNC programs with the place where each ends, worked out on paper from the manual before they were run.

X starts at 10, Y at 20, Z at -20, A at 0 in machine coordinates; limits are 200 to either side, Z -150 ... 0, A 360 to
either side. G54 has its zero at the machine's, G55 at X10 Z-5. Tools 1 and 2 are 10 and 25 mm long, 6 and 10 mm wide; a
vise is X 100 ... 190, Y -190 ... -100. #110 lies between 2 and 6, #2000 is not stated.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from passes.interpret.core.worked_programs import agree
from support.command import in_this_process

MACHINE = """\
schema = "gproof-machine/1"
units = "mm"
spindle = true
[axes.x]
min = -200.0
max = 200.0
max_velocity = 100.0
max_acceleration = 500.0
[axes.y]
min = -200.0
max = 200.0
max_velocity = 100.0
max_acceleration = 500.0
[axes.z]
min = -150.0
max = 0.0
max_velocity = 100.0
max_acceleration = 500.0
[axes.a]
min = -360.0
max = 360.0
max_velocity = 100.0
max_acceleration = 500.0
[[keep_out]]
name = "vise"
x = [100.0, 190.0]
y = [-190.0, -100.0]
[tools.1]
length = 10.0
diameter = 6.0
[tools.2]
length = 25.0
diameter = 10.0
[controller]
dialect = "eding"
"""
SETUP = """\
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "a"]
start = {x = 10.0, y = 20.0, z = -20.0, a = 0.0}
tool = 1
active_work = 1
tool_length = 0.0
[work.1]
x = 0.0
y = 0.0
z = 0.0
a = 0.0
[work.2]
x = 10.0
y = 0.0
z = -5.0
a = 0.0
[g92]
x = 0.0
y = 0.0
z = 0.0
a = 0.0
[heads.1]
x = 50.0
y = 0.0
z = 0.0
[transform]
angle = 0.0
factor = 1.0
x = 0.0
y = 0.0
[parameters]
5161 = 0.0
5162 = 0.0
5163 = 0.0
5164 = 0.0
110 = [2.0, 6.0]
"""
START = {"x": 10.0, "y": 20.0, "z": -20.0, "a": 0.0}
MACROS = """\
sub m123
G0 X#24
endsub
sub change_tool
G0 X-150
M6 T[#5011]
endsub
sub m124
G91
G0 X5
G90
endsub
sub m125
G92 X0
endsub
"""

ENDS = {
    "G10 L2 P1 X5\nG0 X1": "SAFE 6 . . .",
    "G10 L2 P2 X5\nG0 X1": "SAFE 1 . . .",
    "G10 L2 P2 X5\nG55\nG0 X1": "SAFE 6 . . .",
    "G91\nG10 L2 P1 X5\nG0 X1": "SAFE 11 . . .",
    "G91\nG10 L2 P1 X5\nG90 G0 X1": "SAFE 6 . . .",
    "G10 L20 P1 X0\nG0 X5": "SAFE 15 . . .",
    "G10 L20 P2 X0\nG0 X5\nG55\nX6": "SAFE 16 . . .",
    "G92 X0\nG10 L2 P1 X5\nG0 X1": "SAFE 16 . . .",
    "G92 X0\nG55\nG0 X1": "SAFE 21 . . .",
    "G92 X0\nG92.1\nG0 X1": "SAFE 1 . . .",
    "G92.3\nG0 X1": "UNKNOWN",
    "G92.2\nG92.3\nG0 X1": "UNKNOWN",
    "G0 X#5211": "UNKNOWN",
    "#1=#5211\nG0 X1": "SAFE 1 . . .",
    "G92 X0\nG92.2\nG92.3\nG0 X1": "SAFE 11 . . .",
    "G92 X0\nG92.1\nG92.3\nG0 X1": "SAFE 1 . . .",
    "G92 X7\nG92 X9\nG0 X0": "SAFE 1 . . .",
    "G91\nG92 X0\nG90 G0 X1": "SAFE 11 . . .",
    "G20\nG92 X0\nG0 X1": "SAFE 35.4 . . .",
    "G20\nG92 X1\nG21\nG0 X0": "SAFE -15.4 . . .",
    "G20\nG10 L2 P1 X1\nG21\nG0 X1": "SAFE 26.4 . . .",
    "G92 X4\n#1=#5211\nG0 X[#1]": "SAFE 12 . . .",
    "#5211=3\nG92.3\nG0 X1": "SAFE 4 . . .",
    "#5221=3\nG0 X1": "UNKNOWN",
    "G10 L2 P1 X5\nG0 X[#5221]": "SAFE 10 . . .",
    "G55\nG0 X[#5220]": "SAFE 12 . . .",
    "G0 X[#5001+1]": "SAFE 11 . . .",
    "G92 X0\nG0 X[#5001+1]": "SAFE 11 . . .",
    "G92 X0\nG53 G0 X[#5071+1]": "SAFE 11 . . .",
    "G20\nG0 X[#5001]": "SAFE . . . .",
    "G91\nG53 G0 X5": "SAFE 5 . . .",
    "G55\nG53 G0 X5\nX6": "SAFE 16 . . .",
    "G20\nG53 G0 X1": "SAFE 25.4 . . .",
    "G53 G2 X20 I5 F100": "UNSAFE",
    "G28": "SAFE 0 0 0 0",
    "G28 X15": "SAFE 0 0 0 0",
    "G28 X300": "UNSAFE",
    "G91 G28 X195": "UNSAFE",
    "G92 X-195\nG28 X0": "UNSAFE",
    "G91 G28 X0 Y0\nG90 G0 X5": "SAFE 5 0 0 0",
    "G30": "UNKNOWN",
    "G52 X5": "UNSAFE",
    "G68 R90 X0 Y0\nG0 X5 Y0": "SAFE 0 5 . .",
    "G68 R90 X10 Y20\nG0 X15 Y20": "SAFE 10 25 . .",
    "G68 R90 X10 Y20\nG0 X15": "SAFE 10 25 . .",
    "G68 R90 X0 Y0\nG91\nG0 X5": "SAFE 10 25 . .",
    "G68 R90 X0 Y0\nG69\nG0 X5 Y6": "SAFE 5 6 . .",
    "G68 R90 X0 Y0\nG0 X30 Y0\nG53 G0 X5 Y6": "SAFE 5 6 . .",
    "G68 R90 X0 Y0\nG68 R0 X0 Y0\nG0 X5 Y6": "SAFE 5 6 . .",
    "G68 R90 X0 Y0\nG54\nG0 X5 Y0": "SAFE 0 5 . .",
    "G68 R90 X0 Y0\nG55\nG0 X5 Y0": "UNKNOWN",
    "G68 R90 X0 Y0\nG92 X0 Y0\nG0 X5 Y0": "UNKNOWN",
    "G68 R90 X0 Y0\nG10 L2 P1 X50\nG0 X5 Y0": "UNKNOWN",
    "G68 R90 X10 Y20\nG2 X20 Y20 I5 J0 F100": "SAFE 10 30 . .",
    "G55\nG68 R90 X0 Y0\nG0 X5 Y0": "SAFE 10 5 . .",
    "G51 P2 I0 J0\nG0 Z-80": "!",
    "G51 P2 I0 J0\nG0 X1\nX2 Z-80": "!",
    "G51 P2 I0 J0\nG0 Z-70": "SAFE . . ? .",
    "G51 P2 I0 J0\nG0 Z-20\nG1 X5 F100\nX6 Z-30\nG50\nZ-10": "SAFE 12 . -10 .",
    "G51 P2 I0 J0\nG91 G0 Z-70": "!",
    "G51 P-1 I0 J0\nG0 Z-5": "!",
    "G51 P2 I0 J0\nG0 Z[#5003-50]": "!",
    "G51 P2 I0 J0\nG92 Z0\nG0 Z-1": "!",
    "G51 P2 I0 J0\nG81 X1 Z-60 R-10 F100": "UNKNOWN",
    "G51 X2 Y2 I0 J0\nG0 Z-80": "SAFE . . -80 .",
    "G51 P2 I0 J0\nG50\nG0 Z-80": "SAFE . . -80 .",
    "G51 P2 I0 J0\nG0 X5 Y6": "SAFE 10 12 . .",
    "G51 X2 Y3 I0 J0\nG0 X5 Y6": "SAFE 10 18 . .",
    "G51 X2 Y3 I0 J0\nG2 X20 Y20 I5 J0 F100": "UNSAFE",
    "G51 P2 I0 J0\nG50\nG0 X5": "SAFE 5 . . .",
    "G51 P2 I10 J20\nG0 X15": "SAFE 20 . . .",
    "G51 P2 I10 J20\nG91\nG0 X5": "SAFE 20 . . .",
    "G51 P50 I0 J0\nG0 X5 Y0": "UNSAFE",
    "G51 P2 I10 J20\nG2 X20 Y20 I5 J0 F100": "SAFE 30 . . .",
    "G51 P2 I0 J0\nG92 X0\nG0 X5 Y0": "UNKNOWN",
    "G51 P2 I0 J0\nG28": "SAFE 0 0 0 0",
    "G51 P2 I0 J0\nG53 G0 X5": "SAFE 5 . . .",
    "G0 Z-10\nG81 X1 Y2 Z-30 R-20 F100": "SAFE 1 2 -10 .",
    "G0 Z-10\nG99 G81 X1 Y2 Z-30 R-20 F100": "SAFE 1 2 -20 .",
    "G91\nG81 X5 Y0 Z-10 R-5 L3 F100": "SAFE 25 . -20 .",
    "G91 G99\nG81 X5 Y0 Z-10 R-5 L3 F100": "SAFE 25 . -25 .",
    "G81 X1 Y2 Z-30 R-10 F100": "SAFE 1 2 -10 .",
    "G81 X1 Z-30 R-10 F100\nX2\nG80\nG0 Y5": "SAFE 2 5 -10 .",
    "G81 X1 Z-30 R-10 F100\nG80 X5": "UNSAFE",
    "G81 X1 Z-30 R-10 F100\nG80\nX5": "UNSAFE",
    "G91\nG81 Z-10 R-5 X100 L2 F100": "UNSAFE",
    "G91\nG81 X1 Z-60 R-75 L1 F100": "UNSAFE",
    "G91\nG81 X1 Z-60 R21 L1 F100": "UNSAFE",
    "G81 X1 Z-5 R-10 F100": "UNSAFE",
    "G81 X1 Z-30 R-10 L0 F100": "UNSAFE",
    "G93\nG81 X1 Z-30 R-10 F10": "UNSAFE",
    "G83 X1 Z-30 R-10 Q0 F100": "UNSAFE",
    "G83 X1 Z-30 R-10 Q3 F100": "SAFE 1 . -10 .",
    "G91\nG83 X1 Z-30 R5 Q3 L2 F100": "SAFE 12 . -15 .",
    "G86 X1 Z-30 R-10 F100 P1": "UNKNOWN",
    "G81 X1 A5 Z-30 R-10 F100": "UNSAFE",
    "G18\nG81 X1 Y-5 Z-25 R10 F100": "SAFE 1 20 -25 .",
    "G19\nG81 X5 Y6 Z-25 R8 F100": "SAFE 10 6 -25 .",
    "G20\nG81 X1 Z-1.5 R-1 F10": "SAFE 25.4 . -20 .",
    "G81 X1 Y2 Z-30 R-10 F100\nG0 X5\nG81 X6": "UNSAFE",
    "G81 X1 Z-30 R-10 F100\nG82 X2 P1": "UNSAFE",
    "G0 Z-10\nG81 X1 Z-30 R-15 F100\nX2 Z-40 R-20": "SAFE 2 . -10 .",
    "G43 H2\nG81 X1 Z-50 R-40 F100": "SAFE 1 . -15 .",
    "G92 Z0\nG81 X1 Z-10 R-5 F100": "SAFE 1 . -20 .",
    "G92 Z0\nG81 X1 Z-131 R-5 F100": "UNSAFE",
    "G2 X20 Y20 I5 J0 F100": "SAFE 20 . . .",
    "G91\nG2 X10 Y0 I5 J0 F100": "SAFE 20 . . .",
    "G2 X20 R-6 F100": "SAFE 20 . . .",
    "G2 X10 Y20 I5 J0 F100": "SAFE . . . .",
    "G2 X10 Y20 I100 J0 F100": "UNSAFE",
    "G2 I5 F100": "UNSAFE",
    "G2 X10 Y20 R5 F100": "UNSAFE",
    "G2 X20 I6 F100": "UNSAFE",
    "G2 X20 R4 F100": "UNSAFE",
    "G0 Z-2\nG18\nG2 X20 I5 K0 F100": "SAFE 20 . -2 .",
    "G0 Z-2\nG18\nG3 X20 I5 K0 F100": "UNSAFE",
    "G0 Z-2\nG19\nG3 Y30 J5 K0 F100": "SAFE . 30 -2 .",
    "G0 Z-2\nG19\nG2 Y30 J5 K0 F100": "UNSAFE",
    "G18\nG2 X20 I5 J0 F100": "UNSAFE",
    "G2 X20 Z-30 I5 F100": "SAFE 20 . -30 .",
    "G2 X20 Z-30 R5 F100": "SAFE 20 . -30 .",
    "G2 X20 I5 F100\nX30": "UNSAFE",
    "G2 X20 R6 F100\nX30 R6": "SAFE 30 . . .",
    "G43\nG0 Z-40": "SAFE . . -30 .",
    "G43 H2\nG0 Z-40": "SAFE . . -15 .",
    "G43 H2\nG49\nG0 Z-40": "SAFE . . -40 .",
    "G43.1 K7\nG0 Z-40": "SAFE . . -33 .",
    "G43 H2\nG53 G0 Z-40": "SAFE . . -40 .",
    "G43 H2\nG91 G0 Z-5": "SAFE . . -25 .",
    "#5401=12\nG43\nG0 Z-40": "SAFE . . -28 .",
    "G43 H2\n#5402=20\nG0 Z-40": "UNKNOWN",
    "G43 H2\nG0 Z-10": "UNSAFE",
    "G20\nG43 H2\nG0 Z-2": "SAFE . . -25.8 .",
    "G0 G43 H2 Z-40": "SAFE . . -15 .",
    "G43 H0\nG0 Z-40": "UNSAFE",
    "#1=2\nG43 H#1\nG0 Z-40": "SAFE . . -15 .",
    "G0 Z[#5010-50]": "SAFE . . -40 .",
    "G43 H2\nG0 Z[#5013-60]": "SAFE . . -10 .",
    "G20\nG43.1 K1\nG0 Z-3": "SAFE . . -50.8 .",
    "G43\nG92 Z0\nG49\nG0 Z-5": "SAFE . . -35 .",
    "G92 Z0\nG43\nG0 Z-5": "SAFE . . -15 .",
    "G43\nG10 L20 P1 Z0\nG49\nG0 Z-5": "SAFE . . ? .",
    "#1=0\nwhile [#1<3]\nG92 X0\nG0 X5\n#1=[#1+1]\nendwhile\nG0 X0": "SAFE 20 . . .",
    "sub a\nG10 L2 P1 X[#5221+5]\nendsub\ngosub a\ngosub a\nG0 X1": "SAFE 11 . . .",
    "if [#2000==1]\nG92 X0\nendif\nG0 X150": "SAFE",
    "if [#2000==1]\nG92 X5\nendif\nG0 X198": "!",
    "if [#2000>1]\nG91\nendif\nG0 X195": "!",
    "if [#2000>1]\nG20\nendif\nG0 X10": "!",
    "if [#2000>1]\nG43 H2\nendif\nG0 Z-10": "!",
    "if [#2000>1]\nG68 R90 X0 Y0\nendif\nG0 X150 Y-180": "!",
    "/G92 X-100\nG0 X150": "UNSAFE",
    "sub a\nG91\nendsub\ngosub a\nG0 X5": "SAFE 15 . . .",
    "#1=2\n#1=5 G0 X#1": "SAFE 2 . . .",
    "G0 X[2+3*4]": "SAFE 14 . . .",
    "G0 X[FIX[-2.8]]": "SAFE -3 . . .",
    "G0 X[10-4-3]": "SAFE 3 . . .",
    "G0 X[8/4/2]": "SAFE 1 . . .",
    "G0 X[ATAN[1]/[1]]": "SAFE 45 . . .",
    "G92 X0\nG0 X[#110*10]": "SAFE ? . . .",
    "G92 X-100\nG0 X[#110*16]": "UNKNOWN",
    "G38.2 Z-50 F100\nG0 Z-1": "SAFE . . -1 .",
    "G38.2 Z-50 F100\nG92 Z0\nG0 Z30": "UNKNOWN",
    "G38.2 Z-50 F100\nG91 G0 Z30": "UNKNOWN",
    "G38.2 Z-50 F100\nG0 Z[#5063+5]": "SAFE",
    "G38.2 Z-50 F100\nG10 L20 P1 Z0\nG0 Z15": "SAFE . . ? .",
    "G38.2 Z-50 F100\nG10 L20 P1 Z0\nG0 Z25": "UNKNOWN",
    "G38.2 Z-50 F100\nG10 L2 P1 Z#5053\nG0 Z15": "SAFE . . ? .",
    "G38.2 Z-50 F100\nG10 L2 P1 Z#5053\nG0 Z25": "UNKNOWN",
    "G38.2 Z-200 F100": "UNSAFE",
    "G43 H2\nG38.2 Z-60 F100\nG0 Z[#5053+20]": "UNSAFE",
    "G0 A720": "UNSAFE",
    "G91 G0 A350\nA20": "UNSAFE",
    "G20\nG0 A90": "SAFE . . . 90",
    "G51 P2 I0 J0\nG0 A90": "SAFE . . . ?",
    "G10 L2 P1 A30\nG0 A340": "UNSAFE",
    "G20\nG10 L2 P1 A30\nG0 A10": "SAFE . . . 40",
    "G93\nG1 X5": "UNSAFE",
    "G93\nG1 X5 F10\nX6": "UNSAFE",
    "G93\nG1 X5 F10\nG94\nX6 F100": "SAFE 6 . . .",
    "M91\nG0 X160": "UNSAFE",
    "M91\nM90\nG0 X160": "SAFE 160 . . .",
    "M92\nG0 X5": "UNKNOWN",
    "G0 X5\nM30\nG0 X300": "SAFE 5 . . .",
    "MCAGuard off\nG0 X300": "!",
    "G0 X60 Y-60\nG42 D1\nG1 X80 Y-96 F500\nX180\nY-50\nG40\nG0 X60": "UNSAFE",
    "G0 X60 Y-60\nG41 D1\nG1 X80 Y-96 F500\nX180\nG1 Y-50\nG40\nG0 X60": "UNSAFE",
    "G0 X150 Y-98": "UNSAFE",
    "#5501=16\nG0 X150 Y-94": "UNSAFE",
    "G92 Y60\nG0 X150 Y-58": "UNSAFE",
    "G68 R-90 X0 Y0\nG0 X98 Y150": "UNSAFE",
    "T2 M6\nG0 X150 Y-96": "UNSAFE",
    "M91\nG0 X100 Y-98": "!",
    "G43 H2\nM30": "SAFE . . . .",
    "G55\nG81 X1 Z-30 R-10 F100": "SAFE 11 . -15 .",
    "G55\nG43\nG92 Z0\nG0 Z5": "SAFE . . -15 .",
    "G92 X0\nG54\nG92.2\nG10 L2 P1 X3\nG92.3\nG0 X0": "SAFE 13 . . .",
    "G21 G0 X5\nG70\nX1": "SAFE 25.4 . . .",
    "G70\nG0 X1\nG71\nX1": "SAFE 1 . . .",
    "G90\nG0 X5\nG4 P-1": "UNSAFE",
    "G0 X5 G28": "UNSAFE",
    "G20 G0 X8": "UNSAFE",
    "G10 L2 P10 X5": "UNSAFE",
    "G10 L2 P1 X5 R90\nG0 X5 Y0": "!",
    "if [#2000>1]\n#5501=16\nendif\nG0 X150 Y-94": "!",
    "if [#2000>1]\n#5401=50\nendif\nG43\nG0 Z-40": "!",
    "if [#2000>1]\nT2 M6\nendif\nG0 X150 Y-96": "!",
    "if [#2000>1]\nG55\nendif\nG0 X195": "!",
    "if [#2000>1]\nG10 L2 P1 X10\nendif\nG0 X195": "!",
    "if [#2000>1]\nG51 P2 I0 J0\nendif\nG0 X195": "!",
    "if [#2000>1]\nG81 X1 Z-30 R-10 F100\nendif\nX195": "!",
    "while [#2000>1]\nG91 G0 X5\nendwhile": "!",
    "#1=0\nwhile [#1<#110]\nG92 X0\nG0 X40\n#1=[#1+1]\nendwhile": "!",
    "#1=0\nwhile [#1<#110]\nG92 X0\nG0 X31\n#1=[#1+1]\nendwhile": "SAFE",
    "#1=0\nwhile [#1<#110]\nG91 G0 X40\n#1=[#1+1]\nendwhile": "!",
    "G0 X300 (gproof: allow GP301)": "!",
    "(gproof: allow GP301)\nG0 X300": "!",
    "G51 P0.5 I0 J0\nG68 R90 X50 Y0\nG0 X10 Y0": "UNKNOWN",
    "G68 R90 X10 Y20\nG51 P2 I10 J20\nG0 X15 Y20": "SAFE 10 30 . .",
    "G91\nG68 R90 X0 Y0\nG0 X5": "UNKNOWN",
    "G20\nG68 R90 X1 Y0\nG0 X2 Y0": "SAFE 25.4 25.4 . .",
    "G20\nG51 P2 I1 J0\nG0 X2 Y0": "SAFE 76.2 0 . .",
    "G20\nG68 R90 X1 Y0\nG21\nG0 X50.8 Y0": "SAFE 25.4 25.4 . .",
    "G68 R90 X0 Y0\nG81 X5 Y0 Z-30 R-10 F100": "SAFE 0 5 -10 .",
    "G68 R90 X10 Y20\nG18\nG2 X20 Z-20 I5 K0 F100": "!",
    "G51 P-1 I0 J0\nG0 X-150 Y150": "!",
    "G51 P2\nG0 X150": "!",
    "G68 R90\nG0 X150 Y190": "!",
    "G92 X0\nG10 L20 P1 X5\nG0 X0": "SAFE ? . . .",
    "G68 R90 X0 Y0\nG10 L20 P1 X0 Y0\nG0 X1 Y0": "UNKNOWN",
    "#5220=2\nG0 X1": "!",
    "#5241=50\nG55\nG0 X1": "SAFE 51 . . .",
    "G55\nG10 L2 P#5220 X50\nG0 X1": "SAFE 51 . . .",
    "G10 L2 P0 X5": "UNSAFE",
    "G10 L2 P1 X#110\nG0 X195": "!",
    "G10 L2 P1 X#110\nG0 X190": "SAFE ? . . .",
    "G43 H2\nG43\nG0 Z-40": "SAFE . . -30 .",
    "G43\nT2 M6\nG0 Z-40": "SAFE . . -15 .",
    "G43 H1\nT2 M6\nG0 Z-40": "SAFE . . -30 .",
    "T2\nM6\nG43\nG0 Z-40": "SAFE . . -15 .",
    "T2\nG43\nG0 Z-40": "SAFE . . -30 .",
    "T0 M6\nG43\nG0 Z-40": "SAFE . . -40 .",
    "#5402=50\nT2 M6\nG43\nG0 Z-40": "!",
    "G43\n#5401=50\nG0 Z-40": "!",
    "if [#110>3]\n#5401=50\nendif\nG43\nG0 Z-40": "UNSAFE",
    "G41 D1\nG53 G0 X5": "UNSAFE",
    "G41 D1\nG55\nG1 X20 F100": "UNSAFE",
    "G41 D1\nG81 X1 Z-30 R-10 F100": "UNSAFE",
    "G41 D1\nG1 X20 F100\nG92 X0\nG1 X30\nG40": "!",
    "G41 D1\nG1 X20 F100\nG28\nG40": "!",
    "G0 X60 Y-60\n#5501=16\nG42 D1\nG1 X80 Y-91 F500\nX180\nG40\nG0 X60": "!",
    "G0 X60 Y-60\nG42 D2\nG1 X80 Y-94 F500\nX180\nG40\nG0 X60": "!",
    "M3 S500\nG33 Z-160 K1": "!",
    "M3 S500\nG33 Z-30 K1": "SAFE . . -30 .",
    "M3 S500\nG33.1 Z-30 K1": "SAFE . . -20 .",
    "M3 S500\nG33.1 Z-160 K1": "!",
    "while [1]\nG91 G0 X1\nendwhile": "UNSAFE",
    "#1=0\nwhile [#1<>10]\n#1=[#1+3]\nG91 G0 X1\nendwhile": "UNSAFE",
    "sub a\n#1=50\nendsub\n#1=5\ngosub a\nG0 X#1": "SAFE 50 . . .",
    "sub a\nif [#110>3]\nM30\nendif\nendsub\ngosub a\nG0 X300": "UNSAFE",
    "if [#5397==1]\nG0 X5\nelse\nG0 X300\nendif": "UNSAFE",
    'dlgmsg "a" "b" 100\nif [#5398==1]\nG0 X5\nelse\nG0 X300\nendif': "UNSAFE",
    "if [#5380==1]\nG0 X5\nelse\nG0 X300\nendif": "!",
    "M56 P1\nif [#5399==1]\nG0 X300\nendif": "!",
    "G38.2 Z-50 F100\nif [#5067==1]\nG0 X5\nelse\nG0 X300\nendif": "!",
    "G38.2 Z-50 F100\nif [#5067==0]\nG0 X5\nelse\nG0 X300\nendif": "!",
    "G38.2 X150 F100\nG91 G0 Y-150\nG0 X40": "!",
    "G92 X5 G0 X6": "UNSAFE",
    "G0 X1 G20": "SAFE 25.4 . . .",
    "G0 X1 G55": "SAFE 11 . . .",
    "G0 X5 G91": "SAFE 15 . . .",
    "T2 M6 G0 X5": "SAFE 5 . . .",
    "M30 G0 X5": "SAFE 5 . . .",
    "G81 X1 Z-30 R-10 F100\nG53 X5": "UNSAFE",
    "G1 X5 F100\nG55\nG53 X6\nX7": "SAFE 17 . . .",
    "M91\nG53 G0 X5": "!",
    "g0x+0. 12 34y 7": "SAFE 0.1234 7 . .",
    "G0 X5 X6": "UNSAFE",
    "G0 G1 X5 F100": "UNSAFE",
    "G0 X5 (a (b) c)": "UNSAFE",
    "G0 X5 ; X300": "SAFE 5 . . .",
    "#2=1\n#1=7\nG0 X##2": "SAFE 7 . . .",
    "#[1+1]=9\nG0 X#2": "SAFE 9 . . .",
    "#1=1\nG#1 X5 F100": "SAFE 5 . . .",
    "G0 X5\nG4 P1 X300": "!",
    "G91\nG83 X50 Z-10 R-1 Q1 L4 F100": "UNSAFE",
    "G91\nG81 X50 Z-10 R-1 F100\nX50\nX50\nX50": "UNSAFE",
    "G91\nG81 X50 Z-10 R-1 F100 L2\nX50 L2": "UNSAFE",
    "G91\nG81 X5 Z-10 R-1 F100\nX5 L2": "SAFE 25 . -20 .",
    "G91 G99\nG81 X5 Z-10 R-5 F100\nX5": "SAFE 20 . -30 .",
    "G91 G99\nG81 X5 Z-40 R-30 F100\nX5\nX5\nX5": "UNSAFE",
    "G0 Z-10\nG98 G81 X1 Z-30 R-20 F100\nG99 X2\nG0 X3": "SAFE 3 . -20 .",
    "#5211=300\nG92.3\nG0 X5": "UNSAFE",
    "G92 X0\nG92.2\n#5211=20\nG92.3\nG0 X0": "SAFE 20 . . .",
    "G92 X0\n#5211=20\nG0 X0": "!",
    "G20\nG92 X0\nG92.2\nG21\nG92.3\nG0 X1": "SAFE 11 . . .",
    "G93\nG2 X20 I5\n": "UNSAFE",
    "G95 F2\nM3 S500\nG1 X5": "SAFE 5 . . .",
    "G64 P50\nG1 X195 F100\nY100": "SAFE 195 100 . .",
    "G10 L2 P1 X5 Y-30\ng0 X150 Y-68": "UNSAFE",
    "G18\nG2 X20 Y60 R6 F100": "SAFE 20 60 . .",
    "G18 G91\nG81 X1 Y-5 Z-2 R-10 L3 F100": "SAFE 13 20 -26 .",
    "G19 G91\nG81 X-5 Y1 Z-2 R-10 L3 F100": "SAFE 10 23 -26 .",
    "G19 G91 G99\nG81 X-5 Y1 Z-2 R-10 L3 F100": "SAFE 0 23 -26 .",
    "G10 L2 P1 Z-5\nG43 H2\nG81 X1 Z-50 R-30 F100": "SAFE 1 . -10 .",
    "if [#2000>1]\nG92 X0\nelse\nG92 X20\nendif\nG92 X0\nG0 X5": "SAFE",
    "if [#2000>1]\nG92 X0\nendif\nG92.1\nG0 X5": "SAFE",
    "if [#2000>1]\nG92 X0\nendif\nG92.2\nG0 X5\nG92.3\nG0 X195": "!",
    "G28 X0 Y0\nG0 X5": "SAFE 5 0 0 0",
    "G43 H2\nG28 Z-60": "SAFE 0 0 0 0",
    "G43 H2\nG28 Z-10": "UNSAFE",
    "G43 H2\nG28\nG0 Z-30": "SAFE 0 0 -5 0",
    "G90 G28 X150 Y-150": "UNSAFE",
    "G10 L20 P1 X0 Y0 Z0\nG0 Z21": "UNSAFE",
    "G43\nG10 L20 P1 Z0\nG0 Z21": "UNSAFE",
    "G43\nG10 L20 P1 Z0\nG0 Z-5": "SAFE . . ? .",
    "G43\nG10 L20 P1 Z0\nT2 M6\nG0 Z-5": "SAFE . . ? .",
}

WITH_BLOCK_DELETE = {
    "/G0 X300": "SAFE . . . .",
    "/G92 X-100\nG0 X150": "SAFE 150 . . .",
    "/G41 D1\nG1 X20 F100": "SAFE 20 . . .",
}

FROM_A_RANGE = {
    "G91 G0 X20": "!",
    "G0 X195": "SAFE 195 . . .",
    "G92 X0\nG0 X20": "!",
    "G2 X195 Y20 R100 F100": "!",
    "G81 Z-30 R-10 F100": "SAFE ? . -10 .",
    "G0 Y-150": "!",
    "G55\nG53 G0 X5": "SAFE 5 . . .",
}

WITH_A_ZERO_IN_A_RANGE = {
    "G0 X195": "!",
    "G0 X191": "SAFE ? . . .",
    "G0 X[#5221+187]": "!",
    "G10 L2 P1 X0\nG0 X195": "SAFE 195 . . .",
    "G0 X95 Y-150": "!",
    "G55\nG0 X5": "SAFE 15 . . .",
    "G92 X0\nG54 G0 X5": "SAFE 15 . . .",
    "G92 X0\nG55\nG0 X5": "SAFE ? . . .",
}

WITH_A_LENGTH = {
    "G0 Z-5": "UNSAFE",
    "G49\nG0 Z-5": "SAFE . . -5 .",
    "G92 Z0\nG49\nG0 Z-5": "SAFE . . -35 .",
    "G91\nG0 Z15": "SAFE . . -5 .",
    "G53 G0 Z-5": "SAFE . . -5 .",
    "G43 H2\nG0 Z-40": "SAFE . . -15 .",
    "T2 M6\nG0 Z-8": "!",
}

WITH_NO_LENGTH_STATED = {
    "G49\nG0 Z-5": "SAFE . . -5 .",
    "G43\nG0 Z-40": "SAFE . . -30 .",
}

TURNED = {
    "G0 X-150 Y-150": "UNSAFE",
    "G69\nG0 X150 Y150": "SAFE 150 150 . .",
    "G0 X5 Y6": "SAFE -6 5 . .",
    "G53 G0 X5 Y6": "SAFE 5 6 . .",
    "G28": "SAFE 0 0 0 0",
    "G54\nG0 X5 Y6": "SAFE -6 5 . .",
    "G50\nG0 X5 Y6": "SAFE -6 5 . .",
}

SCALED = {
    "G0 X150": "UNSAFE",
    "G50\nG0 X150": "SAFE 150 . . .",
    "G69\nG0 X150": "UNSAFE",
    "G91 G0 X5": "SAFE 20 . . .",
}

OFFSET = {
    "G0 X145": "UNSAFE",
    "G92.1\nG0 X185": "SAFE 195 . . .",
    "G54\nG0 X145": "SAFE 195 . . .",
    "G92.2\nG0 X1\nG92.3\nG0 X1": "SAFE 61 . . .",
    "G0 X#5211": "SAFE 110 . . .",
    "G0 X[#5220]": "SAFE 62 . . .",
    "G92 X0\nG54\nG0 X0": "SAFE 0 . . .",
    "G10 L2 P2 X20\nG0 X0": "SAFE 70 . . .",
}

STORED = {
    "G92.3\nG0 X1": "SAFE 51 . . .",
    "G92.3\nG0 X160": "UNSAFE",
    "G0 X#5211": "SAFE 50 . . .",
    "G92.2\nG92.3\nG0 X1 Y2": "SAFE 51 2 . .",
    "G92.1\nG92.3\nG0 X1": "SAFE 1 . . .",
}
"""The setup states 50 for #5211 and 0 for the others, and that no offset is in force."""

WITH_MACROS = {
    "M123 X7": "SAFE 7 . . .",
    "M123": "UNSAFE",
    "G20\nM123 X1": "SAFE 25.4 . . .",
    "M6 T2\nG43\nG0 Z-40": "SAFE -150 . -15 .",
    "G20\nM6 T2": "UNSAFE",
    "G91\nM6 T2": "SAFE -140 . . .",
    "G91\nM124\nG0 X5": "SAFE 5 . . .",
    "M125\nG0 X5": "SAFE 15 . . .",
    "G68 R90 X0 Y0\nM6 T2": "SAFE . -150 . .",
    "M124\nM124": "SAFE 20 . . .",
    "G43\nM6 T2\nG0 Z-40": "SAFE -150 . -15 .",
    "G1 X5 F100\nM123 X7\nX8": "SAFE 8 . . .",
    "M123 X#110": "SAFE ? . . .",
    "M123 Y7": "UNSAFE",
}

WITH_A_CHANGE_AREA = {
    "G0 X-160": "!",
    "TCAGuard off\nG0 X-160\nG0 X0\nTCAGuard on": "SAFE 0 . . .",
    "TCAGuard off\nG0 X-160\nTCAGuard on\nG0 X-170": "!",
    "G38.2 X-160 F100": "!",
    "G28 X-160": "!",
    "G92 X50\nG0 X-115": "!",
    "G53 G0 X-160": "!",
}

IN_DIAMETERS = {
    "G0 X300": "SAFE 150 . . .",
    "G91 G0 X20": "SAFE 20 . . .",
    "G92 X0\nG0 X20": "SAFE 20 . . .",
    "G0 X#5001": "SAFE . . . .",
    "G0 X#5221": "SAFE 0 . . .",
    "G0 X410": "UNSAFE",
    "G0 X390\nG91 X12": "UNSAFE",
}

AS_SWITCHED_ON = {
    "G21 G90\nG0 X9": "SAFE 9 . . .",
    "G21 G90 G0 X9 Z-160": "UNSAFE",
}

SETUPS: dict[str, tuple[str, str]] = {
    "block delete": ("tool = 1\n", "tool = 1\nblock_delete = true\n"),
    "range": ("x = 10.0, y", "x = [10.0, 195.0], y"),
    "zero": ("[work.1]\nx = 0.0", "[work.1]\nx = [5.0, 8.0]"),
    "length": ("tool_length = 0.0", "tool_length = 10.0"),
    "no length": ("tool_length = 0.0\n", ""),
    "turned": ("angle = 0.0", "angle = 90.0"),
    "scaled": ("factor = 1.0", "factor = 2.0"),
    "offset": ("active_work = 1", "active_work = 2"),
    "stored": ("[parameters]\n", "[parameters]\n5211 = 50\n5212 = 0\n5213 = 0\n5214 = 0\n"),
}
"""What a setup has in place of what SETUP has."""
TABLES: list[tuple[dict[str, str], str]] = [
    (WITH_BLOCK_DELETE, "block delete"), (FROM_A_RANGE, "range"), (WITH_A_ZERO_IN_A_RANGE, "zero"),
    (WITH_A_LENGTH, "length"), (WITH_NO_LENGTH_STATED, "no length"), (TURNED, "turned"),
    (SCALED, "scaled"), (OFFSET, "offset"),
    (STORED, "stored"),
]  # fmt: skip
HEAD = "G21 G90 G54 G17\n"


@pytest.mark.parametrize("program", ENDS)
def test_a_program_ends_where_the_manual_says(program: str, tmp_path: Path) -> None:
    files = {"machine.toml": MACHINE, "setup.toml": SETUP, "job.cnc": f"{HEAD}{program}\n"}
    agree(tmp_path, "job.cnc", files, ENDS[program], START)


@pytest.mark.parametrize(
    ("program", "name", "answer"), [(p, name, a) for table, name in TABLES for p, a in table.items()]
)
def test_what_a_setup_states_counts(program: str, name: str, answer: str, tmp_path: Path) -> None:
    setup = SETUP.replace(*SETUPS[name], 1)
    head = HEAD
    if name == "offset":
        setup, head = setup.replace("[g92]\nx = 0.0", "[g92]\nx = 50.0"), "G21 G90 G17\n"
    assert setup != SETUP
    files = {"machine.toml": MACHINE, "setup.toml": setup, "job.cnc": f"{head}{program}\n"}
    agree(tmp_path, "job.cnc", files, answer, START)


@pytest.mark.parametrize("program", WITH_MACROS)
def test_macros_are_called_in_the_modes_of_the_job(program: str, tmp_path: Path) -> None:
    machine = f'{MACHINE}macro_file = "macro.cnc"\n'
    files = {"machine.toml": machine, "macro.cnc": MACROS, "setup.toml": SETUP, "job.cnc": f"{HEAD}{program}\n"}
    agree(tmp_path, "job.cnc", files, WITH_MACROS[program], START)


@pytest.mark.parametrize("program", WITH_A_CHANGE_AREA)
def test_a_change_area_is_for_tool_changes(program: str, tmp_path: Path) -> None:
    area = "[areas.tool_change]\nx = [-200.0, -150.0]\ny = [-200.0, 200.0]\nz = [-150.0, 0.0]\n"
    files = {"machine.toml": f"{MACHINE}{area}", "setup.toml": SETUP, "job.cnc": f"{HEAD}{program}\n"}
    agree(tmp_path, "job.cnc", files, WITH_A_CHANGE_AREA[program], START)


@pytest.mark.parametrize("program", IN_DIAMETERS)
def test_x_counts_diameters(program: str, tmp_path: Path) -> None:
    machine = f"{MACHINE}turning = true\ndiameter_programming = true\n"
    files = {"machine.toml": machine, "setup.toml": SETUP, "job.cnc": f"G21 G90 G54 G18\n{program}\n"}
    agree(tmp_path, "job.cnc", files, IN_DIAMETERS[program], START)


@pytest.mark.parametrize("program", AS_SWITCHED_ON)
def test_a_job_may_begin_with_a_motion(program: str, tmp_path: Path) -> None:
    files = {"machine.toml": MACHINE, "setup.toml": SETUP, "job.cnc": f"{program}\n"}
    agree(tmp_path, "job.cnc", files, AS_SWITCHED_ON[program], START)


@pytest.mark.parametrize(
    ("program", "said"),
    [
        # The probe touches at Z-60 to Z-20: 65 above that is 5 at the least, and the axis ends at 0.
        ("G43 H2\nG38.2 Z-60 F100\nG0 Z[#5053+90]", "leaves no room for the job: it is at least "),
        ("#1=[#110*10]\nG0 Z#1", "leaves no room for the job: it is at least 20.000 mm, and at most 0.000 mm is safe"),
        ("#1=[-100*#110]\nG0 Z#1", "leaves no room for the job: it is at most -200.000 mm, and at least "),
    ],
)  # fmt: skip
def test_a_range_that_never_fits_is_told_with_its_nearest_value(program: str, said: str, tmp_path: Path) -> None:
    files = {"machine.toml": MACHINE, "setup.toml": SETUP, "job.cnc": f"{HEAD}{program}\n"}
    for name, text in files.items():
        (tmp_path / name).write_text(text, "utf-8")
    words = ["check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    findings = json.loads(in_this_process(words, tmp_path).out)["findings"]
    assert [said in f["message"] for f in findings if f["code"] == "GP303"] == [True], findings
