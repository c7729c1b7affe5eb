"""Wrong arguments of the library, and contact of surfaces without a fractal law."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import jointbench as jb
from jointbench.acquisition.basics.errors import BadData, UsageError

STEEL = {"modulus": "29 GPa", "hardness": "1.5 GPa"}


def test_what_names_no_file_is_refused() -> None:
    """Numbers, None, and empty lists."""
    for wrong in (None, 3, [3], b"x", []):
        with pytest.raises(UsageError, match="no file"):
            jb.open(wrong)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="no file"):
        jb.gap([])


def test_names_and_files_of_another_kind_are_refused(tmp_path: Path) -> None:
    """An example that is no name, hits as a surface, an archive without results."""
    for wrong in (None, 3):
        with pytest.raises(UsageError, match="no example is called"):
            jb.example(wrong)  # type: ignore[arg-type]
    hits = tmp_path / "hit.csv"
    lines = [f"{k / 1000},{k % 7},{k % 5}\n" for k in range(64)]
    hits.write_text("time [s],force [N],acceleration [m/s^2]\n" + "".join(lines))
    with pytest.raises(UsageError, match="holds no surface; give a file of heights"):
        jb.surface(hits)
    with pytest.raises(UsageError, match="hits go into a session"):
        jb.gap(hits)
    with pytest.raises(UsageError, match="'jointbench reprocess' writes results"):
        jb.archive(tmp_path)


def test_files_that_say_too_little_name_the_remedy(tmp_path: Path) -> None:
    """Empty files of every format, and samples without times."""
    for name in ("a.mat", "a.wav", "a.npy", "a.csv"):
        (tmp_path / name).touch()
        with pytest.raises(BadData, match="export it again"):
            jb.open(tmp_path / name, columns="time.t:s,force.F:N")
    np.save(tmp_path / "b.npy", np.zeros((3, 2, 64)))
    with pytest.raises(UsageError, match=r"names no times of .*give the rate"):
        jb.open(tmp_path / "b.npy", columns="force:N,acceleration:g")


def test_arguments_of_another_type_are_refused_in_one_line(tmp_path: Path) -> None:
    """Of every function: what is wanted, not what Python could not do."""
    bench = tmp_path / "bench.toml"
    bench.write_text(
        '[bodies.a]\nmass = "1 kg"\n[links.b]\nbetween = ["ground", "a"]\n'
    )
    there = tmp_path / "s.h5"
    there.touch()
    wrong: list[Callable[[], object]] = [
        lambda: jb.identify(None),  # type: ignore[arg-type]
        lambda: jb.identify(bench, band=3),  # type: ignore[arg-type]
        lambda: jb.identify(bench, surface=None),  # type: ignore[arg-type]
        lambda: jb.machine(None),  # type: ignore[arg-type]
        lambda: jb.process(None),  # type: ignore[arg-type]
        lambda: jb.process(there, 3),  # type: ignore[arg-type]
        lambda: jb.report(None),  # type: ignore[arg-type]
        lambda: jb.report(there, out=3),  # type: ignore[arg-type]
        lambda: jb.archive(None),  # type: ignore[arg-type]
        lambda: jb.archive([None]),  # type: ignore[arg-type]
        lambda: jb.record(None, there),  # type: ignore[arg-type]
        lambda: jb.record("sim:two-body?seed=1", None),  # type: ignore[arg-type]
        lambda: jb.gap(there, model=3),  # type: ignore[arg-type]
        lambda: jb.gap(there, preload=3),  # type: ignore[arg-type]
        lambda: jb.gap(there, effects=None),  # type: ignore[arg-type]
        lambda: jb.modes(there, band=3),  # type: ignore[arg-type]
        lambda: jb.modes(there, keep=None),  # type: ignore[arg-type]
        lambda: jb.open(there, rate=[]),  # type: ignore[arg-type]
        lambda: jb.open(there, columns=3),  # type: ignore[arg-type]
    ]
    for call in wrong:
        with pytest.raises(UsageError, match="give "):
            call()
    with pytest.raises(UsageError, match="overwrite=True replaces it"):
        jb.record("sim:two-body?seed=1", there)
    with pytest.raises(UsageError, match="needs sessions, hits or FRFs"):
        jb.identify(bench)


def test_quantities_without_unit_are_refused() -> None:
    """A bare number names its argument."""
    with pytest.raises(UsageError, match="load is 1000"):
        jb.contact(**STEEL, load=1000)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="roughness is 1e-09"):
        jb.contact(**STEEL, load="1 kN", dimension=1.5, roughness=1e-9)
    with pytest.raises(UsageError, match="no option colour"):
        jb.contact(**STEEL, load="1 kN", colour=1)


def test_a_short_profile_has_the_laws_of_its_spectrum(tmp_path: Path) -> None:
    """No fractal law applies to 64 points; measured laws have rows."""
    rng = np.random.default_rng(3)
    heights = np.cumsum(rng.standard_normal(64)) * 0.1
    path = tmp_path / "line.csv"
    path.write_text(
        "".join(f"{k},{z:.6f}\n" for k, z in enumerate(heights)), encoding="utf-8"
    )
    found = jb.contact(
        **STEEL,
        surface=path,
        columns="x:um,z:um",
        nominal_area=1e-4,
        load=["100 N", "1 kN"],
    )
    assert not found.points
    assert found.measured is not None
    assert "persson" in str(found)
    assert "<svg" in found.view.html()
    data = pytest.importorskip("xarray") and found.to_xarray()
    ours = data.normal_stiffness.values[data.law.values == "persson"]
    curve = next(one for one in found.measured.at if one.law == "persson")
    np.testing.assert_allclose(ours, curve.stiffness * 1e-4)
