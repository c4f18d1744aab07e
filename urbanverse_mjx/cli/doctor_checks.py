"""The checks of `urbanverse doctor`; `python -m urbanverse_mjx.cli.doctor_checks NAME` runs one and prints JSON.

A check imports the examined package inside its function, makes it do a small piece of real work, and returns a
`Finding` or raises; an exception becomes a finding with the command that fixes the package.
"""

import dataclasses
import importlib.metadata
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from typing import Any, Literal

from .packages import declared, name_of

MINIMUM_PYTHON = (3, 12)
#: CUDA 13 needs this driver series (NVIDIA's CUDA 13.0 release notes, table of driver versions).
MINIMUM_DRIVER = 580
_DRIVER = f"install an NVIDIA driver of the {MINIMUM_DRIVER} series or newer (CUDA 13)"
#: The meshes, kernels and banks of the shipped scenes stay well below this.
MINIMUM_FREE_BYTES = 2 * 10**9

_SCENE = """
<mujoco>
  <worldbody>
    <light pos="0 0 4" dir="0 0 -1" type="directional"/>
    <camera name="down" pos="0 0 3" fovy="40"/>
    <geom type="plane" size="5 5 .1" rgba=".1 .1 .9 1"/>
    <body pos="0 0 .5"><freejoint/><geom type="box" size=".5 .5 .5" rgba=".9 .05 .05 1"/></body>
  </worldbody>
</mujoco>
"""


@dataclasses.dataclass(frozen=True)
class Finding:
    """The result of a check: `status`, one line of `detail`, and the command (or step) that fixes it."""

    status: Literal["ok", "missing", "problem"]
    detail: str
    fix: str = ""


@dataclasses.dataclass(frozen=True)
class Check:
    """A check, the package to install, and whether `make train` needs it."""

    run: Callable[[], Finding]
    package: str | None
    required: bool = True


def requirement(package: str) -> str:
    """The requirement of a package in this package's metadata, e.g. "warp-lang==1.18.0"."""
    for line in declared():
        if _canonical(name_of(line)) == _canonical(package):
            return line.partition(";")[0].strip().replace(" ", "")
    return package


def install(package: str) -> str:
    return f'{sys.executable} -m pip install "{requirement(package)}"'


def reinstall(package: str) -> str:
    return f'{sys.executable} -m pip install --force-reinstall --no-deps "{requirement(package)}"'


def _canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _version(package: str) -> str:
    return importlib.metadata.version(package)


def check_python() -> Finding:
    version = ".".join(map(str, sys.version_info[:3]))
    detail = f"{version} at {sys.executable}"
    if sys.version_info[:2] < MINIMUM_PYTHON:
        return Finding("problem", detail, "install Python 3.12 or newer, then run `make setup`")
    return Finding("ok", detail)


def check_machine() -> Finding:
    import psutil

    from .. import settings

    memory = psutil.virtual_memory()
    free, total = memory.available / 2**30, memory.total / 2**30
    detail = f"{settings.num_threads()} cores, {free:.1f} of {total:.1f} GiB memory free"
    if free < 3.0:  # `make train` peaks below 3 GiB (README, "how long it takes")
        return Finding("problem", detail, "close other programs: training needs 3 GiB of memory")
    return Finding("ok", detail)


def check_packages() -> Finding:
    """Checks that every declared dependency is installed in a declared version."""
    from packaging.requirements import Requirement

    try:
        ours = _version("urbanverse_mjx")
    except importlib.metadata.PackageNotFoundError:
        fix = f"{sys.executable} -m pip install -e ."
        return Finding("missing", "urbanverse_mjx is not installed, only importable", fix)
    lines = [Requirement(line) for line in declared()]
    needed = [r for r in lines if r.marker is None or r.marker.evaluate({"extra": ""})]
    missing, wrong = [], []
    for item in needed:
        try:
            version = _version(item.name)
        except importlib.metadata.PackageNotFoundError:
            missing.append(item)
            continue
        if not item.specifier.contains(version, prereleases=True):
            wrong.append(f"{item.name} {version} ({item.specifier} needed)")
    if missing or wrong:
        detail = "; ".join([*(f"{m.name} is not installed" for m in missing), *wrong])
        return Finding("missing" if missing else "problem", detail, "rm -f .venv/.stamp-main && make setup")
    return Finding("ok", f"all {len(needed)} dependencies of urbanverse_mjx {ours}")


def check_jax() -> Finding:
    import jax

    total = float(jax.jit(lambda x: (x * x).sum())(jax.numpy.arange(4.0)))
    devices = ", ".join(f"{d.platform}:{d.id} {d.device_kind}" for d in jax.devices())
    detail = f"{jax.__version__} on {devices}"
    if total != 14.0:
        return Finding("problem", f"{detail}; computed {total} where 14 is right", reinstall("jaxlib"))
    if jax.default_backend() == "cpu" and _gpus():
        fix = f'{sys.executable} -m pip install "jax[cuda13]=={jax.__version__}"'
        return Finding("problem", f"{detail}, but the GPU is not used", fix)
    return Finding("ok", detail)


def check_gpu() -> Finding:
    gpus = _gpus()
    if not gpus:
        return Finding("missing", "no NVIDIA GPU (nvidia-smi finds none); everything runs on the CPU")
    name, driver, memory = (part.strip() for part in gpus[0].split(","))
    detail = f"{len(gpus)} x {name}, {memory}, driver {driver}"
    if int(driver.partition(".")[0]) < MINIMUM_DRIVER:
        return Finding("problem", detail, _DRIVER)
    return Finding("ok", detail)


def _gpus() -> list[str]:
    if shutil.which("nvidia-smi") is None:
        return []
    query = ["nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader"]
    done = subprocess.run(query, capture_output=True, text=True, timeout=60, check=False)
    return done.stdout.strip().splitlines() if done.returncode == 0 else []


def check_mujoco() -> Finding:
    import mujoco

    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    if data.ncon < 4:
        detail = f"{mujoco.__version__}: a box on a plane has {data.ncon} contacts"
        return Finding("problem", detail, reinstall("mujoco"))
    return Finding("ok", f"{mujoco.__version__}, a box rests on a plane with {data.ncon} contacts")


def check_mjx() -> Finding:
    import mujoco
    from mujoco import mjx

    model = mujoco.MjModel.from_xml_string(_SCENE)
    qpos = mjx.make_data(mjx.put_model(model)).qpos
    return Finding("ok", f"{_version('mujoco-mjx')}, put a model of {qpos.shape[0]} coordinates on the device")


def check_warp() -> Finding:
    import warp as wp

    wp.init()
    names = ", ".join(f"{d.alias} {d.name}" for d in wp.get_devices())
    detail = f"{wp.config.version} on {names}"
    if _gpus() and not wp.is_cuda_available():
        return Finding("problem", f"{detail}, but the GPU is not used", _DRIVER)
    return Finding("ok", detail)


def check_renderer() -> Finding:
    """Draws a red box on a blue plane from above and checks the pixels."""
    import mujoco
    import mujoco_warp as mjw
    import mujoco_warp_pbr as pbr
    import warp as wp

    size = 16
    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    m, d = mjw.put_model(model), mjw.put_data(model, data, nworld=1)
    context = pbr.create_render_context(model, nworld=1, cam_res=(size, size), render_rgb=True)
    mjw.refit_bvh(m, d, context.base)
    pbr.render(m, d, context)
    frame = wp.zeros((1, size, size), dtype=wp.vec3)
    pbr.get_rgb(context, 0, frame)
    rgb = frame.numpy()[0]
    middle, corner = rgb[size // 2, size // 2], rgb[0, 0]
    detail = f"mujoco-warp-pbr {_version('mujoco-warp-pbr')} drew a frame on {wp.get_device().alias}"
    if not (middle[0] > 2 * middle[2] and corner[2] > 2 * corner[0]):
        return Finding("problem", f"{detail}, and its colours are wrong", reinstall("mujoco-warp-pbr"))
    return Finding("ok", detail)


def check_brax() -> Finding:
    import jax
    import jax.numpy as jnp

    from ..training import brax_compat

    brax_compat.load_ppo()
    # The first call of Brax's PPO, removed from JAX in 0.10 and added by brax_compat.
    copies = jax.device_put_replicated(jnp.arange(3.0), jax.local_devices())
    if copies.shape != (jax.local_device_count(), 3):
        return Finding("problem", f"{_version('brax')}: parameters are not copied to every device", reinstall("jax"))
    return Finding("ok", f"{_version('brax')}, PPO imports on this JAX")


def check_ffmpeg() -> Finding:
    import imageio_ffmpeg

    program = imageio_ffmpeg.get_ffmpeg_exe()
    command = [program, "-hide_banner", "-encoders"]
    listing = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    if "libx264" not in listing.stdout:
        return Finding("problem", f"{program} cannot write H.264", install("imageio-ffmpeg"))
    return Finding("ok", f"{imageio_ffmpeg.get_ffmpeg_version()} with H.264 at {program}")


def check_cache() -> Finding:
    import tempfile

    from .. import settings

    folder = settings.cache_dir()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"urbanverse")
    except OSError as error:
        fix = "export URBANVERSE_CACHE=<a folder you can write to>"
        return Finding("problem", f"{folder} cannot be written ({error.strerror})", fix)
    free = shutil.disk_usage(folder).free
    detail = f"{folder}, {free / 1e9:.1f} GB free"
    if free < MINIMUM_FREE_BYTES:
        fix = f"free {MINIMUM_FREE_BYTES / 1e9:.0f} GB there, or export URBANVERSE_CACHE=<another folder>"
        return Finding("problem", detail, fix)
    return Finding("ok", detail)


def check_assets() -> Finding:
    """Builds one asset of every leaf and looks up its hulls."""
    from .. import assets

    index = assets.load_index()
    leaves = sorted({record.leaf for record in index.records})
    without = []
    for leaf in leaves:
        record = index.by_leaf(leaf)[0]
        assets.build_mesh(record)
        try:
            assets.load_hulls(record)
        except ValueError:
            without.append(leaf)
    detail = f"{len(index.records)} assets of {len(leaves)} leaf categories"
    if without:
        fix = f"{sys.executable} -m urbanverse_mjx.assets hulls"
        return Finding("missing", f"{detail}; no hulls for {', '.join(without[:3])} ({len(without)} leaves)", fix)
    return Finding("ok", f"{detail}, with hulls")


def check_scenes() -> Finding:
    from .. import settings
    from ..datatypes import SceneGraph
    from ..datatypes import validation as v

    root = settings.scene_root()
    graphs = [SceneGraph.load(path) for path in sorted(root.glob("*/graph.json"))]
    objects = sum(len(graph.objects) for graph in graphs)
    detail = f"{v.counted(len(graphs), 'streets')} with {v.counted(objects, 'objects')} in {root}"
    if not graphs:
        return Finding("missing", detail, "git checkout -- scenes")
    built = settings.default_bank_path().exists()
    return Finding("ok", f"{detail}; their bank is {'built' if built else 'built at the first use'}")


def check_coacd() -> Finding:
    import coacd

    return Finding("ok", f"coacd {_version('coacd')} from {coacd.__name__}: hulls of new assets can be made")


def check_opencv() -> Finding:
    """Checks that OpenCV reads videos and has the cascades of `--blur haar`."""
    import pathlib

    import cv2

    backends = [cv2.videoio_registry.getBackendName(b) for b in cv2.videoio_registry.getStreamBackends()]
    if "FFMPEG" not in backends:
        return Finding("problem", f"{cv2.__version__} reads no video", reinstall("opencv-python-headless"))
    if not list((pathlib.Path(cv2.__file__).parent / "data").glob("haarcascade_*.xml")):
        return Finding("problem", f"{cv2.__version__} without cascades", install("opencv-python-headless"))
    return Finding("ok", f"{cv2.__version__} reads videos by FFmpeg, with the cascades of --blur haar")


CHECKS: dict[str, Check] = {
    "python": Check(check_python, None),
    "machine": Check(check_machine, None, required=False),
    "packages": Check(check_packages, None),
    "gpu": Check(check_gpu, None, required=False),
    "jax": Check(check_jax, "jax"),
    "mujoco": Check(check_mujoco, "mujoco"),
    "mjx": Check(check_mjx, "mujoco-mjx"),
    "warp": Check(check_warp, "warp-lang"),
    "renderer": Check(check_renderer, "mujoco-warp-pbr"),
    "brax": Check(check_brax, "brax"),
    "ffmpeg": Check(check_ffmpeg, "imageio-ffmpeg"),
    "cache": Check(check_cache, None),
    "assets": Check(check_assets, None),
    "scenes": Check(check_scenes, None),
    "coacd": Check(check_coacd, "coacd"),
    "opencv": Check(check_opencv, "opencv-python-headless"),
}


def run(name: str) -> Finding:
    """Runs one check in this process; an exception becomes a finding with the command that fixes it."""
    check = CHECKS[name]
    fix = reinstall(check.package) if check.package else "make setup"
    try:
        return check.run()
    except ModuleNotFoundError as error:
        return Finding("missing", f"no module {error.name!r}", install(check.package) if check.package else fix)
    except BaseException as error:  # a broken package may raise anything, SystemExit included
        first: Any = str(error).strip().splitlines() or [""]
        return Finding("problem", f"{type(error).__name__}: {first[0][:200]}", fix)


if __name__ == "__main__":
    print(json.dumps(dataclasses.asdict(run(sys.argv[1]))))
