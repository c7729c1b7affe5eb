"""Plain tables of any common layout, and what is no table."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.formats.tables import load_table, read_table

NUMBERS = np.array([[0.0, 1.0, 2.0], [1.5, -2.5e-3, 3.25]])


def rows(separator):
    return "\n".join(f"{a:g}{separator}{b:g}" for a, b in NUMBERS.T) + "\n"


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "   ", "|", ", "])
def test_every_common_separator_is_recognised(tmp_path, separator):
    """Columns come back as rows, to the bit."""
    path = tmp_path / "table.txt"
    path.write_text(rows(separator))
    assert_array_equal(read_table(path), NUMBERS)


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"]
)
def test_every_encoding_is_recognised(tmp_path, encoding):
    """The header holds a micro sign, which distinguishes the encodings."""
    path = tmp_path / "table.csv"
    path.write_bytes(f"time,Weg \u00b5m\r\n{rows(',')}".encode(encoding))
    table = load_table(path)
    assert_array_equal(table.values, NUMBERS)
    assert table.header[0].lstrip("\ufeff") == "time,Weg \u00b5m"


def test_header_lines_with_stray_numbers_are_passed_over(tmp_path):
    """Numbers begin where two lines in a row agree; each row knows its line."""
    path = tmp_path / "table.txt"
    path.write_text(f"Rig 7\n25600\ntime;force\ns;N\n\n{rows(';')}")
    table = load_table(path)
    assert_array_equal(table.values, NUMBERS)
    assert table.where(1) == "line 7"


def test_comments_and_blank_lines_between_the_numbers_are_passed_over(tmp_path):
    """Line numbers still count them."""
    path = tmp_path / "table.txt"
    path.write_text("# a\n0 1\n\n# b\n1 2\n")
    table = load_table(path)
    assert_array_equal(table.values, [[0, 1], [1, 2]])
    assert table.where(1) == "line 5"


def test_empty_cells_and_words_for_no_value_become_nan(tmp_path):
    """A separator at the end of every line makes no column."""
    path = tmp_path / "table.csv"
    path.write_text("0,1,\n1,,\n2,Bad,\n3,4,\n")
    assert_array_equal(read_table(path), [[0, 1, 2, 3], [1, np.nan, np.nan, 4]])


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("0,1\n1,2\n2\n", "line 3", "1 columns"),
        ("0,1\n1,2\n2,x7\n", "line 3", "'x7' is not a number"),
        ("0;1\n1;2,5\n2;3.5\n", "line 3", "has points.*'1;2,5', has commas"),
        ("a;b\n0;1.250,5\n1;1.251,5\n", "line 2", "between thousands"),
        ("0;1\n1;2\n2;3,456\n", "line 3", "part thousands"),
    ],
)
def test_a_bad_row_is_refused_by_its_line(tmp_path, text, line, says):
    """The message names the line and shows the value, on one line."""
    path = tmp_path / "table.csv"
    path.write_text(text)
    with pytest.raises(FormatError, match=f"{line}.*{says}") as caught:
        read_table(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "0,5;-1,5e1\n1,5;2\n",
        "t;F\n0,5;-15\n1,5;2,0\n",
        "a;b\n0,5\t-15,0\n1,5\t2,0\n",
        "0,5 -15\n1,5 2,\n",
        '"0,5","-15"\n"1,5","2,0"\n',
    ],
)
def test_decimal_commas_are_read_where_something_else_parts_columns(tmp_path, text):
    """Semicolon, tab, blanks or quotes, as European programs write tables."""
    path = tmp_path / "table.csv"
    path.write_text(text)
    table = load_table(path)
    assert_array_equal(table.values, [[0.5, 1.5], [-15.0, 2.0]])
    if "t;F" in text:
        assert_array_equal(table.printed_units(0), [0.1, 0.1])


@pytest.mark.parametrize("shape", [(3, 50), (50, 3), (50,)])
def test_an_array_file_is_read_in_either_orientation(tmp_path, shape):
    """The short side holds the columns."""
    path = tmp_path / "table.npy"
    values = np.arange(float(np.prod(shape))).reshape(shape)
    np.save(path, values)
    expected = values if shape == (3, 50) else np.atleast_2d(values.T)
    assert_array_equal(read_table(path), expected)


def test_a_square_array_is_read_by_rows_unless_the_count_says_otherwise(tmp_path):
    """The count distinguishes three rows of two columns from two rows of three."""
    path = tmp_path / "table.npy"
    np.save(path, np.arange(6.0).reshape(3, 2))
    assert read_table(path, columns=3).shape == (3, 2)
    assert read_table(path, columns=2).shape == (2, 3)


def array_of_objects(path):
    np.save(path, np.array([{}, {}], dtype=object), allow_pickle=True)


def array_cut_short(path):
    np.save(path, np.zeros((3, 100)))
    path.write_bytes(path.read_bytes()[:-100])


def array_of_texts(path):
    np.save(path, np.array(["a", "b"]))


def array_of_four_axes(path):
    np.save(path, np.zeros((2, 2, 2, 2)))


def array_claiming_terabytes(path):
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (3, 10**12), }"
    header = header.replace(b"10**12", b"1000000000000")
    header += b" " * (117 - len(header)) + b"\n"
    path.write_bytes(b"\x93NUMPY\x01\x00" + b"\x76\x00" + header + bytes(800))


def array_with_a_broken_header(path):
    np.save(path, np.zeros((3, 100)))
    path.write_bytes(path.read_bytes().replace(b"}", b"{", 1))


def test_an_array_of_objects_is_refused_with_the_remedy(tmp_path):
    """numpy.save wrote it: the remedy is not to save it with numpy.save again."""
    array_of_objects(tmp_path / "table.npy")
    with pytest.raises(FormatError, match=r"Python objects.*array\.astype\(float\)"):
        load_table(tmp_path / "table.npy")


@pytest.mark.parametrize(
    "make",
    [
        array_of_objects,
        array_with_a_broken_header,
        array_cut_short,
        array_of_texts,
        array_of_four_axes,
        array_claiming_terabytes,
    ],
)
def test_an_array_file_that_is_no_table_of_numbers_is_refused(tmp_path, make):
    """Objects would run code; sizes are checked against the file."""
    path = tmp_path / "table.npy"
    make(path)
    with pytest.raises(FormatError) as caught:
        read_table(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"no numbers\nhere\n",
        b"\x00\x01\x02\xff" * 500,
        b"PK\x03\x04" + bytes(range(256)) * 8,
        b"1,2\n\x81\x8d\n",
        b"\xff\xfe\x00\xd8\x31",
    ],
)
def test_what_is_no_table_is_refused_in_one_line(tmp_path, data):
    """Empty files, prose and binary junk."""
    path = tmp_path / "junk.txt"
    path.write_bytes(data)
    with pytest.raises(FormatError) as caught:
        read_table(path)
    assert "\n" not in str(caught.value)


def test_an_endless_line_is_refused(tmp_path):
    """Two million digits without a line end are no table."""
    path = tmp_path / "line.txt"
    path.write_bytes(b"1" * 2_000_000)
    with pytest.raises(HostileFile, match="line 1 has 2000000 characters"):
        read_table(path)


def test_a_file_too_large_for_text_is_refused_unread(tmp_path):
    """A sparse file of a gigabyte costs nothing to make, nor to refuse."""
    path = tmp_path / "large.txt"
    with path.open("wb") as file:
        file.truncate(2**30)
    with pytest.raises(HostileFile, match="1073741824 bytes"):
        read_table(path)


def test_what_is_no_file_is_refused(tmp_path):
    """No such file, a folder, and a device that would never end."""
    for path in (tmp_path / "none.txt", tmp_path, "/dev/zero", "a\0b"):
        with pytest.raises(BadData) as caught:
            read_table(path)
        assert "\n" not in str(caught.value)


def test_an_hdf5_file_is_called_by_its_name(tmp_path):
    """And sent where it can be read."""
    path = tmp_path / "s.h5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(500))
    with pytest.raises(FormatError, match=r"is an HDF5 file.*'jointbench modal'"):
        read_table(path)


@pytest.mark.parametrize("kind", ["%.4f", "%.4e"])
def test_a_number_cut_at_the_end_of_the_file_is_refused(tmp_path, kind):
    """A cut number is a number; a last row without a line end may be whole."""
    path = tmp_path / "table.csv"
    np.savetxt(path, np.arange(60.0).reshape(20, 3) / 7, fmt=kind, delimiter=";")
    whole = path.read_text()
    path.write_text(whole.rstrip("\n"))
    assert read_table(path).shape == (3, 20)
    path.write_text(whole[:-2])
    with pytest.raises(FormatError, match="the file is cut short"):
        read_table(path)


def test_a_short_last_number_of_a_column_without_fixed_digits_is_read(tmp_path):
    """Programs that leave zeros out print 2 beside 1.25."""
    path = tmp_path / "table.csv"
    path.write_text("0,1.25\n1,1.5\n2,1.125\n3,2")
    assert_array_equal(read_table(path)[1], [1.25, 1.5, 1.125, 2.0])
