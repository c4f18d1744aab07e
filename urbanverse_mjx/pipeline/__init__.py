"""The Python API of the `urbanverse` command: one function per task; the command prints their results.

    from urbanverse_mjx import pipeline

    pipeline.generate("walk.mp4", "runs/walk")
    bank = pipeline.build_bank(["graph.json"], ["test"])
    pipeline.play("rollout.mp4", pipeline.PlayOptions(policy="go_to_goal"))

Names are imported on first use, so that importing the package loads no heavy module.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .banks import (
        build_bank,
        build_shards,
        build_terrain_bank,
        cached_bank,
        ensure_default_bank,
        ensure_terrain_bank,
        join_banks,
        join_shards,
        shipped_scenes,
    )
    from .benchmarking import BenchmarkOptions, BenchmarkRun, benchmark
    from .deploying import DeployOptions, deploy, replay
    from .evaluation import evaluate_policy
    from .filming import CaptureOptions, capture
    from .gallery import Gallery, draw_gallery
    from .generation.batch import run_batch
    from .generation.importing import import_authors_tree, import_colmap, import_kitti360
    from .generation.stages import GenerationOptions, generate
    from .generation.video_options import VideoOptions
    from .generation.weights import fetch_weights
    from .library.sets import LibraryBuild, LibraryOptions, build_library
    from .playing import PlayOptions, play
    from .recording.datasets import check_dataset, dataset_page, summarise_dataset
    from .recording.record import RecordOptions, record
    from .robot_simulation import SimulationOptions, simulate_robot
    from .routes import plan_routes
    from .scenes import compile_graph, compile_layout, make_controller
    from .study import StudyFiles, StudyOptions, analyse_study, compare_layouts, make_study
    from .training_run import TrainOptions, train
    from .viewing import ViewOptions, view

#: Name -> module below this package that defines it.
_HOMES = {
    "BenchmarkOptions": "benchmarking",
    "BenchmarkRun": "benchmarking",
    "CaptureOptions": "filming",
    "DeployOptions": "deploying",
    "Gallery": "gallery",
    "GenerationOptions": "generation.stages",
    "LibraryBuild": "library.sets",
    "LibraryOptions": "library.sets",
    "PlayOptions": "playing",
    "RecordOptions": "recording.record",
    "SimulationOptions": "robot_simulation",
    "StudyFiles": "study",
    "StudyOptions": "study",
    "VideoOptions": "generation.video_options",
    "ViewOptions": "viewing",
    "TrainOptions": "training_run",
    "analyse_study": "study",
    "benchmark": "benchmarking",
    "build_bank": "banks",
    "build_shards": "banks",
    "build_library": "library.sets",
    "build_terrain_bank": "banks",
    "cached_bank": "banks",
    "capture": "filming",
    "check_dataset": "recording.datasets",
    "dataset_page": "recording.datasets",
    "compare_layouts": "study",
    "compile_graph": "scenes",
    "compile_layout": "scenes",
    "deploy": "deploying",
    "draw_gallery": "gallery",
    "ensure_default_bank": "banks",
    "ensure_terrain_bank": "banks",
    "evaluate_policy": "evaluation",
    "fetch_weights": "generation.weights",
    "generate": "generation.stages",
    "import_authors_tree": "generation.importing",
    "import_colmap": "generation.importing",
    "import_kitti360": "generation.importing",
    "join_banks": "banks",
    "join_shards": "banks",
    "make_controller": "scenes",
    "make_study": "study",
    "plan_routes": "routes",
    "play": "playing",
    "record": "recording.record",
    "replay": "deploying",
    "run_batch": "generation.batch",
    "shipped_scenes": "banks",
    "simulate_robot": "robot_simulation",
    "summarise_dataset": "recording.datasets",
    "train": "training_run",
    "view": "viewing",
}

__all__ = [
    "BenchmarkOptions",
    "BenchmarkRun",
    "CaptureOptions",
    "DeployOptions",
    "Gallery",
    "GenerationOptions",
    "LibraryBuild",
    "LibraryOptions",
    "PlayOptions",
    "RecordOptions",
    "SimulationOptions",
    "StudyFiles",
    "StudyOptions",
    "TrainOptions",
    "VideoOptions",
    "ViewOptions",
    "analyse_study",
    "benchmark",
    "build_bank",
    "build_library",
    "build_shards",
    "build_terrain_bank",
    "cached_bank",
    "capture",
    "check_dataset",
    "compare_layouts",
    "compile_graph",
    "compile_layout",
    "dataset_page",
    "deploy",
    "draw_gallery",
    "ensure_default_bank",
    "ensure_terrain_bank",
    "evaluate_policy",
    "fetch_weights",
    "generate",
    "import_authors_tree",
    "import_colmap",
    "import_kitti360",
    "join_banks",
    "join_shards",
    "make_controller",
    "make_study",
    "plan_routes",
    "play",
    "record",
    "replay",
    "run_batch",
    "shipped_scenes",
    "simulate_robot",
    "summarise_dataset",
    "train",
    "view",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
