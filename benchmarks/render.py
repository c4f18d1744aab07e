"""Measures the throughput of the renderer alone: frames per second of each shading, style and size, and of other
renderers.

    python -m benchmarks.render --cases 135x240@1024,36x64@4096 --styles plain,shadows

renders robots at random positions on all scenes' routes, different in every env and frame. Each result is one JSON
line, written to `--out` (and printed with `--json`) immediately; a failed configuration writes its error and the next
one follows. In addition to our two shadings, `megakernel` is the original mujoco-warp-pbr (the images of `pbr`, with a
tree per world) and `stock` is MuJoCo Warp's renderer over the same scenes, meshes and trees; both run without JAX on
one thread.

`frames_per_s` counts frames through `jax.jit(lax.scan(vmap(renderer)))`; `bare_ms` is a batch without JAX, and
`place_ms` the part of it before any ray is cast (poses, and the refit of trees where there are any).
"""

import argparse
import dataclasses
import gc
import json
import pathlib
import sys
import time
import traceback
from collections.abc import Callable, Iterable
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from benchmarks.lib import timing
from benchmarks.lib.megakernel import SharedAssets, WorldBatch
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering import street_draw
from urbanverse_mjx.simulation.rendering.model import build_render_model
from urbanverse_mjx.simulation.rendering.renderer import Renderer

SHADINGS = ("matte", "pbr", "megakernel", "stock")
#: Options of each style that differ from the default: sky, textures, direct light, one ray per pixel.
STYLES: dict[str, dict[str, Any]] = {
    "plain": {},
    "baked": {"light": "baked"},
    "shadows": {"shadows": True},
    "no-sky": {"sky": False},
    "no-textures": {"textures": False},
    "four-rays": {"samples": 2},
    "all-outputs": {"outputs": ("rgb", "depth", "category", "object", "normal")},
}
#: Number of sets of positions, used in turn.
PLACES = 4
KEPT_FRAMES = 6


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.render", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument(
        "--bank",
        type=pathlib.Path,
        nargs="+",
        help="bank files, each measured in every configuration before the next one (default: the shipped streets)",
    )
    parser.add_argument("--cases", default="135x240@1024,36x64@4096", help="HEIGHTxWIDTH@ENVS, ...")
    parser.add_argument("--shadings", default=",".join(SHADINGS))
    parser.add_argument("--styles", "--looks", default="plain,shadows", help=f"of {', '.join(STYLES)}")
    parser.add_argument("--frames", type=int, default=8, help="batches in one timed call")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=230.0, help="no configuration begins after this")
    parser.add_argument("--threads", type=int, help="on the CPU (default: all cores)")
    parser.add_argument("--blocks", default="", help="THREADSxBLOCKS, ...: our kernels with these launch bounds")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=pathlib.Path, help="file for the JSON lines; images go to its .npz")
    parser.add_argument("--json", action="store_true", help="print the JSON lines, too")
    arguments = parser.parse_args(argv)
    try:
        arguments.cases = [tuple(map(int, case.replace("@", "x").split("x"))) for case in arguments.cases.split(",")]
        assert all(len(case) == 3 and min(case) > 0 for case in arguments.cases)
        arguments.blocks = [tuple(map(int, b.split("x"))) for b in arguments.blocks.split(",") if b] or [None]
    except (ValueError, AssertionError):
        parser.error("--cases: needed HEIGHTxWIDTH@ENVS such as 36x64@4096; --blocks: THREADSxBLOCKS such as 64x8")
    for name, known in (("shadings", SHADINGS), ("styles", tuple(STYLES))):
        setattr(arguments, name, getattr(arguments, name).split(","))
        if set(getattr(arguments, name)) - set(known):
            parser.error(f"--{name}: needed some of {', '.join(known)}")
    return arguments


def random_places(bank: SceneBank, robot: RobotSpec, number: int, seed: int) -> tuple[np.ndarray, ...]:
    """Returns scene (n,), xpos (n, nbody, 3), xquat (n, nbody, 4) of robots on routes of all scenes with random
    headings."""
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    data.qpos[:3], data.qpos[3:7] = 0.0, (1.0, 0.0, 0.0, 0.0)
    mujoco.mj_kinematics(model, data)
    scene = (np.arange(number) % bank.num_scenes).astype(np.int32)
    row = rng.integers(bank.num_episodes[scene])
    point = rng.integers(np.maximum(bank.episode_num_waypoints[scene, row], 1))
    place = bank.episode_waypoints[scene, row, point].astype(np.float64)
    yaw = rng.uniform(-np.pi, np.pi, number)
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x, y, z = np.moveaxis(data.xpos, 1, 0)
    xpos = np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (number, len(z)))], -1) + place[:, None]
    xpos[..., 2] += robot.spawn_height
    xquat = rotations.product(rotations.from_yaw(yaw[:, None]), data.xquat)
    # The world body is static and not rendered.
    return scene, xpos.astype(np.float32), xquat.astype(np.float32)


def through_jax(renderer: Renderer, places: list[tuple[np.ndarray, ...]], frames: int) -> Callable[[], Any]:
    """Returns a compiled call that renders `frames` batches in a scan with the positions in turn."""
    stacked = tuple(jnp.asarray(np.stack([p[i] for p in places])) for i in range(3))

    def scan(arrays: Any) -> Any:
        def frame(total: Any, number: Any) -> tuple[Any, None]:
            pixels = jax.vmap(renderer)(*(x[number % len(places)] for x in arrays))["rgb"]
            # A sum over a few pixels prevents the compiler from removing the frame, at no cost.
            return total + pixels[:, 0, 0].astype(jnp.float32).sum(), None

        return jax.lax.scan(frame, jnp.float32(0.0), jnp.arange(frames))[0]

    call = jax.jit(scan).lower(stacked).compile()
    return lambda: call(stacked)


class Bare:
    """Renders the same frames without JAX from existing Warp arrays."""

    def __init__(self, renderer: Renderer, place: tuple[np.ndarray, ...]) -> None:
        scene, xpos, xquat = place
        camera, number, settings = renderer.camera, len(scene), renderer.settings
        assert camera is not None, "the renderer has a robot"
        turn, both, camera_positions, turns = np.zeros(9), np.zeros(4), [], []
        for p, q in zip(xpos[:, camera.body], xquat[:, camera.body].astype(float), strict=True):
            mujoco.mju_quat2Mat(turn, q)
            camera_positions.append(p + turn.reshape(3, 3) @ camera.position)
            mujoco.mju_mulQuat(both, q, camera.quaternion.astype(float))
            turns.append(both.copy())
        self.renderer, self.number, self.device = renderer, number, wp.get_preferred_device()
        with wp.ScopedDevice(self.device):
            self.inputs = [
                wp.array(scene, dtype=int),
                wp.array(xpos, dtype=wp.vec3),
                wp.array(xquat, dtype=wp.vec4),
                wp.array(np.array(camera_positions), dtype=wp.vec3),
                wp.array(np.array(turns), dtype=wp.vec4),
                wp.full(number, camera.fovy, dtype=float),
                wp.zeros(number, dtype=int),
            ]
            self.outputs = {"rgb": wp.zeros((number, settings.height, settings.width, 3), dtype=wp.uint8)}
            for name, dtype in {"depth": float, "category": int, "object": int, "normal": wp.vec3}.items():
                size = (settings.height, settings.width) if name in settings.outputs else (0, 0)
                self.outputs[name] = wp.zeros((number, *size), dtype=dtype)

    def draw(self) -> None:
        with wp.ScopedDevice(self.device):
            self.renderer._render(self.inputs, list(self.outputs.values()))

    def place(self) -> None:
        """Runs the work before ray casting."""
        _, batch = self.renderer._batch(self.device, self.number)
        with wp.ScopedDevice(self.device):
            batch.jobs(self.inputs, self.outputs)


class Megakernel(Bare):
    """mujoco-warp-pbr's kernel with a tree per world; `stock`: MuJoCo Warp's renderer over the same trees."""

    def __init__(self, renderer: Renderer, place: tuple[np.ndarray, ...], stock: bool) -> None:
        super().__init__(renderer, place)
        with wp.ScopedDevice(self.device):
            assets = SharedAssets(
                renderer.bank, build_render_model(renderer.bank, make_coco(), whole=True), renderer.settings
            )
            self.batch = WorldBatch(assets, self.number)
            self.place()
            self.stock = self._stock(assets, self.batch) if stock else None

    @staticmethod
    def _stock(assets: SharedAssets, batch: WorldBatch) -> Any:
        context = mjw.create_render_context(
            assets.render_model.model,
            nworld=1,
            cam_res=(assets.settings.width, assets.settings.height),
            render_rgb=True,
            render_depth=False,
            render_seg=False,
            use_shadows=assets.settings.shadows,
            enabled_geom_groups=[0],
            enable_backface_culling=False,
        )
        base = batch.context.base
        for name in ("lower", "upper", "group", "group_root", "bvh", "bvh_id", "mesh_registry", "mesh_bvh_id"):
            setattr(context, name, getattr(base, name))
        for name in ("rgb_data", "depth_data", "seg_data"):
            array = getattr(context, name)
            setattr(context, name, wp.zeros((batch.num_worlds, array.shape[1]), dtype=array.dtype))
        return context

    def place(self) -> None:
        with wp.ScopedDevice(self.device):
            self.batch.place(*self.inputs[:-1])

    def draw(self) -> None:
        with wp.ScopedDevice(self.device):
            if self.stock is None:
                self.batch.render(*self.inputs[:-1], rgb=self.outputs["rgb"])
            else:
                self.batch.place(*self.inputs[:-1])
                mjw.render(self.batch.model, self.batch.data, self.stock)


def time_bare(call: Callable[[], None], repeats: int) -> float:
    """Returns the median seconds of a call, including device synchronisation."""
    wp.synchronize()
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        wp.synchronize()
        seconds.append(time.perf_counter() - start)
    return float(np.median(seconds))


def measure(bank: SceneBank, robot: RobotSpec, case: tuple[int, ...], shading: str, style: str, arguments: Any) -> Any:
    """Returns (result, a few frames) of one configuration."""
    height, width, number = case
    options = dict(STYLES[style])
    if not options.pop("textures", True):
        bank = dataclasses.replace(bank, material_texture=np.full_like(bank.material_texture, -1))
    start = time.perf_counter()
    other = shading in ("megakernel", "stock")
    kind = "pbr" if other else shading
    renderer = Renderer(bank, robot, height, width, shading=kind, threads=arguments.threads, **options)
    places = [random_places(bank, robot, number, arguments.seed + i) for i in range(PLACES)]
    bare = Megakernel(renderer, places[0], shading == "stock") if other else Bare(renderer, places[0])
    bare.draw()
    wp.synchronize()
    result: dict[str, Any] = {"start_s": time.perf_counter() - start}
    result["bare_ms"] = 1e3 * time_bare(bare.draw, arguments.repeats)
    result["place_ms"] = 1e3 * time_bare(bare.place, arguments.repeats)
    if other:
        result["frames_per_s"] = number / (1e-3 * result["bare_ms"])
        return result, None if shading == "stock" else bare.outputs["rgb"][:KEPT_FRAMES].numpy()
    call = through_jax(renderer, places, arguments.frames)
    sample = timing.time_(call, repeats=arguments.repeats)
    result["frames_per_s"] = sample.rate(arguments.frames * number)
    result["spread"] = sample.spread
    result["ms"] = 1e3 * sample.median / arguments.frames
    return result, bare.outputs["rgb"][:KEPT_FRAMES].numpy()


def describe(name: str, bank: SceneBank, arguments: argparse.Namespace) -> dict[str, Any]:
    faces, present = np.diff(bank.mesh_face_start), bank.slot_mesh >= 0
    triangles = np.where(present, faces[np.maximum(bank.slot_mesh, 0)], 0).sum(1)
    return {
        "benchmark": "render",
        "device": jax.devices()[0].device_kind,
        "scenes": bank.num_scenes,
        "objects_per_scene": float(present.sum(1).mean()),
        "triangles_per_scene": float(triangles.mean()),
        "bank": name,
        "frames": arguments.frames,
        "repeats": arguments.repeats,
        "versions": {"jax": jax.__version__, "warp": wp.__version__, "mujoco": mujoco.__version__},
    }


def configurations(arguments: argparse.Namespace, banks: Iterable[str]) -> Any:
    for case in arguments.cases:
        for style in arguments.styles:
            for shading in arguments.shadings:
                for block in [None] if shading in ("megakernel", "stock") else arguments.blocks:
                    for bank in banks:
                        yield case, style, shading, block, bank


def named(paths: list[pathlib.Path] | None) -> dict[str, SceneBank]:
    """The banks by their files' names; by folder and name where two have one name."""
    if not paths:
        return {"shipped streets": load_bank(None)}
    alone = len({path.name for path in paths}) == len(paths)
    return {path.name if alone else f"{path.parent.name}/{path.name}": load_bank(path) for path in paths}


def load_bank(path: pathlib.Path | None) -> SceneBank:
    # Scenes are compiled only if no bank is given, because a GPU machine may lack CoACD and trimesh.
    if path:
        return SceneBank.load(path)
    from urbanverse_mjx.pipeline import ensure_default_bank

    return ensure_default_bank(quiet=True)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    began = time.perf_counter()
    banks, robot, images, failures = named(arguments.bank), make_coco(), {}, 0
    lines = arguments.out.open("a") if arguments.out else None

    def tell(line: dict[str, Any]) -> None:
        text = json.dumps({k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in line.items()})
        if lines:
            lines.write(text + "\n")
            lines.flush()
        print(text if arguments.json else "  ".join(f"{k} {v}" for k, v in line.items()), flush=True)

    for key, bank in banks.items():
        tell(describe(key, bank, arguments))
    chosen = street_draw.BLOCK
    for case, style, shading, block, key in configurations(arguments, banks):
        if time.perf_counter() - began > arguments.seconds:
            tell({"skipped": "out of time"})
            break
        name = f"{case[0]}x{case[1]}@{case[2]} {shading} {style}" + (f" {key}" if len(banks) > 1 else "")
        street_draw.BLOCK = block or chosen
        line = {"case": name, "block": block, "at_s": time.perf_counter() - began}
        try:
            result, frames = measure(banks[key], robot, case, shading, style, arguments)
            line |= result
            if frames is not None:
                images[name.replace(" ", "_").replace("/", "_")] = frames
        except Exception as error:
            failures += 1
            line |= {"error": repr(error)[:300], "trace": traceback.format_exc()[-600:]}
        tell(line)
        if arguments.out:
            np.savez_compressed(arguments.out.with_suffix(".npz"), **images)
        jax.clear_caches()
        gc.collect()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
