"""Both renderers of benchmarks.transfer, through every lens, show an object where its direction says."""

import math
import os
import pathlib

import mujoco
import numpy as np
import pytest

from benchmarks.lib import shifts as s
from benchmarks.lib.street_world import World
from tests.support.box_bank import KERB, street_regions
from tests.support.toy_assets import TOY_SOURCE, few_episodes, toy_index, toy_layout
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, Source
from urbanverse_mjx.pipeline import make_controller
from urbanverse_mjx.scene import compile_scene

SIZE = 90, 160
#: m, an orange post: place of its foot, and height.
POST, HEIGHT = np.array([20.0, 6.6, KERB]), 1.0
LENSES = {"pinhole": {}, "fisheye": {"fisheye": True}, "distortion": {"distortion": 1.0}}


@pytest.fixture(scope="module")
def street(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    place = (POST[0], POST[1], KERB + HEIGHT / 2)
    post = GraphObject("post", "bollard", place, (0.3, 0.3, HEIGHT), 0.0)
    graph = SceneGraph("toy_street", Source("hand", "Apache-2.0", "none", "none"), (post,), tuple(street_regions()))
    out = tmp_path_factory.mktemp("scene") / "toy"
    with few_episodes():
        compile_scene(toy_layout(graph, 3), toy_index(), out, make_controller(), source=TOY_SOURCE)
    return out


@pytest.fixture(scope="module")
def opengl() -> None:
    if os.environ.get("MUJOCO_GL") not in ("egl", "osmesa"):
        pytest.skip("needs off-screen OpenGL: MUJOCO_GL=egl or osmesa")
    try:
        mujoco.Renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 8, 8).close()
    except Exception as error:  # what a missing driver raises differs
        pytest.skip(f"no off-screen OpenGL: {error}")


def _pixel(rays: np.ndarray, direction: np.ndarray) -> tuple[int, int]:
    """Row and column whose ray is nearest to a direction (x right, y down, z ahead)."""
    at = (rays @ (direction / np.linalg.norm(direction))).argmax()
    return divmod(int(at), rays.shape[1])


def _shown(street: pathlib.Path, lens: str, renderer: bool) -> None:
    shifts = s.Shifts(renderer=renderer, **LENSES[lens])
    world = World.load(street, "coco", shifts, SIZE, {"shading": "matte"})
    fovy = math.radians(float(world.model.camera("robot/front_cam").fovy[0]))
    rays = {
        "pinhole": s.pinhole_rays(*SIZE, fovy),
        "fisheye": s.fisheye_rays(*SIZE, fovy),
        "distortion": s.brown_rays(*SIZE, fovy, s.BROWN),
    }[lens]
    for aside, turn in ((-1.2, 0.35), (0.6, -0.25)):
        world.begin(np.array([POST[0] - 3.0, POST[1] + aside, KERB, turn]), s.Shifts().draw((1,)))
        image = world.image().astype(int)
        assert image.shape == (*SIZE, 3)
        camera = world.model.camera("robot/front_cam").id
        mujoco.mj_camlight(world.model, world.data)
        # MuJoCo's camera looks along -z with y up.
        axes = world.data.cam_xmat[camera].reshape(3, 3) @ np.diag([1.0, -1.0, -1.0])
        middle = POST + [0.0, 0.0, 0.6 * HEIGHT]
        row, column = _pixel(rays, (middle - world.data.cam_xpos[camera]) @ axes)
        orange = (image[..., 0] > 1.5 * image[..., 2]) & (image[..., 0] > 40)
        assert orange[row, column], (lens, renderer, aside)
        # The post alone is orange, and its middle is where its pixels are.
        rows, columns = np.nonzero(orange)
        assert 20 < len(rows) < 0.1 * orange.size
        assert abs(columns.mean() - column) < 2.0, (lens, renderer, aside)
    world.close()


@pytest.mark.slow
@pytest.mark.parametrize("lens", LENSES)
def test_our_renderer_shows_the_post_in_its_direction(street: pathlib.Path, lens: str) -> None:
    _shown(street, lens, False)


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
@pytest.mark.parametrize("lens", LENSES)
def test_mujoco_s_renderer_shows_the_post_in_its_direction(street: pathlib.Path, lens: str) -> None:
    _shown(street, lens, True)
