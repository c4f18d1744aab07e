"""Version numbers of the code that makes what caches hold.

A key in a cache is a hash of data (graphs, tables, options, versions of libraries) and of these numbers, never of
source text: an edited comment invalidates no cache. A test compares the modules behind each number with stored digests
of their syntax trees and fails at every change of code; the developer then raises the number or confirms that the
change has no effect (`tests/project/test_versions.py`).
"""

import dataclasses
from collections.abc import Mapping


@dataclasses.dataclass(frozen=True)
class Code:
    """The code behind one version number.

    Attributes:
      version: raised whenever these modules make anything else of the same input.
      modules: names below `urbanverse_mjx`; a package stands for all modules and data below it.
      uses: names of the code whose results these modules are made from, or which they call.
      apart: modules below `modules` that have no part in the results.
    """

    version: int
    modules: tuple[str, ...]
    uses: tuple[str, ...] = ()
    apart: tuple[str, ...] = ()


def _below(package: str, *names: str) -> tuple[str, ...]:
    return tuple(f"{package}.{name}" for name in names)


CODE: Mapping[str, Code] = {
    # The base of all other versions.
    "datatypes": Code(1, ("datatypes", "geometry")),
    # Base meshes, by recipe and variant.
    "meshes": Code(
        1,
        (
            "assets.recipes",
            *_below("assets.categories", "materials", "ontology", "priors"),
            *_below("assets.meshes", "atlas", "mesh_builder", "mesh_cache", "paint", "palette", "panels"),
            *_below("assets.meshes", "recipe", "shapes"),
        ),
        ("datatypes",),
    ),
    # The records of all assets, their hulls, and the scaling of instances.
    "catalogue": Code(
        1,
        (
            *("assets.categories.physical", "assets.collision.hulls"),
            *_below("assets.meshes", "base_shapes", "glb", "instances", "table_files", "tints"),
            *_below("assets.records", "catalogue", "index", "record_texts", "store", "user_store"),
        ),
        ("meshes",),
    ),
    # Ground materials and skies, and the numbers by which they are compared.
    "appearances": Code(
        1,
        ("assets.appearances", "assets.selection.descriptors"),
        ("catalogue",),
    ),
    "thumbnails": Code(1, _below("assets.previews", "gallery", "thumbnails"), ("catalogue",)),
    # Layouts; the number stands in their hashes.
    "cousins": Code(
        3,
        (
            "materialisation",
            *("assets.categories.labels", "assets.categories.semantics", "assets.records.annotations"),
            *_below("assets.selection", "integrity", "matching", "neural", "search"),
        ),
        ("appearances", "thumbnails"),
    ),
    "scenes": Code(
        2,
        (
            *("scene", "robots", "pipeline.scenes", "pipeline.generation.compiling"),
            *("assets.collision", "assets.exporting.usd_parts", "assets.meshes.agents"),
        ),
        ("cousins",),
        ("scene.library",),
    ),
    "bank": Code(1, ("pipeline.banks",), ("scenes",)),
    "rendering": Code(1, _below("simulation", "rendering", "warp_bridge"), ("datatypes",)),
    # Images and numbers on the page of scenes.
    "cards": Code(2, _below("viz", "graphs", "images", "scene_cards", "scene_gallery"), ("scenes", "rendering")),
    # Frames and recordings from videos.
    "perception": Code(
        2,
        (
            *("distillation.perception", "distillation.perception_model", "assets.importing.vision"),
            *_below("pipeline.generation", "listing", "perceiving", "predictors", "video_options"),
        ),
        ("imports",),
        _below("distillation.perception_model", "augment", "score", "targets", "views"),
    ),
    "distillation": Code(
        3,
        ("distillation", "pipeline.generation.distilling", "assets.selection.label_priors"),
        ("appearances",),
        _below("distillation", "perception_model", "fit_trust", "perception", "readers", "train_perception"),
    ),
    "report": Code(
        1,
        (
            *_below("pipeline.generation", "records", "report", "report_map", "report_images"),
            *_below("viz", "graphs", "images"),
        ),
        ("cousins", "rendering"),
    ),
    # The stages of a run; the code that each calls has numbers of its own.
    "generation": Code(2, ("pipeline.generation.stages",), ("bank", "distillation", "perception", "report")),
    # The scenes of the library.
    "library": Code(1, ("pipeline.library.building",), ("bank",)),
    # The user's assets from files.
    "imports": Code(1, ("assets.importing", "assets.collision"), ("catalogue", "thumbnails")),
    # Where the agents of a scene may go, and how far a robot is from what surrounds it.
    "crowds": Code(1, ("crowds", "envs.navigation.dynamic_tables"), ("datatypes",)),
    "surroundings": Code(1, ("envs.navigation.surroundings",), ("datatypes",)),
    # Blocks after the statistics of a city; the number seeds them.
    "blocks": Code(1, ("citygen.city_blocks", *_below("citygen", "catalogue", "clearance", "section")), ("cousins",)),
}


def of(*names: str) -> dict[str, int]:
    """The versions of some code and of all that it uses, by name: which a key holds instead of that code.

    Raises:
      KeyError: no code of that name.
    """
    found: dict[str, int] = {}
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = CODE[name].version
            waiting += CODE[name].uses
    return dict(sorted(found.items()))
