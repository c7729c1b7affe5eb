"""The readers of foreign bytes, by name."""

from collections.abc import Callable
from pathlib import Path

from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.formats.samples.hit_tables import read_recording
from jointbench.acquisition.formats.samples.mat_recording import read_mat_recordings
from jointbench.acquisition.formats.samples.rattlesnake import read_rattlesnake
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.samples.tdms import read_tdms
from jointbench.acquisition.formats.samples.universal import read_universal
from jointbench.acquisition.formats.samples.wave import read_wave
from jointbench.acquisition.session_file.describe_file import describe_file
from jointbench.acquisition.session_file.store import read_session
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.structures.matrices.mesh_files import read_matrix, read_mesh
from jointbench.station.archive.ledger import read_ledger
from jointbench.station.commands.verify_command import run_verify
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.model_kind import describes_structure
from jointbench.station.measure.plan import read_plan
from jointbench.station.results.results_read import read_result
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.geometry_file import Geometry
from jointbench.station.schemas.recipe import read_recipe

MAT = "time.t:s,force.F:N,acceleration.a1:m/s^2"
TABLE = "time:s,force:N,acceleration:m/s^2"


READERS: dict[str, Callable[[Path], object]] = {
    "TOML: bench model": lambda p: read_toml(p, BenchModel),
    "TOML: structure or bench": describes_structure,
    "TOML: recipe": read_recipe,
    "TOML: plan": read_plan,
    "TOML: geometry": lambda p: read_toml(p, Geometry),
    "ledger": read_ledger,
    "hits": lambda p: read_recording(p, columns=TABLE),
    "hits, units of the file": lambda p: read_recording(p, columns=None),
    "heights": read_surface,
    "heights x, z": lambda p: read_surface(p, columns="x:um,z:um"),
    "heights x, y, z": lambda p: read_surface(p, columns="x:um,y:um,z:um"),
    "heights alone": lambda p: read_surface(p, columns="z:um@1um"),
    "session": read_session,
    "inspect": describe_file,
    "verify": lambda p: run_verify(p, json_target=None),
    "results": read_result,
    "campaign": read_campaign,
    "Rattlesnake": lambda p: read_rattlesnake(p, columns=None, point="1"),
    "MAT": lambda p: read_mat_recordings(p, SampleOptions(MAT)),
    "universal": lambda p: read_universal(p, columns=None, point="1"),
    "TDMS": lambda p: read_tdms(p, columns=None, point="1"),
    "WAV": lambda p: read_wave(p, columns="force:N", point="1", full_scale=1.0),
    "mesh": read_mesh,
    "matrix": read_matrix,
}
