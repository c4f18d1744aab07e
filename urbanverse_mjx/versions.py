"""Version numbers of the code that produces cached data.

A cache key is a hash of data (graphs, tables, options, versions of libraries) and of these numbers, never of source
text, so an edited comment invalidates no cache. A test compares the modules of each number with stored digests of their
syntax trees and fails at every change of code; the developer then raises the number or confirms that the change does
not affect results (`tests/project/test_versions.py`).
"""

import dataclasses
from collections.abc import Mapping


@dataclasses.dataclass(frozen=True)
class Code:
    """The modules covered by one version number.

    Attributes:
      version: raised whenever these modules produce different results for the same input.
      modules: names below `urbanverse_mjx`; a package stands for all modules and data below it.
      uses: names of entries whose code these modules call or whose results they read.
      apart: modules below `modules` that do not affect the results.
    """

    version: int
    modules: tuple[str, ...]
    uses: tuple[str, ...] = ()
    apart: tuple[str, ...] = ()


def _below(package: str, *names: str) -> tuple[str, ...]:
    return tuple(f"{package}.{name}" for name in names)


CODE: Mapping[str, Code] = {
    # All other versions depend on it.
    "datatypes": Code(1, ("datatypes", "geometry", "srgb")),
    # Base meshes, by recipe and variant.
    "meshes": Code(
        2,
        (
            "assets.recipes",
            *_below("assets.categories", "materials", "ontology", "priors"),
            *_below("assets.meshes", "atlas", "mesh_builder", "mesh_cache", "paint", "palette", "panels"),
            *_below("assets.meshes", "recipe", "shapes"),
        ),
        ("datatypes",),
    ),
    # Records of all assets, their hulls, and the scaling of instances.
    "catalogue": Code(
        1,
        (
            *("assets.categories.physical", "assets.collision.hulls"),
            *_below(
                "assets.meshes",
                "base_shapes",
                "crowns",
                "glb",
                "instances",
                "laying",
                "repaint",
                "sheets",
                "table_files",
                "tints",
            ),
            *_below("assets.records", "catalogue", "index", "record_texts", "regional", "store", "user_store"),
        ),
        ("meshes",),
    ),
    # Ground materials and skies with their descriptors.
    "appearances": Code(
        1,
        ("assets.appearances", "assets.selection.descriptors"),
        ("catalogue",),
    ),
    "thumbnails": Code(1, _below("assets.previews", "gallery", "thumbnails"), ("catalogue",)),
    # Layouts; the number is part of their hashes.
    "cousins": Code(
        3,
        (
            "materialisation",
            *("assets.categories.labels", "assets.categories.semantics", "assets.records.annotations"),
            *_below("assets.collision", "decompose", "lying", "rest_poses", "rigid_body"),
            *_below("assets.selection", "integrity", "matching", "neural", "search"),
        ),
        ("appearances", "thumbnails"),
    ),
    # What the regional look adds to layouts and compiled scenes; only scenes that have it depend on it.
    "look": Code(
        1,
        (
            *("materialisation.exchange", "scene.backdrop"),
            *_below("assets.recipes.building.regional", "boards", "words"),
        ),
        ("scenes",),
    ),
    "scenes": Code(
        4,
        (
            *("scene", "robots", "pipeline.scenes", "pipeline.generation.compiling"),
            *("assets.collision", "assets.exporting.usd_parts", "assets.meshes.agents"),
        ),
        ("cousins",),
        ("scene.library",),
    ),
    "bank": Code(1, ("pipeline.banks",), ("scenes",)),
    "rendering": Code(1, _below("simulation", "rendering", "segments", "threads", "warp_bridge"), ("datatypes",)),
    # Images and numbers on the gallery page of scenes.
    "cards": Code(2, _below("viz", "graphs", "images", "scene_cards", "scene_gallery"), ("scenes", "rendering")),
    # Frames and recordings from videos.
    "perception": Code(
        8,
        (
            *("distillation.perception", "distillation.perception_model", "assets.importing.vision"),
            *_below("pipeline.generation", "listing", "perceiving", "predictors", "video_options"),
        ),
        ("imports",),
        _below("distillation.perception_model", "augment", "conditions", "naming", "score", "targets", "views"),
    ),
    "distillation": Code(
        9,
        ("distillation", "pipeline.generation.distilling", "assets.selection.label_priors"),
        ("appearances",),
        (
            *_below("distillation", "fit_trust", "perception", "readers", "train_perception"),
            # Objects are named by the leaves and by `naming`; the network itself is a part of perception.
            *_below("distillation.perception_model", "augment", "conditions", "decode", "inference", "network"),
            *_below("distillation.perception_model", "scales", "score", "targets", "views", "weights"),
        ),
    ),
    "report": Code(
        2,
        (
            "datasets.video",
            *_below("pipeline.generation", "records", "report"),
            *_below("viz", "graphs", "images"),
        ),
        ("rendering", "scenes"),
    ),
    # Stages of a run; the code that they call has its own versions.
    "generation": Code(
        2,
        _below("pipeline.generation", "checks", "embeddings", "stages"),
        ("bank", "distillation", "perception", "report"),
    ),
    # Scenes of the library.
    "library": Code(1, ("pipeline.library.building",), ("bank",)),
    # Assets imported from the user's files.
    "imports": Code(2, ("assets.importing", "assets.collision"), ("catalogue", "thumbnails")),
    # Walkable and drivable cells of agents, and distance fields around the robot.
    "crowds": Code(1, ("crowds", "envs.navigation.dynamic_tables"), ("datatypes",)),
    "surroundings": Code(1, ("envs.navigation.surroundings",), ("datatypes",)),
    # Distances to outlines for the arcs that a teacher is told.
    "clear_arcs": Code(1, _below("envs.navigation", "clear_arcs", "clearance_maps"), ("crowds",)),
    # Episode tables of tasks.
    "routes": Code(
        1,
        _below("envs.navigation", "clearance_maps", "tasks.carriageways", "tasks.crosswalks", "tasks.routes"),
        ("crowds", "surroundings"),
    ),
    # Episodes that ask for objects.
    "object_goals": Code(
        1,
        (
            "envs.navigation.clearance_maps",
            *_below("envs.navigation.tasks", "colours", "object_episodes", "object_names"),
        ),
        ("crowds", "surroundings"),
    ),
    # Posts with doorbells, parcel boxes, and their episodes.
    "doorbells": Code(
        1,
        (
            "envs.navigation.clearance_maps",
            *_below("envs.navigation.tasks", "boxes", "doorbells", "furniture", "posts"),
        ),
        ("crowds", "surroundings"),
    ),
    # City blocks; the number is part of their seed.
    "blocks": Code(1, ("citygen.city_blocks", *_below("citygen", "catalogue", "clearance", "section")), ("cousins",)),
}


def of(*names: str) -> dict[str, int]:
    """Returns the versions of some code and of all code that it uses, by name, for use in cache keys.

    Raises:
      KeyError: no entry has this name.
    """
    found: dict[str, int] = {}
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = CODE[name].version
            waiting += CODE[name].uses
    return dict(sorted(found.items()))
