# SPDX-License-Identifier: MIT
"""What is asked of the standard parameters of surfaces, and how they are computed."""

from dataclasses import dataclass, replace

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.roughness.setting_classes import (
    SETTING_CLASSES,
    SettingClass,
    class_of_roughness,
    map_s_index,
    setting_class,
)
from jointbench.signal.roughness.texture_operators import surface_texture
from jointbench.signal.roughness.texture_parameters import texture_parameters
from jointbench.signal.roughness.texture_records import TextureSettings
from jointbench.signal.roughness.texture_uncertainty import measured_texture
from jointbench.signal.roughness.uncertain_parameters import (
    NO_ERRORS,
    InstrumentErrors,
    MeasuredTexture,
)

_MOST_STEPS = len(SETTING_CLASSES)
_LARGEST_ERROR = 0.5


@dataclass(frozen=True, slots=True)
class TextureRequest:
    """What is asked of the standard parameters.

    Attributes:
        setting_class: of profiles, ``"Sc3"``; None to choose it by Rz.
        short: nesting index of the S-filter that replaces the default [m]; None.
        long: nesting index of the L-filter that replaces the default [m]; None.
        form: degree of the polynomial of the F-operation [-].
        robust: L-filter by robust Gaussian regression.
        errors: of the instrument.
    """

    setting_class: str | None = None
    short: float | None = None
    long: float | None = None
    form: int = 1
    robust: bool = False
    errors: InstrumentErrors = NO_ERRORS


@dataclass(frozen=True, slots=True, eq=False)
class TextureAnswer:
    """Standard parameters of one surface, or the reason why it has none.

    Attributes:
        measured: parameters with uncertainties; None where there are none.
        reason: why there are none, or how the settings were chosen.
        remarks: departures from the default settings.
    """

    measured: MeasuredTexture | None
    reason: str
    remarks: tuple[str, ...] = ()


def instrument_errors(text: str | None) -> InstrumentErrors:
    """Return the errors as typed: ``"1 %:0.5 %"``, of heights and of the pitch.

    Raises:
        UsageError: not two parts, or no small positive shares.
    """
    if text is None:
        return NO_ERRORS
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2 or not any(parts):
        raise UsageError(
            f"--scale-errors is {text!r}; give the standard uncertainty of the height "
            "scale and of the pitch, for example '1 %:0.5 %', '1 %:' or ':0.5 %'"
        )
    height, pitch = (_share(part) if part else 0.0 for part in parts)
    return InstrumentErrors(height, pitch)


def _share(text: str) -> float:
    plain = text.removesuffix("%")
    try:
        value = float(plain) / (100 if plain != text else 1)
    except ValueError:
        value = -1.0
    if not 0 <= value < _LARGEST_ERROR:
        raise UsageError(
            f"--scale-errors has {text!r}; a share is a number from 0 to "
            f"{_LARGEST_ERROR:g}, or a percentage as '1 %'"
        )
    return value


def requested_texture(
    typed: tuple[str | None, str | None, str | None],
    *,
    iso: bool,
    form: int | None,
    robust: bool,
) -> TextureRequest | None:
    """Return the request as typed; None without ``--iso``.

    Args:
        typed: setting class, cut-offs of ``--filter`` and errors of the scales.
        iso: whether the parameters are asked for.
        form: degree of the polynomial [-]; None for 1.
        robust: whether the L-filter is robust.

    Raises:
        UsageError: an option without ``--iso``, no such setting class, nesting indices
            twice, or errors that are no shares.
    """
    class_name, cutoffs, errors = typed
    if not iso:
        options = {
            "--setting-class": class_name is not None,
            "--robust": robust,
            "--scale-errors": errors is not None,
        }
        for name in (name for name, given in options.items() if given):
            raise UsageError(f"{name} is for standard parameters; add --iso")
        return None
    waves = typed_waves(cutoffs)
    if class_name is not None:
        setting_class(class_name)
        if any(one is not None for one in waves):
            raise UsageError(
                "--setting-class and --filter both give nesting indices; leave one out"
            )
    return TextureRequest(
        setting_class=class_name,
        short=waves[0],
        long=waves[1],
        form=form or 1,
        robust=robust,
        errors=instrument_errors(errors),
    )


def texture_answer(surface: Surface, asked: TextureRequest) -> TextureAnswer:
    """Return the standard parameters of one surface, or why it has none."""
    try:
        settings, reason, remarks = _settings(surface, asked)
        measured = measured_texture(surface, settings, asked.errors)
    except (BadData, UsageError) as error:
        return TextureAnswer(None, str(error))
    remarks = (*remarks, *measured.texture.remarks, *_pitch_remarks(surface, settings))
    return TextureAnswer(measured, reason, remarks)


def _settings(
    surface: Surface, asked: TextureRequest
) -> tuple[TextureSettings, str, tuple[str, ...]]:
    """Return settings, how they were chosen, and departures from the default."""
    stated = TextureSettings(asked.short, asked.long, asked.form, asked.robust)
    if not isinstance(surface, Profile):
        short = asked.short or map_s_index(max(surface.spacing))
        return replace(stated, short=short), "nesting indices of ISO 25178-3", ()
    if asked.long is not None or asked.short is not None:
        return stated, "nesting indices as stated", ()
    if asked.setting_class is not None:
        chosen, reason = setting_class(asked.setting_class), "setting class as stated"
        settings, remarks = _of_class(surface, stated, chosen)
        return settings, reason, remarks
    if surface.instrument.cutoff_long is not None:
        return _of_file(surface, stated)
    return _chosen(surface, stated)


def _of_file(
    profile: Profile, stated: TextureSettings
) -> tuple[TextureSettings, str, tuple[str, ...]]:
    """Return the cut-offs that the file states: the profile was measured for them."""
    long = profile.instrument.cutoff_long
    named = [one for one in SETTING_CLASSES if one.long == long]
    short = profile.instrument.cutoff_short or (named[0].short if named else None)
    settings = replace(stated, short=short, long=long)
    return settings, "nesting indices as the file states", ()


def _of_class(
    profile: Profile, stated: TextureSettings, chosen: SettingClass
) -> tuple[TextureSettings, tuple[str, ...]]:
    """Return the settings of a class; an S-filter below two samples is left out."""
    short: float | None = chosen.short
    remarks: tuple[str, ...] = ()
    if chosen.short < 2 * profile.spacing:
        short = None
        remarks = (
            f"the pitch of {profile.spacing * 1e6:.3g} µm is too coarse for the "
            f"S-filter of {chosen.short * 1e6:g} µm: none is applied",
        )
    settings = replace(stated, short=short, long=chosen.long, setting_class=chosen.name)
    return settings, remarks


def _chosen(
    profile: Profile, stated: TextureSettings
) -> tuple[TextureSettings, str, tuple[str, ...]]:
    """Choose the setting class by Rz, as ISO 21920-3 and its annex D do.

    Where the profile is shorter than one section of that class, the largest class with
    a section takes its place.
    """
    length = profile.heights.size * profile.spacing
    fitting = [one for one in SETTING_CLASSES if one.long <= length * (1 + 1e-9)]
    fitting = [one for one in fitting if one.long >= 2 * profile.spacing]
    if not fitting:
        raise UsageError(
            f"profile {profile.name!r} is {length:.3g} m long, shorter than a section "
            "of every setting class; state nesting indices with --filter"
        )
    longest = fitting[-1]
    chosen, seen = longest, set()
    for _ in range(_MOST_STEPS):
        seen.add(chosen.name)
        settings, remarks = _of_class(profile, stated, chosen)
        roughness = _section_height(profile, settings)
        wanted = class_of_roughness(roughness)
        found = min(wanted, longest, key=lambda one: one.long)
        if found.name in seen:
            break
        chosen = found
    settings, remarks = _of_class(profile, stated, chosen)
    if wanted.long > longest.long:
        remarks = (
            *remarks,
            f"the profile is too short for {wanted.name}, the class of its Rz",
        )
    reason = f"setting class {chosen.name}, chosen by Rz"
    return settings, reason, remarks


def _section_height(profile: Profile, settings: TextureSettings) -> float:
    texture = surface_texture(profile, settings)
    return float(texture_parameters(texture).values["Rz"] or 0.0)


def _pitch_remarks(surface: Surface, settings: TextureSettings) -> tuple[str, ...]:
    """Return what the class asks of pitch and tip and the profile has not."""
    if not settings.setting_class or not isinstance(surface, Profile):
        return ()
    asked = setting_class(settings.setting_class)
    said = []
    if surface.spacing > asked.pitch * (1 + 1e-3):
        said.append(
            f"the pitch is {surface.spacing * 1e6:.3g} µm, {asked.name} has at most "
            f"{asked.pitch * 1e6:g} µm"
        )
    radius = surface.instrument.stylus_radius
    if radius is not None and radius > asked.tip * (1 + 1e-3):
        said.append(
            f"the stylus radius is {radius * 1e6:.3g} µm, {asked.name} has at most "
            f"{asked.tip * 1e6:g} µm"
        )
    return tuple(said)


def typed_waves(text: str | None) -> tuple[float | None, float | None]:
    """Return the two cut-offs of ``--filter`` [m]; None for those left out."""
    if text is None:
        return None, None
    parts = [part.strip() for part in text.split(":")]
    short, long = (parse_value(part, "length") if part else None for part in parts)
    return short, long
