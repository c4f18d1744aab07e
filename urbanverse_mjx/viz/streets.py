"""`python -m urbanverse_mjx.viz.streets`: two images of each shipped street, into `runs/streets/`.

Each street is shown from above and from the pavement, with the light and shading of a policy's image.
"""

import argparse
import io
import pathlib
import sys

import numpy as np
from PIL import Image

from ..datatypes import SceneBank, ValidationError
from ..datatypes.validation import write_atomically
from ..settings import default_bank_path
from .images import Studio

#: Camera position on each street's pavement and its target: x, y, z in metres.
PAVEMENT_VIEWS: dict[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {
    "residential_bins": ((28.3, 5.7, 1.75), (14.0, 5.6, 1.3)),
    "commercial_cafes": ((1.2, 7.3, 1.75), (16.0, 6.3, 1.3)),
    "construction_narrow": ((13.4, 6.0, 1.75), (28.0, 4.7, 1.2)),
    "tourist_scooters": ((25.7, 5.5, 1.75), (38.0, 4.7, 1.2)),
    "commercial_bike_lane": ((45.0, 7.4, 1.75), (31.0, 6.2, 1.3)),
    "park_edge": ((23.2, 6.1, 1.75), (36.0, 8.4, 1.2)),
}
PAVEMENT_SIZE, ABOVE_SIZE = (1120, 630), (1400, 640)
ELEVATION = np.radians(78.0)
MAX_BYTES = 250_000


def jpeg(image: np.ndarray) -> bytes:
    """Returns an (H, W, 3) uint8 image as JPEG of the best quality that fits into `MAX_BYTES`.

    Raises:
      ValidationError: the image is larger even at the lowest quality.
    """
    for quality in (92, 88, 84, 80, 75, 70, 60):
        file = io.BytesIO()
        Image.fromarray(image).save(file, "JPEG", quality=quality, optimize=True)
        if file.tell() <= MAX_BYTES:
            return file.getvalue()
    raise ValidationError(f"image: found {file.tell()} bytes at quality 60, needed {MAX_BYTES}; render it smaller.")


def street_images(bank: SceneBank, out: pathlib.Path, only: str | None = None) -> list[pathlib.Path]:
    """Writes `<scene>_above.jpg` and `<scene>_pavement.jpg` of every street that has a view; returns their paths."""
    scenes = [(i, name) for i, name in enumerate(bank.scene_ids) if name in PAVEMENT_VIEWS and only in (None, name)]
    written = []
    pavement = Studio(bank, *PAVEMENT_SIZE)
    above = Studio(bank, *ABOVE_SIZE)
    for scene, name in scenes:
        images = {"pavement": pavement.view(scene, *PAVEMENT_VIEWS[name]), "above": above.birdseye(scene, ELEVATION)}
        for kind, image in images.items():
            body = jpeg(image)
            path = out / f"{name}_{kind}.jpg"
            written.append(write_atomically(path, lambda temporary, body=body: temporary.write_bytes(body)))
    return written


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bank", type=pathlib.Path, help="scene bank; default: the shipped streets' own")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/streets"), help="folder of the images")
    parser.add_argument("--only", choices=sorted(PAVEMENT_VIEWS), help="one street instead of all")
    args = parser.parse_args()
    bank = SceneBank.load(args.bank or default_bank_path())
    for path in street_images(bank, args.out, args.only):
        sys.stdout.write(f"{path}: {path.stat().st_size / 1e3:.0f} kB\n")


if __name__ == "__main__":
    main()
