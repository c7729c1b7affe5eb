# SPDX-License-Identifier: MIT
"""Reduced bodies and models on disk, named by a hash of their input."""

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.file_access.array_cache import (
    Arrays,
    read_arrays,
    write_arrays,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    BodyPort,
    BodySource,
    Component,
    Residual,
)
from jointbench.analysis.structures.reduction.joint_spread import JointSpread
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.analysis.structures.reduction.residual_norm import (
    JointMotion,
    ResidualNorm,
)

# Incremented when the reduction changes, so that old files are not used.
CACHE_VERSION = 5
"""Of the files: part of every key."""
_COMPONENT = ("stiffness", "loss", "damping", "basis")
_MODEL = ("stiffness", "loss", "damping", "strains")


def content_key(structure: Structure, *options: object) -> str:
    """Return the SHA-256 of the matrices of a structure and of options."""
    digest = hashlib.sha256(repr((CACHE_VERSION, structure.joints)).encode())
    for one in options:
        digest.update(
            one.tobytes() if isinstance(one, np.ndarray) else repr(one).encode()
        )
    for matrix in (
        structure.stiffness,
        structure.mass,
        structure.loss,
        structure.glue,
        *structure.spread,
    ):
        _add(digest, matrix)
    return digest.hexdigest()


def body_key(body: BodyMatrices, ports: list[BodyPort], *options: object) -> str:
    """Return the SHA-256 of a body, its ports and options of its reduction."""
    text = (CACHE_VERSION, body.name, body.loss_factor, str(body.source), options)
    digest = hashlib.sha256(repr(text).encode())
    for matrix in (body.stiffness, body.mass, body.loss):
        if matrix is not None:
            _add(digest, matrix)
    for port in ports:
        digest.update(port.name.encode())
        _add(digest, port.rows)
        digest.update(np.ascontiguousarray(port.patterns).tobytes())
    return digest.hexdigest()


def _add(digest: Any, matrix: Sparse) -> None:
    """Add a matrix by its product with a random vector, which any change changes."""
    probe = np.random.default_rng(0).standard_normal(matrix.shape[1])
    digest.update(repr(matrix.shape).encode())
    digest.update(np.asarray(matrix @ probe).tobytes())


def cached_bodies(
    folder: Path | None, key: str, make: Callable[[], Sequence[Component]]
) -> list[Component]:
    """Return the reduced bodies of a key from disk, or create and store them.

    Args:
        folder: of the cache; None stores nothing.
        key: of `content_key`.
        make: creates the bodies if they are not stored.
    """
    found = read_arrays(folder, key)
    if found is not None:
        return [component_of(f"body{at}.", found) for at in range(int(found["count"]))]
    bodies = make()
    arrays: Arrays = {"count": np.array(len(bodies))}
    for at, body in enumerate(bodies):
        arrays |= component_arrays(f"body{at}.", body)
    write_arrays(folder, key, arrays)
    return list(bodies)


def cached_component(
    folder: Path | None, key: str, make: Callable[[], Component]
) -> Component:
    """Return the reduced body of a key from disk, or create and store it.

    Args:
        folder: of the cache; None stores nothing.
        key: of `body_key`.
        make: creates the body if it is not stored.
    """
    found = read_arrays(folder, key)
    if found is not None:
        return component_of("", found)
    body = make()
    write_arrays(folder, key, component_arrays("", body))
    return body


def cached(
    folder: Path | None, key: str, make: Callable[[], ReducedModel]
) -> ReducedModel:
    """Return the reduced model of a key from disk, or create and store it.

    Args:
        folder: of the cache; None stores nothing.
        key: of `content_key`.
        make: creates the model if it is not stored.

    Returns:
        The reduced model.
    """
    found = read_arrays(folder, key)
    if found is not None:
        return _model(found)
    model = make()
    write_arrays(folder, key, _model_arrays(model))
    return model


def component_arrays(start: str, body: Component) -> Arrays:
    """Return the arrays of a body; names begin with `start`."""
    found = {start + name: getattr(body, name) for name in _COMPONENT}
    facts = {
        "name": body.name,
        "rigid": body.rigid,
        "source": str(body.source),
        "loss_factor": body.loss_factor,
        "error_bound": body.error_bound,
        "rows": list(body.rows),
        "shift": None if body.residual is None else body.residual.shift,
        "ports": [] if body.residual is None else list(body.residual.patterns),
    }
    found[start + "facts"] = np.array(json.dumps(facts))
    for at, rows in enumerate(body.rows.values()):
        found[f"{start}rows{at}"] = rows
    if body.residual is not None:
        found[start + "root"] = body.residual.root
        found[start + "compliance"] = np.array(list(body.residual.compliance.values()))
        for at, pattern in enumerate(body.residual.patterns.values()):
            found[f"{start}pattern{at}"] = pattern
    return found


def component_of(start: str, arrays: Arrays) -> Component:
    """Return the body whose arrays have names that begin with `start`."""
    facts = json.loads(str(arrays[start + "facts"]))
    residual = None
    if facts["shift"] is not None:
        compliance = arrays[start + "compliance"].tolist()
        residual = Residual(
            arrays[start + "root"],
            {p: arrays[f"{start}pattern{at}"] for at, p in enumerate(facts["ports"])},
            dict(zip(facts["ports"], compliance, strict=True)),
            facts["shift"],
        )
    return Component(
        **{name: arrays[start + name] for name in _COMPONENT},
        name=facts["name"],
        rows={p: arrays[f"{start}rows{at}"] for at, p in enumerate(facts["rows"])},
        rigid=facts["rigid"],
        source=BodySource(facts["source"]),
        residual=residual,
        loss_factor=facts["loss_factor"],
        error_bound=facts["error_bound"],
    )


def _model_arrays(model: ReducedModel) -> Arrays:
    residual = model.residual
    facts = {
        "shift": model.shift,
        "box": list(model.box),
        "modes": model.modes,
        "names": list(model.names),
        "bodies": len(residual.components),
        "groups": len(model.spread.columns),
        "size": model.spread.size,
        "joints": [
            [joint.compliance, [[b, c.start, c.stop, s] for b, c, s in joint.loads]]
            for joint in residual.joints
        ],
    }
    found = {name: getattr(model, name) for name in _MODEL}
    found |= {"facts": np.array(json.dumps(facts)), "turn": residual.turn}
    for at, (body, place) in enumerate(
        zip(residual.components, residual.places, strict=True)
    ):
        found |= component_arrays(f"body{at}.", body)
        found[f"place{at}"] = place
    for at, joint in enumerate(residual.joints):
        found |= {
            f"columns{at}": joint.columns,
            f"moments{at}": joint.moments,
            f"rest{at}": joint.rest,
        }
    for at, (columns, block) in enumerate(
        zip(model.spread.columns, model.spread.blocks, strict=True)
    ):
        found |= {f"spread_columns{at}": columns, f"spread{at}": block}
    for name in ("guess", "fixed_strain"):
        if getattr(model, name) is not None:
            found[name] = getattr(model, name)
    return found


def _model(arrays: Arrays) -> ReducedModel:
    facts = json.loads(str(arrays["facts"]))
    joints = [
        JointMotion(
            arrays[f"columns{at}"],
            arrays[f"moments{at}"],
            arrays[f"rest{at}"],
            compliance,
            tuple((b, slice(low, high), sign) for b, low, high, sign in loads),
        )
        for at, (compliance, loads) in enumerate(facts["joints"])
    ]
    bodies, groups = range(facts["bodies"]), range(facts["groups"])
    residual = ResidualNorm(
        tuple(component_of(f"body{at}.", arrays) for at in bodies),
        tuple(arrays[f"place{at}"] for at in bodies),
        tuple(joints),
        arrays["turn"],
    )
    spread = JointSpread(
        facts["size"],
        tuple(arrays[f"spread_columns{at}"] for at in groups),
        tuple(arrays[f"spread{at}"] for at in groups),
    )
    low, high = facts["box"]
    return ReducedModel(
        **{name: arrays[name] for name in _MODEL},
        spread=spread,
        residual=residual,
        shift=facts["shift"],
        box=(low, high),
        modes=facts["modes"],
        names=tuple(facts["names"]),
        guess=arrays.get("guess"),
        fixed_strain=arrays.get("fixed_strain"),
    )
