"""Hand-made scenes compiled: each has its episodes, and the engine misses no hull and no piece of ground in it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.assets.appearances.skies import build_sky
from urbanverse_mjx.citygen import craftbench, validation_streets
from urbanverse_mjx.datatypes import traversable
from urbanverse_mjx.materialisation import index_of, materialise_cousins
from urbanverse_mjx.pipeline import make_controller
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.scene.compiler import compile_scene
from urbanverse_mjx.scene.episodes import EpisodeRules
from urbanverse_mjx.simulation.jax_engine import JaxEngine
from urbanverse_mjx.simulation.parity.drives import ground_height

BUILDERS = {**craftbench.BUILDERS, **validation_streets.BUILDERS}
POSES, ROWS = 10_000, 512


@pytest.mark.slow
@pytest.mark.parametrize("scene_id", list(BUILDERS))
def test_a_hand_made_scene_compiles_whole(scene_id, tmp_path):
    (cousin,) = materialise_cousins(BUILDERS[scene_id]().graph(), 1)
    assert len(cousin.left_out) <= 2
    rules = EpisodeRules(rows=ROWS)
    layout = cousin.layout
    compiled = compile_scene(
        layout, index_of(layout), tmp_path / "scene", make_controller(), rules=rules, freeze_unstable=True
    )
    geometry = compiled.geometry
    assert len(geometry.episodes.start) == ROWS
    bank = pack([geometry], ["test"], {geometry.sky: build_sky(geometry.sky)})

    engine = JaxEngine(bank, make_coco("differential"), control_dt=0.2)
    rng = np.random.default_rng(7)
    cells = np.argwhere(traversable(bank.map_kind[0]))
    chosen = cells[rng.integers(0, len(cells), POSES)]
    xy = bank.map_origin[0] + (chosen + rng.random(chosen.shape)) * float(bank.map_resolution)
    place = jnp.asarray(np.column_stack([xy, ground_height(bank, 0, xy) + engine.robot.spawn_height]), jnp.float32)
    nearby, missing = jax.jit(jax.vmap(engine.find_slots))(jnp.zeros(POSES, jnp.int32), place)
    assert int(missing.max()) == 0
    # Scenes with empty slots would not test the limit.
    assert np.asarray(nearby.valid)[:, : engine.num_slots].sum(1).max() >= engine.num_slots // 2
