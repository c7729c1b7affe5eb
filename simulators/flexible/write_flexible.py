# SPDX-License-Identifier: MIT
"""Campaigns on flexible specimens as files: hits, nominal values and truth."""

import json
from pathlib import Path

import h5py
import numpy as np

from jointbench.simulators.flexible.flexible_bench import FlexibleBench
from jointbench.simulators.flexible.flexible_campaign import FlexibleCampaign
from jointbench.simulators.flexible.flexible_effects import (
    FLEXIBLE_OUTSIDE,
    FlexibleEffect,
)
from jointbench.simulators.flexible.flexible_specimen import BodyPlace, ElasticBody
from jointbench.simulators.flexible.hidden_in_joint import named_place
from jointbench.simulators.flexible.hit_plan import AIM_SIGMA, TILT_SIGMA
from jointbench.simulators.flexible.hit_records import PRETRIGGER, SAMPLE_RATE
from jointbench.simulators.flexible.joint_values import (
    BOLT_SIGMA,
    DAMPING_SIGMA,
    FEET_SIGMA,
    MODULUS_SIGMA,
    STIFFNESS_SIGMA,
)
from jointbench.simulators.flexible.physical_bodies import (
    FREQUENCY_ERRORS,
    SHAPE_ERROR,
    PhysicalBody,
)
from jointbench.simulators.flexible.sensor_chain import COUNT, FULL_SCALE, sensitivities
from jointbench.simulators.flexible.surface_nodes import surface_nodes

CAMPAIGN_SCHEMA, NOMINAL_SCHEMA = "campaign/1", "bench-sheet/1"
Json = dict[str, object]
_MASS_SIGMA = 1e-3  # of a body that was weighed


def write_hits(campaign: FlexibleCampaign, path: Path) -> None:
    """Write the hits of a campaign and the modal tables as HDF5.

    Args:
        campaign: the campaign.
        path: of the file; `known_bench` and `flexible_truth` go beside it as JSON.
    """
    with h5py.File(path, "w") as file:
        _write_records(file, campaign)
        for body in campaign.bench.bodies:
            _write_table(file.create_group(f"model/{body.body.name}"), campaign, body)


def _write_records(file: h5py.File, campaign: FlexibleCampaign) -> None:
    bench = campaign.bench
    file.attrs["schema"] = CAMPAIGN_SCHEMA
    file.attrs["fs_hz"] = SAMPLE_RATE
    file.attrs["channels"] = json.dumps(_channels(bench))
    file.attrs["excitation"] = "hammer"
    file.attrs["pretrigger_samples"] = PRETRIGGER
    file.attrs["full_scale_V"] = FULL_SCALE
    for index, (hit, counts) in enumerate(
        zip(bench.hits, campaign.counts, strict=True)
    ):
        record = file.create_group(f"records/r{index:03d}")
        record.create_dataset("data", data=counts, compression="gzip", shuffle=True)
        record.attrs["torque_Nm"] = hit.torque
        record.attrs["point"] = bench.specimen.points[hit.point].name
        record.attrs["aimed_peak_N"] = hit.level
        record.attrs["time_s"] = hit.time


def _channels(bench: FlexibleBench) -> list[Json]:
    sensors = bench.specimen.sensors
    scale = sensitivities(1 + len(sensors))
    rows: list[Json] = [
        {
            "name": "hammer",
            "quantity": "force",
            "unit": "N",
            "sensitivity_V_per_unit": float(scale[0]),
            "body": bench.specimen.points[0].body,
            "position_m": None,
            "direction": None,
            "counts_to_V": COUNT,
        }
    ]
    for sensor, volts in zip(sensors, scale[1:], strict=True):
        rows.append(
            {
                "name": sensor.name,
                "quantity": "acceleration",
                "unit": "m/s^2",
                "sensitivity_V_per_unit": float(volts),
                "body": sensor.body,
                "position_m": list(sensor.position),
                "direction": list(sensor.direction),
                "counts_to_V": COUNT,
            }
        )
    return rows


def _write_table(
    group: h5py.Group, campaign: FlexibleCampaign, body: PhysicalBody
) -> None:
    """Write the modal table of one body; its shapes are those of the drawing."""
    specimen = campaign.bench.specimen
    own = specimen.bodies.index(body.body)
    group["freq_hz"] = body.table_frequency
    group["phi_bolts"] = np.stack([body.table_rows(at) for at in specimen.bolts])
    if own == 0:
        group["phi_feet"] = np.stack([body.table_rows(at) for at in specimen.feet])
    group["nodes_m"] = surface_nodes(specimen, own)
    group["phi_nodes"] = body.table_nodes(surface_nodes(specimen, own))
    for sensor in specimen.sensors:
        if sensor.body == own:
            rows = body.table_rows(sensor.position)
            group[f"phi_channel/{sensor.name}"] = np.asarray(sensor.direction) @ rows
            group[f"phi_site/{sensor.name}"] = rows
            group[f"phi_site_gradient/{sensor.name}"] = body.table_gradient(
                sensor.position
            )
    for point in specimen.points:
        if point.body == own:
            group[f"phi_hit/{point.name}"] = body.table_rows(point.position)
            group[f"phi_hit_gradient/{point.name}"] = body.table_gradient(
                point.position
            )


def known_bench(bench: FlexibleBench) -> Json:
    """Return what the crew of the bench knows, as JSON types."""
    specimen, nominal = bench.specimen, bench.nominal
    joint = [
        "rigid" if np.isinf(k) else float(k) for k in nominal.stiffness[0].tolist()
    ]
    ratio = float(nominal.damping_ratio[0])
    return {
        "schema": NOMINAL_SCHEMA,
        "kind": specimen.kind,
        "bodies": {b.name: _known_body(b, ratio) for b in specimen.bodies},
        "plates": {
            "count": 2,
            "E_rel_sigma": MODULUS_SIGMA,
            "mass_rel_sigma": _MASS_SIGMA,
            "origin": "corner of the bottom body, z up; the bolts lie in the interface",
        },
        "bolts_mm": [_millimetres(at) for at in specimen.bolts],
        "feet_mm": [_millimetres(at) for at in specimen.feet],
        "torques_Nm": list(bench.torques),
        "hammer_points": {p.name: _known_place(p) for p in specimen.points},
        "aim_sigma_mm": 1e3 * AIM_SIGMA,
        "tilt_sigma_deg": float(np.degrees(TILT_SIGMA)),
        "sensors": [{"name": s.name} | _known_place(s) for s in specimen.sensors],
        "joint_per_bolt": {
            "kn_N_per_m": joint[2],
            "ktx_N_per_m": joint[0],
            "kty_N_per_m": joint[1],
            "cn_Ns_per_m": float(nominal.damping[0, 2]),
            "ct_Ns_per_m": float(nominal.damping[0, 0]),
            "rel_sigma": {"k": STIFFNESS_SIGMA, "c": DAMPING_SIGMA},
            "bolt_to_bolt_rel_sigma": BOLT_SIGMA,
        },
        "plate_damping_ratio": ratio,
        "plate_damping_rel_sigma": DAMPING_SIGMA,
        "plate_damping_note": "each body has its own",
        "feet": {
            "k_N_per_m": nominal.feet_stiffness,
            "c_Ns_per_m": nominal.feet_damping,
            "rel_sigma": {"k": FEET_SIGMA, "c": DAMPING_SIGMA},
            "note": "isotropic spring and damper at each foot",
        },
        "modal_table": _known_table(bench.world),
    }


def _known_table(world: str) -> Json:
    """Return the uncertainty of the modal table as a crew would state it."""
    if world == "exact":
        return {"world": world}
    return {
        "world": world,
        "frequency_rel_sigma": float(np.sqrt(np.prod(FREQUENCY_ERRORS))),
        "shape_rel_sigma": SHAPE_ERROR,
    }


def _known_body(body: ElasticBody, damping_ratio: float) -> Json:
    block = body.block
    return {
        "size_mm": _millimetres(block.size),
        "corner_mm": _millimetres(body.corner),
        "mass_kg": block.mass,
        "material": {
            "name": body.material,
            "E_Pa": block.youngs_modulus,
            "poisson": block.poisson_ratio,
            "density_kg_m3": block.density,
        },
        "E_rel_sigma": MODULUS_SIGMA,
        "damping_ratio": damping_ratio,
        "damping_rel_sigma": DAMPING_SIGMA,
    }


def _known_place(place: BodyPlace) -> Json:
    return {
        "position_mm": _millimetres(place.position),
        "direction": list(place.direction),
        "body": ("bottom", "top")[place.body],
    }


def _millimetres(place: tuple[float, float, float]) -> list[float]:
    return [round(1e3 * value, 6) for value in place]


def flexible_truth(bench: FlexibleBench) -> Json:
    """Return the truth about a bench as JSON types.

    Returns:
        Keys `truth` (names to find), `where` and `effects` (by true name), `bad_hits`,
        `physical` and what else was drawn.
    """
    values, hits = bench.values, bench.hits
    names = ["unknown" if e.name in FLEXIBLE_OUTSIDE else e.name for e in bench.effects]
    return {
        "truth": names or ["none"],
        "where": {e.name: _where(bench, e) for e in bench.effects},
        "effects": {e.name: _parameters(bench, e) for e in bench.effects},
        "bad_hits": {
            f"r{i:03d}": str(hit.bad) for i, hit in enumerate(hits) if hit.bad
        },
        "physical": {
            "E0": float(values.modulus[0]),
            "E1": float(values.modulus[1]),
            "zeta0": float(values.damping_ratio[0]),
            "zeta1": float(values.damping_ratio[1]),
            "bolt_stiffness": values.stiffness.tolist(),
            "bolt_damping": values.damping.tolist(),
            "kf": values.feet_stiffness,
            "cf": values.feet_damping,
        },
        "seed": bench.seed,
        "kind": bench.specimen.kind,
        "world": bench.world,
        "noise": {
            "force_N": bench.noise.force,
            "acceleration": bench.noise.acceleration,
        },
        "offset_mm": [[1e3 * x for x in hit.offset] for hit in hits],
        "force_direction": [list(hit.direction) for hit in hits],
    }


def _parameters(bench: FlexibleBench, effect: FlexibleEffect) -> dict[str, float]:
    """Return the parameters of an effect; of a compliance, the springs it has."""
    found = {key: float(value) for key, value in effect.parameters.items()}
    stiffness = bench.values.stiffness.mean(axis=0)
    damping = bench.values.damping.mean(axis=0)
    if effect.name == "joint_compliance_normal":
        found |= {"kn": float(stiffness[2]), "cn": float(damping[2])}
    if effect.name == "joint_compliance_tangential":
        found |= {"ktx": float(stiffness[0]), "kty": float(stiffness[1])}
        found |= {"ct": float(damping[0])}
    return found


def _where(bench: FlexibleBench, effect: FlexibleEffect) -> Json:
    found: Json = dict(effect.where)
    if "point" in found or "channel" in found:
        spot = named_place(bench.specimen, effect)
        found |= {"body": spot.body, "xyz_mm": _millimetres(spot.position)}
    return found
