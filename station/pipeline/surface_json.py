# SPDX-License-Identifier: MIT
"""Results of a surface as plain data, as ``jointbench surface --json`` writes them."""

from collections.abc import Sequence

from jointbench.acquisition.formats.heights.height_facts import cautions
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.fractal.verdict_records import FractalFit
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.line_spectrum import line_spectrum
from jointbench.station.pipeline.roughness_words import roughness_json
from jointbench.station.pipeline.surface_stages import SurfaceChain
from jointbench.station.roughness.texture_words import answer_json
from jointbench.station.screen.band_limited_words import band_json


def surface_json(chain: SurfaceChain) -> dict[str, object]:
    """Return what the contract promises of ``surface``, and more."""
    said = cautions(chain.surface.provenance)
    return {
        **fit_json(chain.surface.name, chain.fit, said),
        "remedy": chain.remedy,
        "band_limited": band_json(chain.band, chain.no_band),
        "spectrum": spectrum_json(chain.surface),
        **_texture_json(chain),
        **dict(chain.beside.keys),
    }


def _texture_json(chain: SurfaceChain) -> dict[str, object]:
    """Return the standard parameters where they were asked for."""
    return {} if chain.texture is None else {"texture": answer_json(chain.texture)}


def fit_json(name: str, fit: FractalFit, said: Sequence[str]) -> dict[str, object]:
    """Return a fit and its cautions as plain data."""
    return {
        "surface": name,
        "verdict": fit.verdict.value,
        "reason": fit.reason,
        "cautions": list(said),
        "dimension": fit.dimension,
        "dimension_sd": fit.dimension_sd,
        **roughness_json(fit.scaling),
        "fit_band_m": fit.fit_band,
        "instrument": fit.instrument,
        "instrument_parameters": [
            {"name": p.name, "value_m": p.value, "sd_m": p.sd}
            for p in fit.instrument_parameters
        ],
        "chi2_per_dof": fit.chi2_per_dof,
        "pivot_m": fit.pivot,
        "pivot_value_m2": fit.pivot_value,
        "local_slope": {
            "lag_m": fit.local_slope.lag.tolist(),
            "slope": fit.local_slope.slope.tolist(),
            "sd": fit.local_slope.sd.tolist(),
        },
        "provenance": [{"step": s.name, **dict(s.detail)} for s in fit.provenance],
    }


def spectrum_json(surface: Surface) -> dict[str, object] | None:
    """Return the power spectral density along the lines of a surface as plain data."""
    found = line_spectrum(level(surface))
    if found is None:
        return None
    return {
        "wavelength_m": (1 / found.frequency).tolist(),
        "density_m3": found.density.tolist(),
        "ordinates": found.count.tolist(),
    }
