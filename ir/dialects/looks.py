"""What lines of controllers look like that others refuse: words and codes that only they have.

Public documentation of each: LinuxCNC "G Code" and "O Codes"; Fanuc custom macro B and subprograms (M98 P, G65);
Siemens 840D; Heidenhain Klartext; RepRap and Marlin; grbl commands that start with $. The three that gproof reads by
their manuals, as in ``frontend/common/detect.py``. Not for finding a language: a line counts only where the job's own
controller refuses it.
"""

from __future__ import annotations

import re

LOOKS: tuple[tuple[str, str, re.Pattern[str]], ...] = tuple(
    (rules, controller, re.compile(pattern, re.I))
    for rules, controller, pattern in (
        ("", "LinuxCNC", r"^\s*O\s*(?:<[^>]*>|\d+)\s*(?:sub|endsub|call|if|elseif|else|endif|do|while|endwhile|repeat|"
                         r"endrepeat|return|break|continue)\b|#<\s*\w+|(?:^|\s)[@^]\s*[-\d\[.#]|\bG5\.1\s*[XIJ]|\bG5\.[23]\b|"
                         r"\b[MS]\d+\s*\$\d|\bM6[2-5]\s*P\d|\bM6[78]\s*E\d|\bM190\s*P"),
        ("", "Fanuc or Mach", r"^\s*[O:]\d{1,5}\s*(?:\(|$)|\bM9[89]\s*P\d|\bG6[56](?:\.\d)?\s*P\d|\bG54\.1\s*P\d|"
                              r"\bGOTO\s*\d|\bIF\s*\[.*\]\s*THEN\b|\bWHILE\s*\[.*\]\s*DO\s*\d|^\s*END\s*[123]\s*$"),
        ("", "Siemens", r"\bMSG\s*\(|\bCYCLE\d+\s*\(|\bMCALL\b|\bSUPA\b|\bR\d+\s*=|^\s*DEF\s+(?:REAL|INT)\b|\bTRANS\b|"
                        r"\bWORKPIECE\s*\(|\bGOTO[FB]\b"),
        ("", "Heidenhain", r"\b(?:BEGIN|END)\s+PGM\b|\bTOOL\s+CALL\b|\bCYCL\s+(?:DEF|CALL)\b|\bFMAX\b|"
                           r"^\s*\d*\s*(?:L|CC|C|LBL|CALL\s+LBL)\s+[XYZRI]?[+-]?\d|\bBLK\s+FORM\b"),
        ("", "a 3D printer (RepRap, Marlin)", r"\bM(?:10[469]|14[01]|190)\s*[SRT]\s*\d|\bM(?:10[578]|11[57])\b|"
                                              r"\bM(?:20[1-5]|22[01]|8[2-4])\b|\bG29\b|\bG[0123]\b.*\bE-?[\d.]|\bG92\s+E"),
        ("", "grbl", r"^\s*\$(?:[HXCNIG#$]\b|J=|\d+=)|^\s*\$\$"),
        ("eding", "Eding CNC", r"^\s*(?:gosub|sub|endsub|endif|endwhile|msg|dlgmsg|errmsg|tcaguard)\b"),
        ("wincnc", "WinCNC", r"^\s*L\d+|\bM1[12](?:\.\d)?\s*C\d|\bM98(?:\.\d)?\s+\w+\.\w+|^\s*\[[^\]]*\]\s*$"),
        ("mcuwin", "McuWIN", r"^\s*(?:N\d+\s*)?\$\s*[a-z]\w|\bC[DI]\d{1,3}\s*:=|\bM9[68]\s*L\s*\d|^\s*%[a-z]\w*"),
    )
)  # fmt: skip
"""Name of the language in ``LanguageRules``, "" for one that gproof does not read; the controller; its lines."""
