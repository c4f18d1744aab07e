"""Films eight places of `lib.transfer_places` with noise and distils them, for `benchmarks.transfer`.

    python -m benchmarks.transfer_recordings --out benchmarks/transfer_graphs [--only t03] [--workers 8] [--sheets DIR]

A camera is carried along the place and back (1.5 m a frame, 1.55 m high, looking to both sides). What the distillation
gets is not what was filmed: every image is blurred by the camera's motion and by defocus (`BLUR`); objects, their masks
and the kinds of ground are those that the shipped perception network finds in the blurred images, with its own misses
and confusions; poses drift and depth is wrong as in `lib.injection` (1 % of the path, 0.3 degrees per 10 m, 8 % a frame
and 5 % over the image). The graph is what UrbanVerse-Gen makes of that. Writes OUT/<place>/graph.json.gz, which is
what benchmarks/transfer_graphs holds, and with --sheets twelve frames as DIR/<place>.jpg. Places with a graph are
skipped. Prints one JSON line with the figures of every graph.
"""

import argparse
import dataclasses
import json
import os
import pathlib
import sys
import time
from typing import Any

import numpy as np
import scipy.ndimage

from benchmarks.lib.injection import Errors, inject
from benchmarks.lib.transfer_places import FILMED
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import Recording, RecordingWriter, Source, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.process_pool import results_as_completed
from urbanverse_mjx.work_folder import work_folder

SIZE = (360, 640)
STEP, HEIGHT, RATE = 1.5, 1.55, 1.0  # m between frames; m; frames per second
#: rad to both sides, frames of one swing, rad upwards.
SWAY, SWING, PITCH = np.radians(35.0), 7, np.radians(4.0)
#: px of an image 640 wide: longest smear by motion, and largest sigma of the defocus; each frame draws its own.
BLUR = (9, 1.5)
#: The network makes the errors of detection, so only poses and depth get others.
ERRORS = Errors(recall=1.0, precision=1.0, confusion=0.0, mask=0.0)
SOURCE = Source("synthetic film of a composed place, with noise", "Apache-2.0", "none", "none")


def blurred(image: np.ndarray, rng: np.random.Generator, most: tuple[float, float] = BLUR) -> np.ndarray:
    """(H, W, 3) u8 smeared along a random direction near the horizontal, and out of focus; most: as `BLUR`."""
    length, sigma = rng.uniform(1.0, most[0]), rng.uniform(0.0, most[1])
    angle = rng.normal(0.0, 0.3)
    offsets = np.linspace(-0.5, 0.5, 2 * int(np.ceil(length)) + 1) * length
    soft = scipy.ndimage.gaussian_filter(image.astype(np.float32), (sigma, sigma, 0.0))
    rows, columns = np.mgrid[0 : image.shape[0], 0 : image.shape[1]].astype(np.float32)
    out = np.zeros_like(soft)
    for offset in offsets:
        at = [rows + np.sin(angle) * offset, columns + np.cos(angle) * offset]
        for k in range(3):
            out[..., k] += scipy.ndimage.map_coordinates(soft[..., k], at, order=1, mode="nearest")
    return np.clip(np.round(out / len(offsets)), 0, 255).astype(np.uint8)


def camera_path(graph: Any) -> Any:
    """A walk along the graph's trajectory and back."""
    from urbanverse_mjx.capture import CameraPath
    from urbanverse_mjx.capture.path import camera_poses

    route = np.array(graph.camera_path)[:, :3]
    route = np.concatenate([route, route[-2::-1]])
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(route[:, :2], axis=0), axis=1))]
    at = np.arange(0.0, along[-1], STEP)
    places = np.stack([np.interp(at, along, route[:, k]) for k in range(3)], -1)
    ahead = np.stack([np.interp(np.minimum(at + 1.0, along[-1]), along, route[:, k]) for k in range(2)], -1)
    step = ahead - places[:, :2]
    yaw = np.unwrap(np.arctan2(step[:, 1], step[:, 0])) + SWAY * np.sin(2.0 * np.pi * np.arange(len(at)) / SWING)
    return CameraPath(np.arange(len(at)) / RATE, camera_poses(places, yaw, PITCH))


def film(place: str, folder: pathlib.Path) -> Recording:
    """Films a composed place without errors."""
    from urbanverse_mjx.assets.appearances.skies import build_sky
    from urbanverse_mjx.capture import FilmOptions, film_scene
    from urbanverse_mjx.materialisation import index_of, materialise_cousin
    from urbanverse_mjx.scene.bank import pack
    from urbanverse_mjx.scene.compiler import scene_geometry
    from urbanverse_mjx.scene.geometry import EpisodeTable

    graph = FILMED[place]().graph()
    layout = materialise_cousin(graph, 0, 0).layout
    (x, y, z, _), (gx, gy, gz, _) = graph.camera_path[0], graph.camera_path[-1]
    goal, no = np.array([[gx, gy, gz]]), np.zeros(1, bool)
    start = np.array([[x, y, z, 0.0]])
    # A bank needs an episode; this one is never driven.
    one = EpisodeTable(start, goal, goal[:, None], np.ones(1, np.int32), np.ones(1), no, no, np.array([-1.0]))
    geometry = dataclasses.replace(scene_geometry(layout, index_of(layout)), episodes=one)
    bank = pack([geometry], ["test"], {layout.sky: build_sky(layout.sky)})
    options = FilmOptions(width=SIZE[1], height=SIZE[0], samples=1)
    return film_scene(bank, 0, folder, camera_path(graph), options)


def perceived(filmed: Recording, folder: pathlib.Path, seed: int) -> Recording:
    """The film with blurred images, and the objects and surfaces that the network finds in them."""
    from urbanverse_mjx.distillation.perception_model.inference import PerceptionModel

    model, rng = PerceptionModel.load(), np.random.default_rng(seed)
    writer = RecordingWriter(folder, filmed.id, SOURCE, filmed.camera, filmed.depth_unit_m, lossless=False)
    for k, frame in enumerate(filmed.frames):
        rgb = blurred(filmed.rgb(k), rng)
        found = model(rgb, filmed.camera.fx)
        writer.add(
            frame.time_s, rgb, filmed.depth(k), found.masks, found.surfaces, frame.pose, found.detections
        )  # fmt: skip
    return writer.close()


def record(place: str, out: pathlib.Path, sheets: pathlib.Path | None) -> tuple[dict[str, Any], str]:
    """Writes the graph of a place; returns its figures, or the reason why there is none."""
    from urbanverse_mjx.assets.records.index import load_index
    from urbanverse_mjx.assets.selection.label_priors import LabelPriors
    from urbanverse_mjx.distillation import distil
    from urbanverse_mjx.pipeline.generation.distilling import DESCRIBE
    from urbanverse_mjx.pipeline.library.captures import compact

    begin, seed = time.monotonic(), int(place[1:3])
    try:
        with work_folder("urbanverse-transfer-") as work:
            folder = pathlib.Path(work)
            filmed = film(place, folder / "film")
            seen = perceived(filmed, folder / "seen", seed)
            given = inject(seen, folder / "given", seed, ERRORS, images=True)
            graph = distil(given, LabelPriors(load_index()), describe=DESCRIBE).graph
            if sheets is not None:
                _sheet(given, sheets / f"{place}.jpg")
    except ValidationError as error:
        return {}, str(error)
    graph = compact(dataclasses.replace(graph, id=place, source=SOURCE))
    graph.save(out / place / "graph.json.gz")
    true = FILMED[place]().graph()
    figures = {
        "frames": len(filmed),
        "objects": len(graph.objects),
        "true_objects": len(true.objects),
        "regions": len(graph.ground),
        "kB": round((out / place / "graph.json.gz").stat().st_size / 1e3, 1),
        "seconds": round(time.monotonic() - begin),
    }
    return figures, ""


def _sheet(recording: Recording, path: pathlib.Path) -> None:
    from PIL import Image

    frames = [recording.rgb(int(i))[::2, ::2] for i in np.linspace(1, len(recording) - 2, 12)]
    image = Image.fromarray(np.concatenate([np.concatenate(frames[k : k + 4], 1) for k in (0, 4, 8)]))
    v.write_atomically(path, lambda p: image.save(p, "JPEG", quality=85))


def main(argv: list[str] | None = None) -> int:
    """Films and distils."""
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--sheets", type=pathlib.Path, metavar="DIR", help="folder for twelve frames of each film")
    cli.add_argument("--only", default="", help="places with this in their id")
    cli.add_argument("--workers", type=int, default=settings.num_threads(), help="processes")
    args = cli.parse_args(argv)
    os.environ |= {"OMP_NUM_THREADS": "1", "URBANVERSE_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    wanted = [p for p in FILMED if args.only in p and not (args.out / p / "graph.json.gz").is_file()]
    found, failed = {}, {}
    for task, (figures, reason) in results_as_completed(
        record, [(p, args.out, args.sheets) for p in wanted], args.workers
    ):
        (failed if reason else found)[wanted[task]] = reason or figures
        print(f"{wanted[task]}: {reason or figures}", file=sys.stderr, flush=True)
    print(json.dumps({"graphs": found, "failed": failed}))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
