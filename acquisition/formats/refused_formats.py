# SPDX-License-Identifier: MIT
"""Files that are known and not read, each with the way out."""

import re
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.tables import read_head

_PICKLE = re.compile(rb"\x80[\x02-\x05](?:\x95|[\]\}cq(]|.q)", re.DOTALL)
_PICKLES = (".pkl", ".pickle", ".p", ".dill", ".joblib")
_EXPORT = "export it as a universal file (data set 58), as MAT, or as a table of text"
_WAYS = {
    ".xlsx": "is a workbook of Excel; save the table as .csv",
    ".xls": "is a workbook of Excel; save the table as .csv",
    ".ods": "is a spreadsheet; save the table as .csv",
    ".parquet": "is a Parquet table; save it as .csv or .npz",
    ".feather": "is a Feather table; save it as .csv or .npz",
    ".dxd": f"is a recording of Dewesoft; {_EXPORT}",
    ".d7d": f"is a recording of Dewesoft; {_EXPORT}",
    ".svd": f"is a file of Polytec; {_EXPORT}",
    ".pvd": f"is a file of Polytec; {_EXPORT}",
    ".lms": f"is a project of Simcenter Testlab; {_EXPORT}",
    ".vtprj": f"is a project of ME'scope; {_EXPORT}",
    ".ati": f"is a file of LMS; {_EXPORT}",
    ".sie": f"is a file of SoMat; {_EXPORT}",
    ".rpc": f"is a file of RPC III; {_EXPORT}",
}


def refuse_known(path: Path) -> None:
    """Refuse a file whose format is known and not read.

    Args:
        path: of any file.

    Raises:
        FormatError: the message has the way out. A pickle runs code when it is read,
            and so is never opened.
    """
    suffix = path.suffix.lower()
    try:
        pickled = _PICKLE.match(read_head(path, 8)) is not None
    except BadData:
        return  # the reader reports what is wrong
    if pickled or suffix in _PICKLES:
        raise FormatError(
            f"{named(path)} is a Python pickle, as LDAQ saves; reading one runs code, "
            "so it is never opened: where it was made, type m = "
            f"LDAQ.load_measurement({path.name!r})['SOURCE']; numpy.savez("
            f"{path.stem + '.npz'!r}, time=m['time'], **dict(zip(m['channel_names'], "
            "m['data'].T))), and import the .npz"
        )
    if suffix in _WAYS:
        raise FormatError(f"{named(path)} {_WAYS[suffix]}")
