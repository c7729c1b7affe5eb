"""HDF5 files that hold next to nothing and claim much."""

from pathlib import Path

import h5py
import numpy as np

from jointbench.station.results.result_rows import PROCESSED_SCHEMA


def session(path: Path, *, shape: tuple[int, ...], dtype: str, chunks=None) -> None:
    """Write what a session reader opens: one recording that unpacks to much."""
    from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
    from jointbench.acquisition.records.session import Session
    from jointbench.acquisition.session_file.store import write_session

    rows = np.zeros((2, 64))
    channels = (
        Channel("force", Quantity.FORCE, "1", unit="N"),
        Channel("a1", Quantity.ACCELERATION, "2", "+z", unit="g"),
    )
    one = Recording("r", rows, 1e3, channels)
    write_session(Session("u", "2025", "j", True, recordings=(one,)), path)
    with h5py.File(path, "a") as file:
        del file["stream/r/samples"]
        file.create_dataset(
            "stream/r/samples",
            shape=shape,
            dtype=dtype,
            chunks=chunks or (1, min(2**20, shape[1])),
            compression="gzip",
            shuffle=True,
        )[...] = 0


def bomb(path: Path, scale: float) -> None:
    """Bytes that become doubles, 62 in memory for one in the file."""
    session(path, shape=(2, int(60e6 * scale)), dtype="i1")
    pad(path, int(120e6 * scale / 62))


def results_json(path: Path, scale: float) -> None:
    """Write a recipe of nothing but empty lists."""
    data = np.frombuffer(b"[" + b"[]," * int(20e6 * scale) + b"[]]", "S1")
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = PROCESSED_SCHEMA
        file.create_group("stages")
        file.create_dataset(
            "recipe/text", data=data[None, :], compression="gzip", chunks=True
        )


def pad(path: Path, size: int) -> None:
    """Add what does not pack."""
    with h5py.File(path, "a") as file:
        file.create_dataset("pad", data=np.random.default_rng(1).bytes(1), dtype="S1")
        values = np.random.default_rng(1).integers(0, 255, max(1, size), np.uint8)
        file.create_dataset("stream/pad", data=values)


def many_chunks(path: Path, scale: float) -> None:
    """Write a session of a chunk for each sample."""
    session(path, shape=(2, int(29_000 * scale)), dtype="i1", chunks=(1, 1))


def many_groups(path: Path, scale: float) -> None:
    """Write nothing but groups and attributes."""
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "jointbench-session/1"
        for i in range(int(19_000 * scale)):
            group = file.create_group(f"stream/{i}")
            for j in range(20):
                group.attrs[f"a{j}"] = j


def rattlesnake(path: Path, scale: float) -> None:
    """Write a stream of a chunk for each sample."""
    count = int(500_000 * scale)
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = 1e4
        data = file.create_dataset(
            "time_data",
            shape=(1, count),
            maxshape=(1, None),
            chunks=(1, 1),
            dtype="<f8",
        )
        data[...] = 1.0
        table = file.create_group("channels")
        for name, text in (
            ("node_number", "1"),
            ("node_direction", "Z+"),
            ("unit", "N"),
        ):
            kind = h5py.string_dtype()
            table.create_dataset(name, data=np.array([text], dtype=object), dtype=kind)


def campaign(path: Path, scale: float) -> None:
    """Records that hold next to nothing and claim much."""
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "two-body-campaign/1"
        file.attrs["fs_hz"] = 1e4
        for i in range(64):
            group = file.create_group(f"records/{i:03d}")
            size = int(1e6 * scale)
            for name, shape in (("force", (size,)), ("accel", (2, size))):
                group.create_dataset(
                    name,
                    shape=shape,
                    dtype="i1",
                    chunks=(1, size)[-len(shape) :],
                    compression="gzip",
                )[...] = 1
        file.create_dataset(
            "pad",
            data=np.random.default_rng(1).integers(0, 255, int(4e6 * scale), np.uint8),
        )
