"""Checks answers by another renderer and by vector geometry, which share no code with what made them.

Objects are counted, compared and measured in images of stock MuJoCo's OpenGL renderer, which draws the number of each
geom of the compiled `scene.xml` and its depth. Roads, free directions and reachable objects are decided with polygons
(shapely) of the layout's ground and of the hulls in `scene.xml`, without a grid.
"""

import math
import pathlib
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
import shapely

from urbanverse_mjx.datatypes import SceneLayout

from . import walkable
from .views import FOVY, View

#: Share of a distance by which both renderers may differ, and pixels of an object that count as visible.
_FAR_OFF, _VISIBLE = 0.08, 60


class StockMujoco:
    """A scene in stock MuJoCo.

    Args:
      folder: a compiled scene with `scene.xml` and `layout.json`.
      height, width: pixels.
    """

    def __init__(self, folder: pathlib.Path, height: int, width: int) -> None:
        spec = mujoco.MjSpec.from_file(str(folder / "scene.xml"))
        spec.visual.global_.offheight, spec.visual.global_.offwidth = height, width
        spec.visual.global_.fovy = math.degrees(FOVY)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self._renderer = mujoco.Renderer(self.model, height, width)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[2] = 1
        geoms = [self.model.geom(k).name for k in range(self.model.ngeom)]
        self.owner = np.array([name.partition("/")[0] for name in geoms])
        self.layout = SceneLayout.load(folder / "layout.json")
        self.category = {placed.id: placed.category for placed in self.layout.objects}

    def close(self) -> None:
        self._renderer.close()

    def images(self, view: View) -> tuple[np.ndarray, np.ndarray]:
        """Ids of objects (H, W) str, "" for the sky, and planar depth (H, W) m."""
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        ahead = view.axes[2]
        camera.lookat, camera.distance = view.position + ahead, 1.0
        camera.azimuth, camera.elevation = math.degrees(view.yaw), math.degrees(view.pitch)
        self._renderer.update_scene(self.data, camera, self._option)
        self._renderer.enable_segmentation_rendering()
        geoms = self._renderer.render()[..., 0]
        self._renderer.disable_segmentation_rendering()
        self._renderer.enable_depth_rendering()
        depth = self._renderer.render().copy()
        self._renderer.disable_depth_rendering()
        return np.where(geoms >= 0, self.owner[geoms], ""), depth

    def obstacles(self, ground: float) -> list[shapely.Polygon]:
        """Outlines of the hulls between 0.3 and 2 m above a height."""
        found = []
        for k in range(self.model.ngeom):
            if self.model.geom_group[k] != 3 or self.owner[k] not in self.category:
                continue
            mesh = self.model.geom_dataid[k]
            start, number = self.model.mesh_vertadr[mesh], self.model.mesh_vertnum[mesh]
            world = self.model.mesh_vert[start : start + number] @ self.data.geom_xmat[k].reshape(3, 3).T
            world = world + self.data.geom_xpos[k]
            if world[:, 2].max() > ground + 0.3 and world[:, 2].min() < ground + 2.0:
                found.append(shapely.MultiPoint(world[:, :2]).convex_hull)
        return found

    def ground(self, *kinds: str) -> Any:
        """Union of the layout's ground of some kinds."""
        return shapely.union_all(
            [shapely.Polygon(g.polygon).buffer(0.01) for g in self.layout.ground if g.kind in kinds]
        )


def check(doc: Mapping[str, Any], view: View, stock: StockMujoco, images: tuple[np.ndarray, np.ndarray]) -> bool | None:
    """Whether the answer to a question agrees; None if this check cannot tell.

    Args:
      images: `stock.images(view)`.
    """
    template = doc["template"]
    if template in ("exists", "count"):
        return _number(doc, stock, images[0])
    if template in ("side", "nearer", "distance"):
        return _placed(doc, view, images)
    geometric = {
        "stands_on": _stands_on,
        "right_of_way": _priority,
        "free_direction": _free_direction,
        "reach": _reach,
    }
    return geometric[template](doc, view, stock) if template in geometric else None


def _number(doc: Mapping[str, Any], stock: StockMujoco, owners: np.ndarray) -> bool:
    names, pixels = np.unique(owners, return_counts=True)
    leaves = doc["facts"]["leaves"]
    number = sum(stock.category.get(name) in leaves for name in names[pixels >= _VISIBLE])
    return (doc["answer"] == "yes") == (number > 0) if doc["template"] == "exists" else int(doc["answer"]) == number


def _placed(doc: Mapping[str, Any], view: View, images: tuple[np.ndarray, np.ndarray]) -> bool:
    owners, depth = images
    masks = [owners == name for name in doc["facts"]["objects"]]
    if not all(mask.any() for mask in masks):
        return False
    if doc["template"] == "side":
        first, second = (np.nonzero(mask)[1].mean() for mask in masks)
        return bool((first < second) == (doc["answer"] == "left"))
    h, w = depth.shape
    x, y = (np.arange(w) + 0.5 - w / 2) / view.focal, (np.arange(h) + 0.5 - h / 2) / view.focal
    away = depth * np.sqrt(1.0 + x[None] ** 2 + y[:, None] ** 2)
    near = [float(np.percentile(away[mask], 2)) for mask in masks]
    if doc["template"] == "distance":
        return abs(near[0] - doc["number"]) <= _FAR_OFF * doc["number"]
    first, _, _ = doc["question"].partition(", ")[2].rstrip("?").partition(" or ")
    return (near[0] < near[1]) == (doc["answer"] == first)


def _stands_on(doc: Mapping[str, Any], view: View, stock: StockMujoco) -> bool:
    placed = next(o for o in stock.layout.objects if o.id == doc["facts"]["objects"][0])
    kinds = {"the pavement": "sidewalk", "the road": "road", "a crosswalk": "crosswalk"}
    return bool(stock.ground(kinds[doc["answer"]]).contains(shapely.Point(placed.position[:2])))


def _priority(doc: Mapping[str, Any], view: View, stock: StockMujoco) -> bool:
    road = stock.ground("road").difference(stock.ground("crosswalk"))
    path = shapely.LineString(_line(view, doc["facts"]["degrees"], 0.3, walkable.AHEAD))
    return (path.intersection(road).length > 0.5) == (doc["answer"] == "yes")


def _free_direction(doc: Mapping[str, Any], view: View, stock: StockMujoco) -> bool:
    facts, free = doc["facts"], _free_space(stock, view)
    angles = {"left": facts["degrees"], "straight ahead": 0.0, "right": -facts["degrees"]}
    found = []
    for name, angle in angles.items():
        path = shapely.LineString(_line(view, angle, walkable.START, facts["length"])).buffer(0.4, cap_style="flat")
        if path.difference(free).area < 0.02:
            found.append(name)
    return found == [doc["answer"]]


def _reach(doc: Mapping[str, Any], view: View, stock: StockMujoco) -> bool:
    parts = shapely.get_parts(_free_space(stock, view).buffer(-0.4))
    at = shapely.Point(view.position[:2])
    here = [part for part in parts if part.distance(at) < 1.0]
    placed = next(o for o in stock.layout.objects if o.id == doc["facts"]["objects"][0])
    target = shapely.union_all(_own_hulls(stock, placed.id) or [shapely.Point(placed.position[:2])])
    return any(part.distance(target) < 1.1 for part in here) == (doc["answer"] == "yes")


def _own_hulls(stock: StockMujoco, name: str) -> list[shapely.Geometry]:
    found = []
    for k in np.flatnonzero((stock.owner == name) & (stock.model.geom_group == 3)):
        mesh = stock.model.geom_dataid[k]
        start, number = stock.model.mesh_vertadr[mesh], stock.model.mesh_vertnum[mesh]
        world = stock.model.mesh_vert[start : start + number] @ stock.data.geom_xmat[k].reshape(3, 3).T
        world = world + stock.data.geom_xpos[k]
        low = world[world[:, 2] < world[:, 2].min() + 1.5]
        found.append(shapely.MultiPoint(low[:, :2]).convex_hull)
    return found


def _free_space(stock: StockMujoco, view: View) -> Any:
    """Pavements, crosswalks and paths without what stands on them, within 40 m of a camera."""
    near = shapely.Point(view.position[:2]).buffer(40.0)
    open_ground = stock.ground("sidewalk", "crosswalk", "ground").intersection(near)
    return open_ground.difference(shapely.union_all([s for s in stock.obstacles(view.ground) if s.intersects(near)]))


def _line(view: View, degrees: float, first: float, last: float) -> np.ndarray:
    angle = view.yaw + math.radians(degrees)
    return view.position[:2] + np.outer([first, last], [math.cos(angle), math.sin(angle)])
