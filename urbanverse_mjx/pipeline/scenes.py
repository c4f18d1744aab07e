"""Compiles scene graphs and layouts."""

import functools
import os
import pathlib
from typing import TYPE_CHECKING

import numpy as np

from ..datatypes import SceneGraph
from ..datatypes import validation as v
from ..datatypes.scene_layout import HULL_KINDS

if TYPE_CHECKING:
    from ..assets import AssetIndex
    from ..datatypes import SceneLayout, Source
    from ..materialisation import Cousin
    from ..scene import CompiledScene, Controller, EpisodeRules


def compile_graph(
    graph: str | os.PathLike[str],
    out: str | os.PathLike[str],
    seed: int = 0,
    cousin: int = 0,
    skip_unknown: bool = False,
    half: int = 0,
    movable: bool = False,
    imported: bool = False,
    regional: bool = False,
    hulls: str = "",
) -> "tuple[Cousin, CompiledScene]":
    """Reads a graph, materialises one of its cousins and compiles it; episodes are driven by COCO with differential
    drive.

    The layout is the same as that of `generate` and the scene library for the same graph, seed and cousin. Objects that
    do not stay in place for two seconds of C MuJoCo are fixed.

    Args:
      graph: graph.json.
      out: output folder; an older compiled scene in it is replaced when the new one is complete.
      seed: seed of the choice among equally good assets, materials and skies, and of the episodes.
      cousin: number of the digital cousin, 0 to 63.
      skip_unknown: whether to leave out objects whose label has no asset instead of raising an error.
      half: 1 or 2 for only that half of the street, cut across its centre; 0 for all of it.
      imported: whether to use the assets that the user imported too.
      movable: whether to write movable objects as free bodies at rest in C MuJoCo; otherwise `scene.xml` is static.
      regional: whether the scene has the look of the graph's city (`materialisation.regional`).
      hulls: "close" or "close-2" for collision hulls that stand out less where a robot can touch them, "" for the
        first ones.

    Raises:
      ValidationError: the graph is invalid, or no tradition serves its city; no file is written.
    """
    from ..scene.compiler import check_out_dir
    from ..scene.ground import check_regions

    v.choice(str(half), "--half", ("0", "1", "2"))
    v.choice(hulls, "--hulls", HULL_KINDS)
    graph, out = pathlib.Path(graph), pathlib.Path(out)
    check_out_dir(out)
    scene = SceneGraph.load(graph)
    check_regions(scene.ground)
    from ..materialisation import (
        check_city,
        check_labels,
        check_placed,
        check_plausible,
        index_of,
        localise,
        materialise_cousin,
    )
    from ..scene.halves import half_layouts

    check_plausible(scene)
    objects = None
    if imported:
        from ..assets.selection.search import full_library

        objects = full_library()
    if not skip_unknown:
        check_labels(scene, objects)
    if regional:
        check_city(scene)
    made = materialise_cousin(scene, cousin, seed, objects=objects, hulls=hulls)
    check_placed(scene, [made])
    if regional:
        made = localise(made, scene, index_of(made.layout, objects))
    layout = half_layouts(made.layout)[half - 1] if half else made.layout
    index = index_of(layout, objects)
    return made, compile_layout(layout, index, out, freeze_unstable=True, place=scene.source, movable=movable)


def compile_layout(
    layout: "SceneLayout",
    index: "AssetIndex",
    out: pathlib.Path,
    rules: "EpisodeRules | None" = None,
    freeze_unstable: bool = False,
    place: "Source | None" = None,
    movable: bool = False,
) -> "CompiledScene":
    """Compiles a layout; episodes are driven by COCO with differential drive.

    Args:
      layout: layout of the scene.
      index: index of its assets.
      out: output folder, which is replaced if it holds a compiled scene.
      rules: rules of the episodes.
      freeze_unstable: whether objects that do not stay in place for two seconds of C MuJoCo are fixed.
      place: the scene's model city, for its metadata.
      movable: see `compile_graph`.

    Raises:
      ValidationError: see `scene.compile_scene`.
    """
    from ..scene.compiler import compile_scene

    return compile_scene(
        layout,
        index,
        out,
        make_controller(),
        rules=rules,
        freeze_unstable=freeze_unstable,
        place=place,
        movable=movable,
    )


@functools.cache
def make_controller() -> "Controller":
    """Makes the controller of COCO with waypoints as commands, with NumPy input and output."""
    import jax
    import jax.numpy as jnp

    from ..robots import make_coco
    from ..scene.drive import CONTROL_PERIOD, Controller

    robot = make_coco()
    batch = jax.jit(jax.vmap(lambda w: robot.command(jnp.stack(robot.waypoint_to_velocity(w, CONTROL_PERIOD)))))
    cpu = jax.devices("cpu")[0]

    def command(waypoints: np.ndarray) -> np.ndarray:
        with jax.default_device(cpu):
            return np.asarray(batch(waypoints))

    return Controller(robot, command)
