# SPDX-License-Identifier: MIT
"""Open a source of samples by its URL: the one place that knows the simulators.

Whatever is simulated comes through NI's client from a simulated chassis, so that every
session that is recorded went the way that a session at the bench goes.
"""

import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Channel
from jointbench.acquisition.records.source import Run, Source

if TYPE_CHECKING:
    from jointbench.simulators.campaigns.joint_campaign import JointCampaign

SCHEMES = ("sim",)


@dataclass(frozen=True, slots=True)
class RunSequence:
    """Consecutive runs on a bench, each with its own setting.

    Attributes:
        source: the URL that opens it again.
        simulated: True for a simulation, False for hardware.
        runs: in the order in which they are recorded.
        model: bench model with priors as TOML, where the source provides one.
        truth: what a simulated bench hides, for whoever compares; never an input.
    """

    source: str
    simulated: bool
    runs: tuple[Run, ...]
    model: str | None = None
    truth: Mapping[str, object] | None = None


@dataclass(frozen=True, slots=True)
class WholeStream:
    """A plain source as a single run.

    Attributes:
        source: what it streams.
        preload: on the joint [N], None where it is not given.
        start_time: of its first sample [s].
    """

    source: Source
    preload: float | None
    start_time: float = 0.0

    @property
    def name(self) -> str:
        """Of the recording."""
        return "stream"

    @property
    def simulated(self) -> bool:
        """As the source says."""
        return self.source.simulated

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Of the source."""
        return self.source.channels

    @property
    def sample_rate(self) -> float:
        """Of the source [Hz]."""
        return self.source.sample_rate

    def blocks(self) -> Iterator[FloatArray]:
        """Yield the blocks of the source."""
        return self.source.blocks()


def is_url(text: str) -> bool:
    """Return whether a name is the URL of a source, not the path of a file."""
    return text.partition(":")[0] in SCHEMES and ":" in text


def open_source(url: str) -> Source:
    """Open the source that `url` names.

    Args:
        url: ``sim:two-body?seed=1&hits=10`` for the embedded simulated bench.

    Returns:
        A source whose blocks can be recorded.

    Raises:
        UsageError: the scheme is unknown.
    """
    _require_scheme(url)
    from jointbench.simulators.two_body.bench_url import bench_from_url
    from jointbench.station.sources.chassis_source import ChassisSource

    bench = bench_from_url(url)
    return ChassisSource(bench, samples=bench.samples)


def open_runs(url: str) -> RunSequence:
    """Open the source of `url` as runs, with the bench model if it has one.

    Args:
        url: as for `open_source`, or ``sim:two-body-campaign?seed=1&hide=jenkins``
            for points x levels x preloads with hidden effects.

    Raises:
        UsageError: the scheme is unknown, or the bench cannot be as asked.
    """
    _require_scheme(url)
    from jointbench.simulators.two_body.bench import TwoBodyBench
    from jointbench.simulators.two_body.bench_url import specimen_from_url
    from jointbench.station.sources.chassis_source import ChassisRun, ChassisSource

    bench = specimen_from_url(url)
    if isinstance(bench, TwoBodyBench):
        source = ChassisSource(bench, samples=bench.samples)
        stream = WholeStream(source, bench.truth.preload)
        return RunSequence(bench.name, bench.simulated, (stream,))
    from jointbench.simulators.two_body.bolted_blocks import BoltedBlocks

    if isinstance(bench, BoltedBlocks):
        return blocks_sequence(bench.name, bench.simulate())
    from jointbench.simulators.campaigns.write_campaign import campaign_truth
    from jointbench.simulators.two_body.campaign_bench import campaign_runs
    from jointbench.station.sources.campaign_model import model_text

    campaign = bench.simulate()
    return RunSequence(
        bench.name,
        bench.simulated,
        tuple(
            ChassisRun(run, samples=run.samples.shape[1])
            for run in campaign_runs(campaign)
        ),
        model_text(campaign.design),
        campaign_truth(campaign),
    )


def blocks_sequence(name: str, made: "JointCampaign") -> RunSequence:
    """Return the runs on two bolted blocks, their model and their truth.

    Args:
        name: URL of the bench.
        made: what was simulated.
    """
    from jointbench.simulators.two_body.campaign_bench import campaign_runs
    from jointbench.station.sources.campaign_model import blocks_text
    from jointbench.station.sources.chassis_source import ChassisRun

    campaign, stiffness = made.campaign, made.stiffness
    truth = {
        "effects": {one.name: dict(one.parameters) for one in campaign.effects},
        "joint": [asdict(one) | {"factors": one.factors} for one in stiffness],
    }
    runs = tuple(
        ChassisRun(run, samples=run.samples.shape[1]) for run in campaign_runs(campaign)
    )
    text = blocks_text(campaign.design, made.surfaces)
    return RunSequence(name, True, runs, text, truth)


def _require_scheme(url: str) -> None:
    # The simulated chassis closes its connections; gRPC would report each on stderr.
    os.environ.setdefault("GRPC_VERBOSITY", "NONE")
    scheme = url.partition(":")[0]
    if scheme in SCHEMES:
        return
    near = get_close_matches(scheme, SCHEMES)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(SCHEMES)}"
    raise UsageError(f"source {url!r} has the unknown scheme {scheme!r}; {hint}")
