"""Files that cost their reader time and memory, each with the reader concerned."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from costly_formats import (
    array,
    entities,
    mat_bomb,
    mat_cells,
    mat_many,
    tdms_channels,
    tdms_segments,
    uff_edges,
    uff_sets,
    uff_values,
    wave,
    wave_long,
    zipped,
)
from costly_hdf5 import (
    bomb,
    campaign,
    many_chunks,
    many_groups,
    rattlesnake,
    results_json,
)
from costly_text import (
    array_tables,
    dots,
    dotted_header,
    dotted_lines,
    gwyddion,
    inline_dots,
    inp,
    keyence,
    ledger_deep,
    ledger_many,
    mtx_array,
    mtx_claim,
    numbers,
    repeated,
    surfcom,
)
from foreign_readers import READERS


@dataclass(frozen=True, slots=True)
class CostlyFile:
    """A file and who reads it.

    Attributes:
        reader: its name in `READERS`.
        words: what is costly.
        name: of the file.
        make: writes it, at a share of its size.
    """

    reader: str
    words: str
    name: str
    make: Callable[[Path, float], object]


FILES = (
    *(
        CostlyFile(reader, words, "m.toml", make)
        for reader in READERS
        if reader.startswith("TOML")
        for words, make in (
            ("one key of 50,000 parts", dots),
            ("one table of 50,000 parts", dotted_header),
            ("1,100 keys of 400 parts", dotted_lines),
            ("inline key of 50,000 parts", inline_dots),
            ("80,000 tables in arrays", array_tables),
            ("brackets inside brackets", repeated(b"[", 9e5, head=b"a = ")),
            ("one number of 900,000 digits", repeated(b"1", 9e5, head=b"a = ")),
        )
        if reader == "TOML: bench model" or make in (dots, dotted_lines)
    ),
    CostlyFile("ledger", "brackets inside brackets", "l.jsonl", ledger_deep),
    CostlyFile("ledger", "20 million lines", "l.jsonl", ledger_many),
    CostlyFile("hits", "240 MB of numbers", "h.csv", numbers(240e6, columns=3)),
    CostlyFile("hits", "100 MB of numbers", "h.csv", numbers(110e6, columns=3)),
    CostlyFile(
        "hits", "100 MB, gaps all over", "h.csv", numbers(110e6, columns=3, gap=" ")
    ),
    CostlyFile(
        "hits",
        "100 MB with words for gaps",
        "h.csv",
        numbers(110e6, columns=3, gap="nan,"),
    ),
    CostlyFile("hits", "60 MB of short lines", "h.csv", repeated(b"1\n", 60e6)),
    CostlyFile("hits", "99 MB of short rows", "h.csv", repeated(b"1,1,1\n", 99e6)),
    CostlyFile("hits", "99 MB in one line", "h.csv", repeated(b"1,", 99e6)),
    CostlyFile("hits", "99 MB of empty lines", "h.csv", repeated(b"\n", 99e6)),
    CostlyFile("hits", "99 MB of comments", "h.csv", repeated(b"#\n", 99e6)),
    CostlyFile(
        "hits",
        "99 MB, one wide letter",
        "h.csv",
        repeated(b"0,1.5,1\n", 99e6, head="\U0001f600\n".encode()),
    ),
    CostlyFile(
        "hits", "99 MB of decimal commas", "h.csv", repeated(b"0,1;1,5;1,25\n", 99e6)
    ),
    CostlyFile(
        "hits", "99 MB of quotes", "h.csv", repeated(b'"0.1","1.5","1"\n', 99e6)
    ),
    CostlyFile(
        "hits",
        "512 columns of gaps",
        "h.csv",
        repeated(b"1," + b"," * 510 + b"\n", 99e6),
    ),
    CostlyFile(
        "hits, units of the file",
        "header of a million brackets",
        "h.csv",
        repeated(b"a [", 1e6, tail=b"\n1,2,3\n2,3,4\n"),
    ),
    CostlyFile(
        "hits",
        "100 million small numbers, .npy",
        "h.npy",
        lambda p, s: array(p, 1e8 * s, "i1"),
    ),
    CostlyFile(
        "hits",
        "60 million doubles, .npy",
        "h.npy",
        lambda p, s: array(p, 6e7 * s, "f8"),
    ),
    CostlyFile("heights alone", "one column", "z.csv", repeated(b"1.25\n", 99e6)),
    CostlyFile(
        "heights x, y, z", "points of no grid", "z.csv", numbers(110e6, columns=3)
    ),
    CostlyFile(
        "heights x, z",
        "100 million small numbers, .npy",
        "z.npy",
        lambda p, s: array(p, 1e8 * s, "i1", 2),
    ),
    CostlyFile("heights", "Keyence image of single digits", "k.csv", keyence),
    CostlyFile("heights", "Gwyddion text of single digits", "g.txt", gwyddion),
    CostlyFile("heights", "Surfcom of single digits", "s.tx1", surfcom),
    CostlyFile(
        "heights",
        "Mahr of single digits",
        "m.txt",
        repeated(b"1\n", 60e6, head=b"RES 0.1\n"),
    ),
    CostlyFile("heights", "X3P that unpacks to 2 GB", "z.x3p", zipped),
    CostlyFile("heights", "XLSX that unpacks to 2 GB", "z.xlsx", zipped),
    CostlyFile("heights", "X3P of a billion entities", "e.x3p", entities),
    CostlyFile(
        "heights",
        "SDF of short lines",
        "s.sdf",
        repeated(b"1\n", 60e6, head=b"aISO-1.0\n"),
    ),
    CostlyFile("session", "bytes that become doubles", "s.h5", bomb),
    CostlyFile("inspect", "bytes that become doubles", "s.h5", bomb),
    CostlyFile("verify", "bytes that become doubles", "s.h5", bomb),
    CostlyFile("session", "as many chunks as are read", "s.h5", many_chunks),
    CostlyFile("inspect", "19,000 groups of 20 attributes", "s.h5", many_groups),
    CostlyFile(
        "results", "19,000 groups of 20 attributes", "r.results.h5", many_groups
    ),
    CostlyFile("results", "a recipe of empty lists", "r.results.h5", results_json),
    CostlyFile("campaign", "bytes that become doubles", "c.h5", campaign),
    CostlyFile("Rattlesnake", "500,000 chunks", "r.nc4", rattlesnake),
    CostlyFile("MAT", "100,000 variables", "m.mat", mat_many),
    CostlyFile("MAT", "zeros, packed", "m.mat", mat_bomb),
    CostlyFile("MAT", "900,000 cells, packed", "m.mat", mat_cells),
    CostlyFile("universal", "10,000 data sets", "u.uff", uff_sets),
    CostlyFile("universal", "10 million values as text", "u.uff", uff_values),
    CostlyFile("universal", "4 million edges", "u.uff", uff_edges),
    CostlyFile("TDMS", "100,000 segments", "t.tdms", tdms_segments),
    CostlyFile("TDMS", "50,000 channels", "t.tdms", tdms_channels),
    CostlyFile("WAV", "8 million chunks", "w.wav", wave),
    CostlyFile("WAV", "100 million samples of a byte", "w.wav", wave_long),
    CostlyFile("matrix", "claims 1e9 rows", "k.mtx", mtx_claim),
    CostlyFile("matrix", "claims a full matrix", "k.mtx", mtx_array),
    CostlyFile("mesh", "2 million nodes, Abaqus", "m.inp", inp),
    CostlyFile(
        "mesh",
        "one line, gmsh",
        "m.msh",
        repeated(b"$Nodes ", 60e6, head=b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"),
    ),
)
