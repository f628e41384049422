"""rw_SymPas, the Pascal of McuWIN: its words, operators and functions, for the frontend and the printer.

Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133, chapters 7, 8, 10 to 12. It refers to standards of SAP programming
for expressions and operators (7); their precedence here is that of Pascal.
"""

from __future__ import annotations

KEYWORDS = frozenset(
    (
        "and", "begin", "boolean", "case", "const", "div", "do", "double", "downto", "else", "end", "false", "for",
        "function", "goto", "if", "integer", "label", "mod", "not", "of", "or", "procedure", "repeat", "shl", "shr",
        "then", "to", "true", "until", "var", "while", "write", "writeln", "xor",
    )
)  # fmt: skip
"""Words that no declared name may be."""

RELATIONS = {"=": "==", "<>": "<>", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
SUMS = {"+": "+", "-": "-", "or": "or", "xor": "xor"}
PRODUCTS = {"*": "*", "/": "/", "div": "div", "mod": "rem", "and": "and", "shl": "<<", "shr": "shr"}
"""Pascal operator -> operator of the IR; of each group the one on the left is performed first."""

BITWISE = {"and": "band", "or": "bor", "xor": "bxor", "not": "bnot"}
"""What these are between whole numbers."""

WRITTEN = {ir: word for group in (RELATIONS, SUMS, PRODUCTS) for word, ir in group.items()} | {
    "band": "and", "bor": "or", "bxor": "xor",
}  # fmt: skip
"""Binary operator of the IR -> how it is written."""

LEVEL = (
    dict.fromkeys(RELATIONS.values(), 1)
    | dict.fromkeys(("+", "-", "or", "xor", "bor", "bxor"), 2)
    | dict.fromkeys(("*", "/", "div", "rem", "and", "band", "<<", "shr"), 3)
)
"""Binary operator of the IR -> its level; the higher one is performed first. A sign is before a whole product."""

SIGN_MATTERS = frozenset(("band", "rem", "shr"))
"""Products that differ by whether a sign before them is performed first, which the manual leaves open."""

FUNCTIONS = {
    "abs": "abs", "arccos": "acos", "arcsin": "asin", "arctan": "atan", "boolean": "bool", "cos": "cos", "exp": "exp",
    "frac": "frac", "int": "int", "ln": "ln", "odd": "odd", "round": "nearest", "sin": "sin", "sqr": "sqr",
    "sqrt": "sqrt", "tan": "tan", "trunc": "trunc",
}  # fmt: skip
"""Function -> unary operator of the IR; those of ANGULAR start with ``r`` where angles are radians."""

ANGULAR = frozenset(("acos", "asin", "atan", "cos", "sin", "tan"))

FUNCTION_TEXT = {ir: name for name, ir in FUNCTIONS.items()} | {"bool": "BOOLEAN"} | {
    f"r{ir}": name for name, ir in FUNCTIONS.items() if ir in ANGULAR
}  # fmt: skip
"""Unary operator of the IR -> how it is written."""

COMMON_INTEGER, FIRST_DECLARED = 1000, 2000
"""Numbers of variables: CD n is n, CI n is 1000 + n, the k-th declared one 2000 + k."""

LAST_COMMON = 999
FIRST_USER, LAST_USER = 600, 699
"""CD and CI that are reserved for the user (11)."""

QUALIFIERS = ("tp", "rp", "digib", "zerooffset")
"""What the manual names of an axis: target and real position, a digital input, the zero offset (3.26, 5.7.1, 7, 12)."""

SYSTEM_NAMES = frozenset(
    (
        "axsel", "contcnct", "errorreg", "inhibitprofilerefuse", "ipolmode", "mytasknr", "numparams", "ssf", "ssmsiw",
        "switchoffchecks",
    )
)  # fmt: skip
"""Further names of rw_SymPas that the manual mentions without saying what they hold (3.20, 4.13, 5.4, 14)."""
