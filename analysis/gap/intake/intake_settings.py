# SPDX-License-Identifier: MIT
"""Settings of the intake: limits of files, and how hits are cut from sessions."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class IntakeSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    most_records: int = numerical(
        1024,
        "records",
        "most records of a campaign file that are read",
        "memory: far above any campaign",
    )
    most_samples: int = numerical(
        1 << 20,
        "samples",
        "most samples of a record of a campaign file that are read",
        "memory: far above any campaign",
    )
    least_samples: int = numerical(
        512,
        "samples",
        "fewest samples of a record that can show a resonance",
    )
    default_preload: float = numerical(
        4000.0,
        "N",
        "reference preload of a campaign file without one",
        "default of the file format",
    )
    same_level_ratio: float = numerical(
        1.6,
        "-",
        "ratio between neighbouring peaks up to which hits may share a nominal level",
        "an operator repeats a level to 20 %; levels differ by a factor of 2 or more",
    )
    level_span: float = numerical(
        2.5,
        "-",
        "largest ratio between two peaks of one nominal level",
    )
    pretrigger_samples: int = numerical(
        112,
        "samples",
        "samples kept before the trigger",
        "the ringing of the anti-alias filter extends over the last 48 of them",
    )
    quiet_samples: int = numerical(
        64,
        "samples",
        "first samples of a record, without hit or ringing of the filter",
        "remainder of the pre-trigger",
    )
    look_back_samples: int = numerical(
        512,
        "samples",
        "samples before a hit that are searched for a response that still decays",
    )
    shortest_record: int = numerical(
        512,
        "samples",
        "shortest record that is cut",
        "as for campaign files",
    )
    longest_record: int = numerical(
        4096,
        "samples",
        "longest record that is cut",
        "computing time",
    )
    channel_samples: int = numerical(
        100_000,
        "samples",
        "samples of a channel in all records together above which records are cut "
        "short",
        "computing time",
    )
    decayed_share: float = numerical(
        0.05,
        "of the peak",
        "response at which a record may end",
    )
    decay_block: int = numerical(
        64,
        "samples",
        "samples over which the decay is averaged",
    )
    ringing_ratio: float = numerical(
        1.25,
        "-",
        "rms before a hit over white noise above which the channel is not at rest",
        "chi2 spread of an rms over 512 samples is 3 %",
    )
    decaying_ratio: float = numerical(
        0.8,
        "-",
        "rms of the last quarter before a hit over that of the third below which "
        "it decays",
    )
    steady_share: float = numerical(
        0.02,
        "of the peak",
        "steady signal (hum) before a hit that is accepted",
    )
    offset_sd: float = numerical(
        5.0,
        "sd",
        "change of the mean before a hit above which the channel has an offset",
        "closed form: one record in 1.7 million by chance",
    )


INTAKE = IntakeSettings()


@dataclass(frozen=True, slots=True)
class HitSettings:
    """Numbers of the intake of raw hits; unit, purpose and basis are with each."""

    mains: tuple[float, float] = numerical(
        (50.0, 60.0), "Hz", "nominal frequencies of the mains"
    )
    mains_harmonics: tuple[int, int] = numerical(
        (1, 3),
        "-",
        "harmonics of the mains in the hum that is fitted",
        "transformers and rectifiers make odd ones; the fifth is weaker",
    )
    mains_sd: float = numerical(
        0.1,
        "Hz",
        "sd of the frequency of the mains about the nominal one",
        "a quiet start of 20 ms shows it to a hertz or more; networks hold it to 0.05",
    )
    least_hum: float = numerical(
        0.005,
        "of the variance of the noise",
        "least variance of the hum that is allowed for",
        "an amplitude of a tenth of the noise",
    )
    contact_noise_sd: float = numerical(
        5.0, "sd", "force above which a sample belongs to a contact"
    )
    contact_share: float = numerical(
        0.003, "of the peak", "force above which a sample belongs to a contact"
    )
    contact_padding: int = numerical(
        4, "samples", "samples kept on both sides of a contact"
    )
    full_share: float = numerical(
        0.985, "of full scale", "voltage that counts as full scale"
    )
    full_samples: int = numerical(
        2,
        "samples",
        "samples of a channel at full scale from which a hit is overloaded",
        "one sample may be a peak just inside",
    )
    second_share: float = numerical(
        0.03, "of the peak", "second peak of the force from which a hit is double"
    )
    glancing_share: float = numerical(
        0.3, "of the aimed peak", "peak below which a hit is glancing"
    )
    hard_share: float = numerical(
        4.0,
        "of the aimed peak",
        "peak above which a hit is an overload",
        "hits scatter by 10 %; one of 130 times its aim stayed in the range of all "
        "inputs, because the bolts slipped, and spoilt a fit",
    )
    peak_noise_sd: float = numerical(
        50.0, "sd", "peak over the noise of the force below which a hit is glancing"
    )
    band_share: float = numerical(
        0.03,
        "of the spectrum at 0 Hz",
        "spectrum of the force at which the band of the hits ends",
        "30 dB: beyond it a response of equal receptance is below the noise",
    )
    stop_over_band: float = numerical(
        1.15,
        "-",
        "frequency from which the common filter passes nothing, over the band",
        "samples, lines and modes go with it: 1.15 in place of about 1.7 halves time "
        "and memory; the kernel lasts 29 periods of the band",
    )
    most_trimmed: float = numerical(
        0.25,
        "of the record",
        "largest end of a record that is left out because the filter reaches beyond",
    )
    stop_band: float = numerical(70.0, "dB", "attenuation of the common filter")
    band_of_table: float = numerical(
        0.6,
        "of the highest mode",
        "largest band: above it, modes beyond the table are missing",
    )
    trigger_margin: int = numerical(
        12, "samples", "samples before the trigger that may hold the first contact"
    )
    most_channels: int = numerical(256, "channels", "most channels that are read")
    most_records: int = numerical(2000, "records", "most records that are read")
    least_samples: int = numerical(256, "samples", "shortest record that is read")
    most_samples: int = numerical(200_000, "samples", "longest record that is read")
    least_pretrigger: int = numerical(
        64, "samples", "shortest quiet start: offset, hum and noise come from it"
    )
    most_joints: int = numerical(64, "points", "most bolts or feet that are read")
    most_nodes: int = numerical(
        200_000, "nodes", "most nodes of the surface of a body that are read"
    )
    most_modes: int = numerical(500, "modes", "most modes of a body that are read")


HITS = HitSettings()
