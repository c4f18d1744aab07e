"""COCO: images, instances with masks and boxes, and captions.

Source of the keys: the data format page of cocodataset.org.
"""

import json
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

from ..datatypes import validation as v
from .frame_files import EPISODES, FrameEpisode, FrameFolder, Rig, read_list

INSTANCES, CAPTIONS = "annotations/instances.json", "annotations/captions.json"


class CocoWriter(FrameFolder):
    """Writes images/000000000001.jpg, ... with annotations/instances.json and annotations/captions.json."""

    image_type = "jpg"

    def __init__(self, folder: pathlib.Path, rig: Rig, origin: Mapping[str, Any], resume: bool = False) -> None:
        # As text, because all of it is written again whenever it grows.
        self._images: list[str] = []
        self._instances: list[str] = []
        self._captions: list[str] = []
        self._category = {name: k + 1 for k, name in enumerate(rig.categories)}
        super().__init__(folder, rig, origin, resume)

    def read_lists(self) -> None:
        """Takes over images, instances and captions."""
        instances, captions = self.folder / INSTANCES, self.folder / CAPTIONS
        self._images = [json.dumps(row) for row in read_list(instances, "images")[: self.num_frames]]
        self._captions = _lines(read_list(captions, "annotations")[: self.num_frames])
        own = read_list(instances, "annotations")
        self._instances = _lines([row for row in own if row.get("image_id", 0) <= self.num_frames])
        if len(self._images) != self.num_frames or len(self._captions) != self.num_frames:
            raise v.fail(str(instances), f"{len(self._images)} images", f"{self.num_frames}, as {EPISODES} counts")

    def files(self, episode: FrameEpisode) -> dict[str, bytes]:
        """Its images."""
        return {f"images/{self.num_frames + k + 1:012d}.jpg": image for k, image in enumerate(episode.colours)}

    def take(self, episode: FrameEpisode) -> None:
        """Keeps the annotations for the lists."""
        for step, seen in enumerate(episode.annotations):
            number = len(self._images) + 1
            name = f"{number:012d}.jpg"
            size = {"height": self.rig.height, "width": self.rig.width}
            place = {"episode": self.num_episodes, "step": step, "scene": episode.record["scene"]}
            self._images.append(json.dumps({"id": number, "file_name": name, **size, **place}))
            said = {"id": number, "image_id": number, "caption": seen.caption}
            self._captions.append(json.dumps(said, ensure_ascii=False))
            for item, runs in zip(seen.objects, seen.runs, strict=True):
                left, top, right, bottom = item.box
                body = {
                    "id": len(self._instances) + 1,
                    "image_id": number,
                    "category_id": self._category[item.category],
                    "bbox": [left, top, right - left, bottom - top],
                    "area": item.pixels,
                    "iscrowd": 0,
                    "segmentation": {"size": [self.rig.height, self.rig.width], "counts": runs},
                    "name": item.name,
                    "visible": round(item.visible, 4),
                }
                self._instances.append(json.dumps(body, ensure_ascii=False))

    def lists(self) -> dict[str, bytes]:
        """Instances and captions of all images."""
        info = '"info": {"description": "urbanverse_mjx"}, "licenses": []'
        images = ",\n".join(self._images)
        categories = json.dumps(
            [
                {"id": k, "name": name, "supercategory": name.rpartition(":")[0] or "object"}
                for name, k in self._category.items()
            ],
            ensure_ascii=False,
        )
        instances, captions = ",\n".join(self._instances), ",\n".join(self._captions)
        head = f'{{{info},\n"images": [\n{images}\n],\n"annotations": [\n'
        return {
            INSTANCES: f'{head}{instances}\n],\n"categories": {categories}}}\n'.encode(),
            CAPTIONS: f"{head}{captions}\n]}}\n".encode(),
        }


def _lines(rows: Sequence[Any]) -> list[str]:
    return [json.dumps(row, ensure_ascii=False) for row in rows]
