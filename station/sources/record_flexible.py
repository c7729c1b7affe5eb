# SPDX-License-Identifier: MIT
"""``jointbench record`` on a flexible bench: raw hits, nominal values and truth."""

import json
from dataclasses import asdict
from pathlib import Path

import h5py

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.flexible_bench import FlexibleBench
from jointbench.simulators.flexible.flexible_campaign import (
    FlexibleCampaign,
    make_flexible_campaign,
)
from jointbench.simulators.flexible.flexible_margin import flexible_margin
from jointbench.simulators.flexible.flexible_url import (
    bench_of_flexible_url,
    flexible_query,
)
from jointbench.simulators.flexible.mesh_model import mesh_model_text
from jointbench.simulators.flexible.physical_bodies import MESHED_EFFECTS
from jointbench.simulators.flexible.write_flexible import (
    CAMPAIGN_SCHEMA,
    flexible_truth,
    known_bench,
    write_hits,
)
from jointbench.station.files.output_paths import check_outputs, whole_file, write_text
from jointbench.station.files.session_place import check_session_name
from jointbench.station.screen.terminal import (
    lasting_console,
    table,
    working,
    write_json,
)

NOMINAL, TRUTH, MODEL = ".sheet.json", ".truth.json", ".model.toml"


def run_record_flexible(
    url: str, out: Path, *, overwrite: bool, json_target: str | None
) -> None:
    """Simulate a campaign on a flexible bench and write its files.

    Args:
        url: of the bench.
        out: file of the raw hits; nominal values and truth go beside it as JSON, and
            the bench as a model of meshed bodies (TOML).
        overwrite: replace earlier files.
        json_target: where the JSON goes.

    Raises:
        UsageError: the URL makes no sense, or a file is there and `overwrite` is off.
    """
    check_session_name(out)
    nominal, truth = out.with_suffix(NOMINAL), out.with_suffix(TRUTH)
    model = out.with_suffix(MODEL)
    check_outputs([], [nominal, truth, json_target])
    for path in (out, nominal, truth, model):
        if path.exists() and not overwrite:
            raise UsageError(f"'{path}' is there already; add --force to overwrite it")
    _require_campaign(out)
    bench = bench_of_flexible_url(url)
    with working(f"recording {url}"):
        campaign = make_flexible_campaign(bench)
    with whole_file(out) as part:
        write_hits(campaign, part)
    write_text(nominal, json.dumps(known_bench(bench), indent=1) + "\n")
    write_text(model, mesh_model_text(bench))
    found = flexible_truth(bench) | {"margins": _margins(bench, url)}
    write_text(truth, json.dumps(found, indent=1) + "\n")
    _show(campaign, out, json_target)


def _margins(bench: FlexibleBench, url: str) -> dict[str, dict[str, float]]:
    """Return the margin of each effect by its name, where the URL asks for them."""
    if not flexible_query(url).margin:
        return {}
    # That of a thickness would need the bench without it.
    names = [e.name for e in bench.effects if e.name not in MESHED_EFFECTS]
    return {name: asdict(flexible_margin(bench, name)) for name in names}


def _require_campaign(path: Path) -> None:
    """Refuse to replace a file that is no earlier campaign of hits."""
    if not path.exists():
        return
    try:
        with h5py.File(path) as file:
            earlier = file.attrs.get("schema") == CAMPAIGN_SCHEMA
    except OSError:
        earlier = False
    if not earlier:
        raise UsageError(
            f"'{path}' is there already and no file of hits ({CAMPAIGN_SCHEMA}); "
            "choose another name or remove it"
        )


def _show(campaign: FlexibleCampaign, out: Path, json_target: str | None) -> None:
    bench = campaign.bench
    points = [point.name for point in bench.specimen.points]
    rows = [
        ("hits", f"{len(bench.hits)}"),
        ("hit points", ", ".join(points)),
        ("levels", ", ".join(f"{level:g} N" for level in bench.levels)),
        ("torques", ", ".join(f"{torque:g} N m" for torque in bench.torques)),
        ("bolts", f"{len(bench.specimen.bolts)}"),
        ("channels", ", ".join(each.name for each in bench.specimen.sensors)),
    ]
    screen = lasting_console(json_target)
    screen.print(table(f"{out}", ("campaign", "content"), rows))
    files = ("nominal values", NOMINAL), ("meshed model", MODEL), ("truth", TRUTH)
    for words, suffix in files:
        screen.print(f"{words}: {out.with_suffix(suffix)}", soft_wrap=True)
    screen.print(f"\nnext: jointbench gap {out}", soft_wrap=True)
    write_json(
        json_target,
        {
            "hits": str(out),
            "nominal": str(out.with_suffix(NOMINAL)),
            "model": str(out.with_suffix(MODEL)),
            "truth": str(out.with_suffix(TRUTH)),
            "records": len(bench.hits),
            "levels_n": list(bench.levels),
            "torques_nm": list(bench.torques),
        },
    )
