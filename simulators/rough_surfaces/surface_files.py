# SPDX-License-Identifier: MIT
"""Write simulated surfaces in the file formats of instruments, quirks included."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.heights.keyence_labels import LANGUAGES, MARK
from jointbench.acquisition.records.surfaces import Areal, Profile

DATE = "2025-03-21 11:43:55"
"""Default date of simulated maps."""
ENCODINGS = {
    "English": "utf-8-sig",
    "German": "cp1252",
    "Japanese": "cp932",
    "Chinese": "gb18030",
}
_MICROMETRE = {
    "English": "um",
    "German": "\u00b5m",
    "Japanese": "\u03bcm",
    "Chinese": "\u03bcm",
}
_FIXED = {
    "English": ("Data type\n", "File version", "Reference data name"),
    "German": ("Dateityp", "Dateiversion", "Referenzdatenname"),
    "Japanese": ("ファイル種別", "ファイル バージョン", "参照データ名"),
    "Chinese": ("文件类型", "文件版本", "基准数据名称"),
}


def write_keyence_csv(
    areal: Areal,
    path: Path,
    *,
    date: str = DATE,
    language: str = "English",
    delimiter: str = ",",
) -> None:
    """Write a map as the height CSV of Keyence's MultiFileAnalyzer.

    The quirks are essential: every cell quoted, CRLF, the encoding of the language (in
        English a byte-order mark, and a line break in the cell "Data type"),
    heights in um, missing points as empty cells.

    Args:
        areal: the map; one spacing for both directions.
        path: file to write.
        date: as the header states it.
        language: of the analyser: English, German, Japanese or Chinese.
        delimiter: ``","`` or ``";"``.

    Raises:
        UsageError: the spacing differs between the directions, or no such language.

    Source:
        Layout reconstructed from public parsers of these exports.
    """
    if not np.isclose(areal.spacing[0], areal.spacing[1], rtol=1e-9):
        raise UsageError(
            f"spacing is {areal.spacing} m; this format holds one XY calibration, "
            "resample to square pixels first"
        )
    if language not in ENCODINGS:
        raise UsageError(f"language {language!r}: give one of {', '.join(ENCODINGS)}")
    rows = [*_keyence_header(areal, date, language), *_keyence_rows(areal)]
    lines = [delimiter.join(f'"{cell}"' for cell in cells) for cells in rows]
    text = "\r\n".join(lines) + "\r\n"
    path.write_bytes(text.encode(ENCODINGS[language]))


def _keyence_header(areal: Areal, date: str, language: str) -> list[tuple[str, ...]]:
    """Return the header down to the row "Height"."""
    spoken = next(one for one in LANGUAGES if one.name == language)
    word = {meaning: words[0] for meaning, words in spoken.words.items()}
    kind, version, reference = _FIXED[language]
    seen = areal.heights[areal.valid] * 1e6
    rows, columns = areal.heights.shape
    return [
        (word["measured"], date),
        (word["model"], "VK-X3000 Series"),
        (kind, MARK),
        (version, "1000"),
        (word["data_name"], areal.name),
        (word["objective_lens_power"], "50"),
        (word["calibration"], f"{areal.spacing[1] * 1e9:.3f}", "nm"),
        (word["output"], spoken.height),
        (word["columns"], str(columns)),
        (word["rows"], str(rows)),
        (word["least"], f"{seen.min():.4f}"),
        (word["most"], f"{seen.max():.4f}"),
        (word["unit"], _MICROMETRE[language]),
        (reference, ""),
        (),
        (spoken.height,),
    ]


def _keyence_rows(areal: Areal) -> list[tuple[str, ...]]:
    """Return the cells of the heights [um], empty where a point is missing."""
    return [
        tuple(
            f"{height:.4f}" if there else ""
            for height, there in zip(row.tolist(), mask.tolist(), strict=True)
        )
        for row, mask in zip(areal.heights * 1e6, areal.valid, strict=True)
    ]


def write_surfcom(profile: Profile, path: Path) -> None:
    """Write a profile as Surfcom text: length [mm], points, one height [um] per line.

    Args:
        profile: without gaps; the format has no code for them.
        path: file to write, named ``.tx1``.
    """
    head = [f"{profile.length * 1e3:.5f}", str(profile.heights.size)]
    heights = [f"{z:.4f}" for z in (profile.heights * 1e6).tolist()]
    path.write_text("\r\n".join([*head, *heights, ""]), encoding="ascii", newline="")


def write_dektak(profile: Profile, path: Path, *, stylus_radius: float) -> None:
    """Write a profile as Dektak CSV: cp1252, x rounded to 0.1 um.

    Args:
        profile: without gaps.
        path: file to write.
        stylus_radius: [m].
    """
    lines = [
        "Scan Parameters",
        "Scan Type,Standard Scan",
        f"Stylus,Radius: {stylus_radius * 1e6:.1f} µm",
        f"Length,{profile.length * 1e6:.1f} um",
        f"Resolution,{profile.spacing * 1e6:.3f} um/sample",
        "",
        "Scan Data",
        "Lateral um,Raw Micrometer,",
    ]
    x = np.arange(profile.heights.size) * profile.spacing * 1e6
    pairs = zip(x.tolist(), (profile.heights * 1e6).tolist(), strict=True)
    lines += [f"{place:.1f},{z:.5f},," for place, z in pairs]
    path.write_bytes(("\r\n".join(lines) + "\r\n").encode("cp1252"))


def write_wyko(areal: Areal, path: Path) -> None:
    """Write a map as Wyko ASCII in nanometres; missing points are "Bad".

    Args:
        areal: the map.
        path: file to write.
    """
    rows, columns = areal.heights.shape
    aspect = areal.spacing[1] / areal.spacing[0]
    lines = [
        "Wyko ASCII Data File Format 0\t1\t1",
        f"X Size\t{rows}",
        f"Y Size\t{columns}",
        "Block Name\tType\tLength\tValue",
        f"Pixel_size\t7\t4\t{areal.spacing[0] * 1e3:.9g}",
        f"Aspect\t7\t4\t{aspect:.9g}",
        "RAW_DATA\t3\t0\t",
    ]
    for heights, there in zip(areal.heights * 1e9, areal.valid, strict=True):
        cells = zip(heights.tolist(), there.tolist(), strict=True)
        lines.append("\t".join(f"{z:.4f}" if ok else "Bad" for z, ok in cells))
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def write_utf16_table(profile: Profile, path: Path) -> None:
    """Write x and z [um] as a UTF-16 table with units above its columns.

    Args:
        profile: the profile; missing heights are left empty.
        path: file to write.
    """
    lines = ["index,x in µm,y in µm"]
    for i, (z, there) in enumerate(
        zip((profile.heights * 1e6).tolist(), profile.valid.tolist(), strict=True)
    ):
        place = i * profile.spacing * 1e6
        lines.append(f"{i},{place!r},{z!r}" if there else f"{i},{place!r},")
    path.write_bytes(("\r\n".join(lines) + "\r\n").encode("utf-16"))
