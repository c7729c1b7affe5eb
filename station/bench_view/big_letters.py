# SPDX-License-Identifier: MIT
"""Letters that are read from two metres away, drawn with blocks.

A letter is five dots wide and seven high. Small, a row of the terminal holds two rows
of dots; large, a dot is two columns wide and one row high.
"""

_ROWS, _COLUMNS = 7, 5
SMALL_ROWS, LARGE_ROWS = 4, 7
"""Rows of the terminal that a line of small or of large letters takes."""
_HALVES = {(0, 0): " ", (1, 0): "▀", (0, 1): "▄", (1, 1): "█"}
# Columns of dots from left to right, the lowest bit at the top.
_DOTS = {
    "0": "3E5149453E",
    "1": "00427F4000",
    "2": "4261514946",
    "3": "2141454B31",
    "4": "1814127F10",
    "5": "2745454539",
    "6": "3C4A494930",
    "7": "0171090503",
    "8": "3649494936",
    "9": "064949291E",
    "A": "7E1111117E",
    "B": "7F49494936",
    "C": "3E41414122",
    "D": "7F4141221C",
    "E": "7F49494941",
    "F": "7F09090901",
    "G": "3E4149497A",
    "H": "7F0808087F",
    "I": "00417F4100",
    "J": "2040413F01",
    "K": "7F08142241",
    "L": "7F40404040",
    "M": "7F020C027F",
    "N": "7F0408107F",
    "O": "3E4141413E",
    "P": "7F09090906",
    "Q": "3E4151215E",
    "R": "7F09192946",
    "S": "4649494931",
    "T": "01017F0101",
    "U": "3F4040403F",
    "V": "1F2040201F",
    "W": "3F4038403F",
    "X": "6314081463",
    "Y": "0708700807",
    "Z": "6151494543",
    "a": "2054545478",
    "b": "7F48444438",
    "c": "3844444420",
    "d": "384444487F",
    "e": "3854545418",
    "f": "087E090102",
    "g": "0C5252523E",
    "h": "7F08040478",
    "i": "00447D4000",
    "j": "2040443D00",
    "k": "7F10284400",
    "l": "00417F4000",
    "m": "7C04180478",
    "n": "7C08040478",
    "o": "3844444438",
    "p": "7C14141408",
    "q": "081414187C",
    "r": "7C08040408",
    "s": "4854545420",
    "t": "043F444020",
    "u": "3C4040207C",
    "v": "1C2040201C",
    "w": "3C4030403C",
    "x": "4428102844",
    "y": "0C5050503C",
    "z": "4464544C44",
    "+": "08083E0808",
    "-": "0808080808",
    ".": "0060600000",
    ",": "0050300000",
    ":": "0036360000",
    "/": "2010080402",
    "_": "4040404040",
    "(": "001C224100",
    ")": "0041221C00",
    "?": "0201510906",
    "!": "00005F0000",
    "%": "2313086462",
    " ": "0000000000",
}


def big_width(text: str, *, large: bool) -> int:
    """Return the columns that a text takes in block letters."""
    return len(text) * (_COLUMNS + 1) * (2 if large else 1)


def big_lines(text: str, *, large: bool) -> tuple[str, ...]:
    """Return a text in block letters, line by line; unknown letters are ``?``.

    Args:
        text: of one line.
        large: large letters, else small ones.
    """
    dots = [_row(text, row) for row in range(_ROWS)]
    if large:
        return tuple("".join("██" if dot else "  " for dot in row) for row in dots)
    dots.append([0] * len(dots[0]))
    return tuple(
        "".join(_HALVES[pair] for pair in zip(upper, lower, strict=True))
        for upper, lower in zip(dots[::2], dots[1::2], strict=True)
    )


def _row(text: str, row: int) -> list[int]:
    found = []
    for letter in text:
        columns = bytes.fromhex(_DOTS.get(letter, _DOTS["?"]))
        found += [(column >> row) & 1 for column in columns] + [0]
    return found
