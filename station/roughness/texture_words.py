# SPDX-License-Identifier: MIT
"""Standard parameters in words, as rows of a table and as plain data."""

from collections.abc import Sequence

import numpy as np

from jointbench.signal.roughness.parameter_names import (
    MAP_PARAMETERS,
    PROFILE_PARAMETERS,
    ParameterName,
)
from jointbench.signal.roughness.pooled_texture import pooled_texture
from jointbench.signal.roughness.setting_classes import SECTIONS
from jointbench.signal.roughness.texture_records import TextureSettings
from jointbench.signal.roughness.uncertain_parameters import (
    MeasuredTexture,
    TextureValue,
)
from jointbench.station.roughness.texture_request import TextureAnswer
from jointbench.station.screen.value_text import engineering, with_sd

COLUMNS = ("parameter", "value", "95 % interval", "noise adds", "largest cause")
_PERCENT = frozenset({"Rmrk1", "Rmrk2", "Smrk1", "Smrk2", "Sdr"})
_VOLUMES = frozenset({"Vmp", "Vmc", "Vvc", "Vvv"})
_CURVE_POINTS = 101
_FEW = 0.05
"""Share of the value below which noise is not named [-]."""


def parameter_names(measured: MeasuredTexture) -> tuple[ParameterName, ...]:
    """Return the parameters of a profile or of a map in the order of tables."""
    plane = measured.texture.heights.ndim == 2
    return MAP_PARAMETERS if plane else PROFILE_PARAMETERS


def title_words(measured: MeasuredTexture) -> str:
    """Return the title of the table of one surface."""
    standard = "ISO 25178-2" if measured.texture.heights.ndim == 2 else "ISO 21920-2"
    return f"{measured.surface}: roughness by {standard}, {_settings_words(measured)}"


def _settings_words(measured: MeasuredTexture) -> str:
    """Return nesting indices, form and evaluation length in words."""
    texture = measured.texture
    settings = texture.settings
    parts = [settings.setting_class] if settings.setting_class else []
    parts.append(_index_words("S", settings.short))
    if texture.heights.ndim == 2 and settings.long is None:
        parts.append(f"F of degree {settings.form}, no L-filter (S-F surface)")
    else:
        kind = "robust L" if settings.robust else "L"
        parts.append(_index_words(kind, settings.long))
    if texture.heights.ndim == 1:
        length = engineering(texture.heights.size * texture.spacing[0], "m")
        word = "section" if texture.sections == 1 else "sections"
        sections = f"{texture.sections} {word}"
        parts.append(f"evaluation length {length} ({sections})")
    else:
        sides = (
            engineering(n * d, "m")
            for n, d in zip(
                texture.heights.shape[::-1], texture.spacing[::-1], strict=True
            )
        )
        parts.append(f"evaluation area {' x '.join(sides)}")
    return ", ".join(parts)


def _index_words(name: str, index: float | None) -> str:
    return f"no {name}-filter" if index is None else f"{name} {engineering(index, 'm')}"


def parameter_rows(measured: MeasuredTexture) -> list[tuple[str, ...]]:
    """Return one row for each parameter."""
    return [_row(measured.named(one.name), one) for one in parameter_names(measured)]


def pooled_rows(several: Sequence[MeasuredTexture]) -> list[tuple[str, ...]]:
    """Return one row for each mean parameter of several measurements."""
    values = {one.name: one for one in pooled_texture(several)}
    return [_row(values[one.name], one) for one in parameter_names(several[0])]


def pooled_json(several: Sequence[MeasuredTexture]) -> list[dict[str, object]]:
    """Return the mean parameters of several measurements as plain data."""
    values = {one.name: one for one in pooled_texture(several)}
    return [_value_json(values[one.name], one) for one in parameter_names(several[0])]


def _row(value: TextureValue, name: ParameterName) -> tuple[str, ...]:
    if value.value is None or value.interval is None:
        return (name.name, "not defined", "-", "-", "-")
    scale, unit = _display_unit(value, name)
    low, high = value.interval
    digits = _digits(value.uncertainty)
    bias = "-"
    if value.uncertainty and abs(value.bias) > _FEW * value.uncertainty:
        bias = f"{scale * value.bias:.2g} {unit}".strip()
    cause, part = max(value.parts, key=lambda one: one[1])
    return (
        name.name,
        f"{with_sd(scale * value.value, scale * value.uncertainty)} {unit}".strip(),
        f"{scale * low:.{digits}g} to {scale * high:.{digits}g} {unit}".strip(),
        bias,
        cause if part > 0 else "-",
    )


def _digits(uncertainty: float) -> int:
    return 4 if uncertainty else 6


def _display_unit(value: TextureValue, name: ParameterName) -> tuple[float, str]:
    """Return the factor and the unit in which a parameter is shown."""
    if name.name in _PERCENT:
        return 100.0, "%"
    if name.unit == "rad":
        return float(180 / np.pi), "deg"
    if name.name in _VOLUMES:
        return 1e6, "µm³/µm²"
    if name.unit == "m":
        return (1e9, "nm") if abs(value.value or 0.0) < 1e-7 else (1e6, "µm")
    return 1.0, ""


def answer_lines(answer: TextureAnswer) -> tuple[str, ...]:
    """Return how the settings were chosen and what departs from them."""
    if answer.measured is None:
        return (f"no standard parameters: {answer.reason}",)
    noise = answer.measured.noise
    said = [answer.reason, *answer.remarks]
    if noise is None:
        said.append(
            "noise of the heights is not known (an S-filter has removed it): it is not "
            "part of the intervals"
        )
    elif noise > 0:
        said.append(f"noise of a height: {engineering(noise, 'm')} rms, at most")
    parts = [dict(one.parts) for one in answer.measured.values if one.parts]
    if not any(part.get("height") or part.get("pitch") for part in parts):
        said.append(
            "errors of the height scale and of the pitch are not stated and not part "
            "of the intervals; give them with --scale-errors '1 %:0.5 %'"
        )
    return tuple(said)


def answer_json(answer: TextureAnswer) -> dict[str, object]:
    """Return the answer as plain data; ``reason`` is always there."""
    measured = answer.measured
    if measured is None:
        return {"standard": None, "reason": answer.reason, "parameters": []}
    texture, curve = measured.texture, None
    known = np.sort(texture.heights[texture.valid])[::-1]
    ratio = np.linspace(0, 1, _CURVE_POINTS)
    curve = np.interp(ratio * known.size - 0.5, np.arange(known.size), known)
    return {
        "standard": "ISO 25178-2" if texture.heights.ndim == 2 else "ISO 21920-2",
        "reason": answer.reason,
        "remarks": list(answer.remarks),
        "settings": _settings_json(texture.settings),
        "sections": texture.sections,
        "evaluation_m": [
            n * d for n, d in zip(texture.heights.shape, texture.spacing, strict=True)
        ],
        "noise_m": measured.noise,
        "parameters": [
            _value_json(measured.named(one.name), one)
            for one in parameter_names(measured)
        ],
        "material_ratio": {"ratio": ratio.tolist(), "height_m": curve.tolist()},
    }


def _settings_json(settings: TextureSettings) -> dict[str, object]:
    """Return nesting indices and form as plain data."""
    return {
        "setting_class": settings.setting_class or None,
        "s_index_m": settings.short,
        "l_index_m": settings.long,
        "form_degree": settings.form,
        "robust": settings.robust,
        "sections": SECTIONS,
    }


def _value_json(value: TextureValue, name: ParameterName) -> dict[str, object]:
    return {
        "name": name.name,
        "meaning": name.meaning,
        "unit": name.unit,
        "value": value.value,
        "uncertainty": value.uncertainty if value.parts else None,
        "interval": None if value.interval is None else list(value.interval),
        "noise_bias": value.bias,
        "causes": dict(value.parts),
    }
