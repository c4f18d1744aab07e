"""The walk through a street: its trees, its light, and its images beside mujoco-warp-pbr's own."""

# A kernel is Warp's language in Python's clothes; Warp itself checks its types when it compiles it.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false

import dataclasses

import mujoco
import numpy as np
import pytest
import warp as wp

from benchmarks.lib.megakernel import SharedAssets, WorldBatch
from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots.coco import make_coco
from urbanverse_mjx.simulation.rendering.model import build_render_model
from urbanverse_mjx.simulation.rendering.pbr_private import eval_sh9, rotate_yaw
from urbanverse_mjx.simulation.rendering.settings import Settings
from urbanverse_mjx.simulation.rendering.shapes import primitive_mesh
from urbanverse_mjx.simulation.rendering.street_batch import StreetBatch, Streets, sky_polynomials
from urbanverse_mjx.simulation.rendering.street_kernels import LIGHT, Street, module_options
from urbanverse_mjx.simulation.rendering.street_shade import sky_light
from urbanverse_mjx.simulation.rendering.street_tree import EMPTY, LEAF, NODE, SLACK, Trees, build_trees, joined

from . import render_cases as cases


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(8, seed=0)


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return make_coco()


def _items(trees: Trees, nodes: np.ndarray, root: int, box: tuple[np.ndarray, np.ndarray] | None = None) -> list:
    """(item, corners of the innermost box it stands in) of every item below a reference."""
    if root >= EMPTY:
        return []
    if root >= LEAF:
        first = root - LEAF
        last = first + int(np.argmax(trees.last[first:]))
        return [(int(i), box) for i in trees.order[first : last + 1]]
    node, found = nodes[root - NODE], []
    for side in (0, 2):
        child = int(node[side, 3:].copy().view(np.int32)[0])
        found += _items(trees, nodes, child, (node[side, :3], node[side + 1, :3]))
    return found


@pytest.mark.parametrize("leaf_size", [1, 4])
def test_every_item_stands_in_one_leaf_of_its_own_tree(leaf_size: int) -> None:
    rng = np.random.default_rng(0)
    group = rng.integers(0, 9, 500)
    group[group == 5] = 4  # tree 5 is empty
    group[group == 7] = 6
    group[0] = 7  # one object alone in tree 7
    lower = rng.uniform(-50, 50, (500, 3))
    upper = lower + rng.uniform(0, 4, (500, 3))
    lower[100:120], upper[100:120] = lower[100], upper[100]  # many in one place
    trees = build_trees(lower, upper, group, 9, leaf_size)
    front = trees.nodes[: len(trees.nodes) // 2]
    for nodes, roots in ((trees.nodes, trees.roots), joined(front, trees.nodes, trees.roots)):
        for tree in range(9):
            found = _items(trees, nodes, int(roots[tree]))
            assert sorted(i for i, _ in found) == np.flatnonzero(group == tree).tolist()
            for item, box in found:
                if box is not None:
                    assert (box[0] <= lower[item] - 0.9 * SLACK).all()
                    assert (box[1] >= upper[item] + 0.9 * SLACK).all()
    # As floats, no reference is one that arithmetic would touch.
    references = np.concatenate([trees.nodes[:, [0, 2], 3].ravel(), trees.roots.view(np.float32)])
    assert np.isfinite(references).all()
    assert (np.abs(references) > np.finfo(np.float32).tiny).all()


@wp.kernel
def _spherical(
    harmonics: wp.array2d[wp.vec3], yaw: wp.array[float], normals: wp.array[wp.vec3], out: wp.array2d[wp.vec3]
):
    i, j = wp.tid()
    out[i, j] = eval_sh9(harmonics, i, rotate_yaw(normals[j], -yaw[i]))


def test_the_polynomial_of_the_sky_is_its_spherical_harmonics() -> None:
    rng = np.random.default_rng(1)
    harmonics, yaw = rng.normal(size=(3, 9, 3)).astype(np.float32), rng.uniform(-4, 4, 3).astype(np.float32)
    harmonics[:, 0] += 9.0  # light is above 0, where it would be cut off
    normals = rng.normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    out = wp.zeros((3, 200), dtype=wp.vec3, device="cpu")
    arrays = [wp.array(harmonics, dtype=wp.vec3), wp.array(yaw, dtype=float), wp.array(normals, dtype=wp.vec3)]
    wp.launch(_spherical, dim=(3, 200), inputs=[*(a.to("cpu") for a in arrays), out], device="cpu")
    x, y, z = normals.T
    terms = np.stack([np.ones(200), x, y, z, x * x, y * y, x * y, y * z, x * z])
    found = np.einsum("ktc,tn->knc", sky_polynomials(harmonics, yaw), terms)
    np.testing.assert_allclose(found, out.numpy(), atol=2e-5)


@wp.kernel(module="unique", module_options=module_options(), enable_backward=False)
def _lit(street: Street, normals: wp.array[wp.vec3], out: wp.array2d[wp.vec3]):
    i, j = wp.tid()
    out[i, j] = sky_light(street, i, normals[j])


def test_the_light_of_the_sky_is_its_polynomial_in_any_direction() -> None:
    """Of two skies whose rows follow each other; nowhere below 0."""
    rng = np.random.default_rng(2)
    rows = rng.normal(size=(2, LIGHT, 3)).astype(np.float32)
    normals = rng.normal(size=(100, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    scalar = rng.normal(size=(2, LIGHT, 1)).astype(np.float32)  # belongs to other numbers of a scene
    table = wp.array(np.concatenate([rows, scalar], -1).reshape(-1, 4), dtype=wp.vec4, device="cpu")
    street = Street()
    street.lights = table.ptr
    out = wp.zeros((2, 100), dtype=wp.vec3, device="cpu")
    wp.launch(_lit, dim=(2, 100), inputs=[street, wp.array(normals, dtype=wp.vec3, device="cpu"), out], device="cpu")
    x, y, z = normals.T
    terms = np.stack([np.ones(100), x, y, z, x * x, y * y, x * y, y * z, x * z])
    expected = np.einsum("ktc,tn->knc", rows, terms)
    np.testing.assert_allclose(out.numpy(), np.maximum(expected, 0.0), atol=2e-5)
    assert (expected < 0.0).any()


def _draw_both(bank: SceneBank, robot: RobotSpec, places: cases.Places, settings: Settings) -> list[np.ndarray]:
    """Frames of our renderer and of mujoco-warp-pbr."""
    model, number = build_render_model(bank, robot), len(places.scene)
    camera = model.cameras[robot.camera]
    camera_positions, turns, turn, both = [], [], np.zeros(9), np.zeros(4)
    for p, q in zip(places.xpos[:, camera.body], places.xquat[:, camera.body], strict=True):
        mujoco.mju_quat2Mat(turn, q)
        mujoco.mju_mulQuat(both, q, camera.quaternion.astype(float))
        camera_positions.append(p + turn.reshape(3, 3) @ camera.position)
        turns.append(both.copy())
    with wp.ScopedDevice("cpu"):
        inputs = [
            wp.array(places.scene, dtype=int),
            wp.array(places.xpos, dtype=wp.vec3),
            wp.array(places.xquat, dtype=wp.vec4),
            wp.array(np.array(camera_positions), dtype=wp.vec3),
            wp.array(np.array(turns), dtype=wp.vec4),
            wp.full(number, camera.fovy, dtype=float),
            wp.zeros(number, dtype=int),
        ]
        ours, theirs = (wp.zeros((number, settings.height, settings.width, 3), dtype=wp.uint8) for _ in range(2))
        outputs = {"rgb": ours, "normal": wp.zeros((number, 0, 0), dtype=wp.vec3)}
        outputs |= {name: wp.zeros((number, 0, 0), dtype=int) for name in ("category", "object")}
        outputs["depth"] = wp.zeros((number, 0, 0), dtype=float)
        for job in StreetBatch(Streets(bank, model, settings), number, 1).jobs(inputs, outputs):
            job()
        WorldBatch(SharedAssets(bank, build_render_model(bank, robot, whole=True), settings), number).render(
            *inputs[:-1], rgb=theirs
        )
        return [ours.numpy().astype(int), theirs.numpy().astype(int)]


@pytest.mark.extended
@pytest.mark.parametrize("sky", [True, False])
def test_pbr_images_are_those_of_mujoco_warp_pbr(bank: SceneBank, robot: RobotSpec, sky: bool) -> None:
    """Polished, metallic and matte objects under sun and sky: an edge may fall on either side, colours agree."""
    rng = np.random.default_rng(2)
    number = len(bank.material_rgba)
    shiny = dataclasses.replace(
        bank,
        material_roughness=rng.choice([0.1, 0.4, 0.8, 1.0], number).astype(np.float32),
        material_metallic=rng.choice([0.0, 0.0, 0.7, 1.0], number).astype(np.float32),
    )
    places = cases.make_places(bank, robot, 8, seed=3)
    settings = Settings(cases.HEIGHT, cases.WIDTH, ("rgb",), True, sky, 1, "pbr")
    ours, theirs = _draw_both(shiny, robot, places, settings)
    difference = np.abs(ours - theirs).max(-1)
    assert theirs.std() > 20
    assert difference.mean() < 0.3
    assert (difference > 4).mean() < 0.01


SHAPES = {
    "box": (mujoco.mjtGeom.mjGEOM_BOX, (0.3, 0.2, 0.1), 8 * 0.3 * 0.2 * 0.1),
    "sphere": (mujoco.mjtGeom.mjGEOM_SPHERE, (0.3, 0.0, 0.0), 4 / 3 * np.pi * 0.3**3),
    "ellipsoid": (mujoco.mjtGeom.mjGEOM_ELLIPSOID, (0.3, 0.2, 0.1), 4 / 3 * np.pi * 0.3 * 0.2 * 0.1),
    "capsule": (mujoco.mjtGeom.mjGEOM_CAPSULE, (0.2, 0.4, 0.0), np.pi * 0.2**2 * (0.8 + 4 / 3 * 0.2)),
    "cylinder": (mujoco.mjtGeom.mjGEOM_CYLINDER, (0.2, 0.1, 0.0), np.pi * 0.2**2 * 0.2),
}


@pytest.mark.parametrize("name", SHAPES)
def test_primitives_are_closed_meshes_on_their_surfaces(name: str) -> None:
    """Volume by the divergence theorem, within the error of 128 slices; normals are those of faces and of `mj_ray`."""
    kind, size, volume = SHAPES[name]
    vertices, normals, faces = primitive_mesh(int(kind), np.array(size))
    corners = vertices[faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (flat * corners[:, 0]).sum() / 6 == pytest.approx(volume, rel=2e-3)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    assert (flat[:, None] * normals[faces]).sum(-1).min() > 0.99
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=kind, size=size)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rng = np.random.default_rng(0)
    for i in rng.choice(len(faces), 60):
        # From a millimetre outside the middle of a face.
        middle, hit = corners[i].mean(0) + 1e-3 * flat[i], np.zeros(1, np.int32)
        assert mujoco.mj_ray(model, data, middle, -flat[i], None, 1, -1, hit) == pytest.approx(1e-3, abs=2e-4)


def test_a_geom_without_a_surface_is_named() -> None:
    with pytest.raises(ValidationError, match=r"mjGEOM_PLANE.*needed a mesh"):
        primitive_mesh(int(mujoco.mjtGeom.mjGEOM_PLANE), np.ones(3))
