# SPDX-License-Identifier: MIT
"""What a recipe says, as the settings that the chain takes."""

import math

from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.hits.find_hits import HitCriteria
from jointbench.signal.hits.hit_verdicts import HitLimits
from jointbench.signal.hits.windows import WindowRequest
from jointbench.signal.kalman.process_models import KalmanModel, KalmanSettings
from jointbench.signal.modal.manual_selection import Choices
from jointbench.signal.modal.modes import ModalSettings
from jointbench.signal.roughness.uncertain_parameters import instrument_errors
from jointbench.signal.surface.surface_treatment import SurfaceTreatment
from jointbench.station.pipeline.chain import ChainSettings
from jointbench.station.pipeline.judge_again import StoredHits
from jointbench.station.roughness.texture_request import TextureRequest
from jointbench.station.schemas.recipe import Recipe
from jointbench.station.schemas.recipe_modal_parts import HitsPart, KalmanPart

_LIMITS = (
    "overload_fraction",
    "flat_samples",
    "double_ratio",
    "weak_ratio",
    "weak_force",
)
_HOW = ("again", "keep_operator")


def chain_settings(recipe: Recipe) -> ChainSettings:
    """Return the settings of hits, windows, FRF, Kalman stage and modes."""
    modes, windows = recipe.modes, recipe.windows
    return ChainSettings(
        hits=hit_criteria(recipe.hits),
        kalman=_kalman(recipe.kalman),
        modal=ModalSettings(
            band=modes.band,
            highest_order=modes.highest_order,
            refine=modes.refine,
            choices=Choices(modes.keep, modes.drop),
        ),
        estimator=Estimator(recipe.frf.estimator),
        window=WindowRequest(windows.force_width, windows.exponential, windows.lead),
    )


def surface_treatment_of(recipe: Recipe) -> SurfaceTreatment:
    """Return the steps before the fit of surfaces; the direction is in degrees."""
    part = recipe.surface
    return SurfaceTreatment(
        form=part.form,
        outliers=part.outliers,
        direction=None if part.direction is None else math.radians(part.direction),
        short=part.lambda_s,
        long=part.lambda_c,
    )


def texture_request_of(recipe: Recipe) -> TextureRequest | None:
    """Return what is asked of the standard parameters; None for none."""
    part = recipe.surface
    if not part.iso:
        return None
    return TextureRequest(
        setting_class=part.setting_class,
        short=part.lambda_s,
        long=part.lambda_c,
        form=part.form or 1,
        robust=bool(part.robust),
        errors=instrument_errors(part.scale_errors),
    )


def hit_criteria(part: HitsPart) -> HitCriteria:
    """Return the criteria of hits; what the recipe leaves out has its default."""
    given = part.model_dump(exclude_none=True, exclude={*_LIMITS, *_HOW})
    limits = part.model_dump(exclude_none=True, include=set(_LIMITS))
    return HitCriteria(**given, limits=HitLimits(**limits))


def stored_hits(part: HitsPart) -> StoredHits:
    """Return what becomes of the hits that a session carries already.

    A recording may hold no hit at all where it is read again: others may.
    """
    return StoredHits(part.again, part.keep_operator, all_struck=False)


def _kalman(part: KalmanPart) -> KalmanSettings | None:
    if not part.use:
        return None
    given = part.model_dump(exclude_none=True, exclude={"use", "model"})
    return KalmanSettings(model=KalmanModel(part.model), **given)
