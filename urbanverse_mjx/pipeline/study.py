"""Makes the page of a user study from compiled scenes, analyses its answers, and compares layouts without people."""

import dataclasses
import os
import pathlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..study import Material, StreetLayout

type Path = str | os.PathLike[str]
#: Scenes that are rendered from one bank; its renderer is compiled once.
_SCENES_OF_A_BANK = 8
_CAMERA_HEIGHT = 1.6  # m


@dataclasses.dataclass(frozen=True)
class StudyOptions:
    """Options of a study; defaults are the paper's.

    Attributes:
      pairs: number of pairs of overview images.
      rated: scenes of each group that are rated.
      fidelity: cousins that are compared with the plan of their source.
      catches: catch trials of each kind.
      width: pixels of an image and video; heights are 5/8 of it, even.
      frames, rate: frames of a walkthrough, and per second; the camera turns once around.
      seed: of the choice of scenes, pairs and names.
      title, consent, contact: texts of the page; "" for the default consent.
    """

    pairs: int = 100
    rated: int = 10
    fidelity: int = 10
    catches: int = 3
    width: int = 800
    frames: int = 150
    rate: float = 10.0
    seed: int = 0
    title: str = "Streets"
    consent: str = ""
    contact: str = ""


@dataclasses.dataclass(frozen=True)
class StudyFiles:
    """Path of the page and of the key, and the number of trials of each kind."""

    page: pathlib.Path
    key: pathlib.Path
    trials: dict[str, int]


def make_study(
    out: Path,
    ours: Sequence[Path],
    baseline: Sequence[Path] = (),
    oracle: Sequence[Path] = (),
    graphs: Path | None = None,
    options: StudyOptions | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> StudyFiles:
    """Renders what a study shows and writes its page.

    Args:
      out: folder of the page; the key is written beside it, as NAME-key.json. Existing images are kept.
      ours, baseline, oracle: compiled scenes, or folders of them. Pairs are of `ours` and `baseline`; all are rated.
      graphs: folder with ID/graph.json or ID/graph.json.gz of the sources of `ours`; None for no ratings of fidelity.
      options: numbers, sizes and texts.
      progress: called with the name of each file.

    Raises:
      ValidationError: a folder has no compiled scene, or a graph is damaged.
    """
    from ..datatypes import validation as v
    from ..scene.folders import scene_folders
    from ..study import plan_study, write_page
    from ..study.page import CONSENT, KEY, MEDIA

    o, folder = options or StudyOptions(), pathlib.Path(out)
    for name, least in (("pairs", 0), ("rated", 0), ("fidelity", 0), ("catches", 0), ("width", 64), ("frames", 2)):
        v.integer(getattr(o, name), f"study: {name}", least)
    groups = {"urbanverse": ours, "procedural": baseline, "oracle": oracle}
    chosen = {
        name: _drawn(scene_folders([pathlib.Path(p) for p in places]), o.seed)
        for name, places in groups.items()
        if places
    }
    (folder / MEDIA).mkdir(parents=True, exist_ok=True)
    drawing = _Drawing(folder / MEDIA, o, progress)
    paired = {name: chosen.get(name, []) for name in ("urbanverse", "procedural")} if o.pairs and baseline else {}
    overviews = {name: drawing.overviews(name, rows[: o.pairs]) for name, rows in paired.items()}
    videos = [m for name, rows in chosen.items() for m in drawing.videos(name, rows[: o.rated])]
    plans = [] if graphs is None else drawing.plans(chosen["urbanverse"], pathlib.Path(graphs))
    plan = plan_study(overviews, videos, plans, o.pairs if baseline else 0, o.catches, o.seed)
    page = write_page(plan, folder, o.title, o.consent or CONSENT, o.contact)
    kinds = [trial.kind for trial in plan.trials]
    return StudyFiles(
        page, folder.parent / f"{folder.name}-{KEY}", {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)}
    )


def _drawn(folders: Sequence[pathlib.Path], seed: int) -> list[pathlib.Path]:
    rng = np.random.default_rng(seed)
    return [folders[k] for k in rng.permutation(len(folders))]


class _Drawing:
    """Renders files that do not exist yet."""

    def __init__(self, folder: pathlib.Path, options: StudyOptions, progress: Callable[[str], None]) -> None:
        self._folder, self._options, self._progress = folder, options, progress
        self._size = options.width // 2 * 2, options.width * 5 // 16 * 2

    def _named(self, kind: str, suffix: str, group: str, folders: Sequence[pathlib.Path]) -> list["Material"]:
        from ..study import Material
        from ..study.plan import blind_name

        kind = f"{kind}/{self._size}"
        return [Material(f.name, group, blind_name(f.name, kind, self._options.seed, suffix)) for f in folders]

    def _studios(
        self, materials: Sequence["Material"], folders: Sequence[pathlib.Path], samples: int
    ) -> Iterator[tuple["Material", Any, int]]:
        """What is not drawn yet, each with a studio and its scene's row there; some scenes share a bank."""
        from ..scene import pack_bank
        from ..viz.images import Studio

        rows = zip(materials, folders, strict=True)
        missing = [(m, f) for m, f in rows if not (self._folder / m.file).is_file()]
        for start in range(0, len(missing), _SCENES_OF_A_BANK):
            part = missing[start : start + _SCENES_OF_A_BANK]
            bank = pack_bank([folder for _, folder in part], ["train"] * len(part))
            studio = Studio(bank, *self._size, samples=samples)
            yield from ((material, studio, row) for row, (material, _) in enumerate(part))

    def overviews(
        self, group: str, folders: Sequence[pathlib.Path], kind: str = "overview", elevation: float = np.radians(55.0)
    ) -> list["Material"]:
        """Images from above."""
        from ..viz.streets import jpeg

        found = self._named(kind, ".jpg", group, folders)
        for material, studio, row in self._studios(found, folders, 2):
            self._save(material.file, jpeg(studio.birdseye(row, elevation)))
        return found

    def videos(self, group: str, folders: Sequence[pathlib.Path]) -> list["Material"]:
        """Walks along the longest route of each scene, during which the camera turns around once."""
        from ..viz.video import write_video

        found = self._named(f"video/{self._options.frames}", ".mp4", group, folders)
        for material, studio, row in self._studios(found, folders, 1):
            cameras = walkthrough(studio.bank, row, self._options.frames)
            frames = [studio.view(row, at, at + ahead) for at, ahead in cameras]
            write_video(self._folder / material.file, frames, self._options.rate)
            self._progress(material.file)
        return found

    def plans(self, folders: Sequence[pathlib.Path], graphs: pathlib.Path) -> list[tuple["Material", "Material"]]:
        """Plans of sources, each with one cousin from straight above; no source twice."""
        from ..datatypes import SceneGraph, SceneLayout
        from ..study import Material
        from ..study.plan import blind_name
        from ..viz.graphs import plan
        from ..viz.streets import jpeg

        sources: dict[str, pathlib.Path] = {}
        for scene in folders:
            sources.setdefault(SceneLayout.load(scene / "layout.json").graph_id, scene)
        rows = list(sources.items())[: self._options.fidelity]
        # The camera leans by a degree, since looking straight down has no upper side.
        above = self.overviews("urbanverse", [scene for _, scene in rows], "above", np.radians(89.0))
        found = []
        for (source, _), cousin in zip(rows, above, strict=True):
            name = blind_name(source, f"plan/{self._size}", self._options.seed, ".jpg")
            if not (self._folder / name).is_file():
                self._save(name, jpeg(plan(SceneGraph.load(graph_file(graphs, source)), width=self._size[0])))
            found.append((Material(source, "source", name), cousin))
        return found

    def _save(self, name: str, body: bytes) -> None:
        from ..datatypes.validation import write_atomically

        write_atomically(self._folder / name, lambda path: path.write_bytes(body))
        self._progress(name)


def graph_file(folder: pathlib.Path, source: str) -> pathlib.Path:
    """The graph of a source in a folder of graphs.

    Raises:
      ValidationError: there is none.
    """
    from ..datatypes import validation as v

    for name in ("graph.json", "graph.json.gz"):
        if (folder / source / name).is_file():
            return folder / source / name
    raise v.fail(str(folder), f"no {source}/graph.json", "the graph of each source", "name another folder of graphs")


def walkthrough(bank: Any, scene: int, frames: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Positions (3,) m of a camera along the longest route of a bank's scene, and directions (3,) of view, which
    turn around once."""
    row = int(np.argmax(bank.episode_length[scene, : bank.num_episodes[scene]]))
    number = int(bank.episode_num_waypoints[scene, row])
    start, waypoints = bank.episode_start[scene, row], bank.episode_waypoints[scene, row, :number]
    route = np.concatenate([start[None, :3], waypoints]).astype(float)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1))])
    for k in range(frames):
        at = np.array([np.interp(along[-1] * k / (frames - 1), along, route[:, axis]) for axis in range(3)])
        yaw = float(start[3]) + 2 * np.pi * k / frames
        yield at + [0.0, 0.0, _CAMERA_HEIGHT], np.array([np.cos(yaw), np.sin(yaw), -0.06])


def analyse_study(key: Path, answers: Iterable[Path]) -> dict[str, Any]:
    """Results of a study: see `study.analyse`.

    Args:
      key: file of the key. answers: CSV files of participants.

    Raises:
      ValidationError: a file is damaged, or of another study.
    """
    from ..datatypes import validation as v
    from ..study import StudyPlan, analyse, read_answers

    path = pathlib.Path(key)
    plan = StudyPlan.from_json(v.read_json(path, "study's key"), str(path))
    return analyse(read_answers(answers, plan), plan)


def compare_layouts(
    scenes: Sequence[Path],
    against: Sequence[Path] = (),
    graphs: Path | None = None,
    permutations: int = 999,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Compares the layouts of scenes with other scenes, or with the graphs that they were made from.

    Args:
      scenes: compiled scenes, or folders of them; with `graphs`, the first cousin of each source counts.
      against: other compiled scenes.
      graphs: folder of the sources' graphs, instead of `against`.
      permutations: see `study.compare`.

    Returns:
      "streets": their numbers, "paired", and "statistics": see `study.compare`.

    Raises:
      ValidationError: neither or both of `against` and `graphs`, or a folder without scenes.
    """
    from ..datatypes import SceneGraph
    from ..datatypes import validation as v
    from ..study import compare, layout_of_graph

    if bool(against) == (graphs is not None):
        raise v.fail("layouts", "both or neither of scenes and graphs", "one to compare with", "name one of both")
    v.integer(permutations, "layouts: permutations", 19, 100_000)
    a = _layouts(scenes, graphs is not None)
    if graphs is None:
        b = _layouts(against, False)
    else:
        b = [layout_of_graph(SceneGraph.load(graph_file(pathlib.Path(graphs), street.source))) for street in a]
    found = compare(a, b, graphs is not None, permutations, progress)
    return {"streets": [len(a), len(b)], "paired": graphs is not None, "statistics": found}


def _layouts(places: Sequence[Path], one_each: bool) -> list["StreetLayout"]:
    from ..datatypes import SceneLayout
    from ..materialisation import index_of
    from ..scene.folders import scene_folders
    from ..study import layout_of_scene

    found: dict[str, StreetLayout] = {}
    for folder in scene_folders([pathlib.Path(p) for p in places]):
        layout = SceneLayout.load(folder / "layout.json")
        name = layout.graph_id if one_each else layout.id
        if name not in found:
            records = {record.uid: record.extent_xyz for record in index_of(layout).records}
            found[name] = layout_of_scene(layout, records)
    return list(found.values())
