"""Measures the accuracy of each matching step on held-out objects."""

import random
import time
from typing import Any

import numpy as np

from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.labels import mapped_labels
from urbanverse_mjx.assets.categories.semantics import NgramIndex, known_names
from urbanverse_mjx.assets.previews.gallery import render_masked
from urbanverse_mjx.assets.selection import descriptors
from urbanverse_mjx.assets.selection.matching import Matcher
from urbanverse_mjx.assets.selection.search import ObjectLibrary

HELD_OUT = 5  # one in so many of the vocabularies' labels
RENDER = (128, 128)  # pixels of a crop
YAWS = (-32.0, 20.0, 140.0)  # degrees: the thumbnails' view, and two without descriptors


def semantic(seed: int = 0) -> dict[str, Any]:
    """Looks up labels of public vocabularies by spelling alone, after removing them and their synonyms from the
    index."""
    rows = {
        (ontology.normalised(row.label.rpartition("=")[2]), row.leaf)
        for row in mapped_labels().values()
        if row.leaf and ontology.normalised(row.label.rpartition("=")[2]) != ontology.normalised(row.leaf)
    }
    order = sorted(rows)
    random.Random(seed).shuffle(order)
    held = order[: len(order) // HELD_OUT]
    away = set(held)
    index = NgramIndex([pair for pair in known_names() if pair not in away])
    ranks = []
    for label, leaf in held:
        scores = index.scores(label)
        ranks.append(int((scores > scores[index.leaves.index(leaf)]).sum()))
    return {"held_out_labels": len(held), **_recall(ranks, (1, 5, 20))}


def geometric(objects: ObjectLibrary, matcher: Matcher, count: int, seed: int = 0) -> dict[str, Any]:
    """Looks up records by their box with 3 % of noise per side; returns their rank among those of their leaf."""
    rng = np.random.default_rng(seed)
    ranks, sizes = [], []
    for record in _sample(objects, rng, count):
        box = np.array(record.extent_xyz) * np.exp(rng.normal(0.0, 0.03, 3))
        found = matcher.match(record.leaf, box.tolist(), count=1000)
        uids = [m.uid for m in found]
        ranks.append(uids.index(record.uid) if record.uid in uids else len(uids))
        sizes.append(len(uids))
    return {"records": count, "median_candidates": float(np.median(sizes)), **_recall(ranks, (1, 10, 100))}


def appearance(objects: ObjectLibrary, matcher: Matcher, count: int, seed: int = 1) -> dict[str, Any]:
    """Renders of records, described as crops are: where the record comes among its leaf's, and whether the best one
    shares its base shape or its first colour. Needs an OpenGL that renders off screen."""
    rng = np.random.default_rng(seed)
    found: dict[str, list[Any]] = {"rank": [], "chance": [], "base": [], "color": []}
    for k, record in enumerate(_sample(objects, rng, count)):
        image, mask = render_masked(build_mesh(record), RENDER, YAWS[k % len(YAWS)])
        if not mask.any():
            continue
        query = descriptors.of_image(image, mask)
        best = matcher.match(record.leaf, record.extent_xyz, query, count=1000)
        uids = [m.uid for m in best]
        found["rank"].append(uids.index(record.uid) if record.uid in uids else len(uids))
        found["chance"].append(1.0 / len(uids))
        rows = objects.load_annotations([record.uid, uids[0]])
        own, other = rows[record.uid], rows[uids[0]]
        found["color"].append(own["colors"][0] == other["colors"][0])
        bases = [_base(r) for r in objects.records([record.uid, uids[0]])]
        found["base"].append(bases[0] == bases[1])
    return {
        "renders": len(found["rank"]),
        "chance_of_rank_1": round(float(np.mean(found["chance"])), 4),
        **_recall(found["rank"], (1, 10, 50)),
        "best_has_same_base_shape": round(float(np.mean(found["base"])), 3),
        "best_has_same_first_color": round(float(np.mean(found["color"])), 3),
    }


def latencies(objects: ObjectLibrary, matcher: Matcher, count: int = 300) -> dict[str, Any]:
    """One match warm, and many different ones in a row from a cold matcher, all three steps with descriptors."""
    rng = np.random.default_rng(2)
    records = _sample(objects, rng, count)
    crop = rng.integers(0, 256, (64, 64, 3)).astype(np.uint8)
    query = descriptors.of_image(crop)
    fresh = Matcher(objects)
    start = time.perf_counter()
    for record in records:
        fresh.match(record.leaf, record.extent_xyz, query)
    many = time.perf_counter() - start
    warm = []
    for record in records[:50]:
        start = time.perf_counter()
        fresh.match(record.leaf, record.extent_xyz, query)
        warm.append(1000 * (time.perf_counter() - start))
    return {
        "matches": count,
        "all_s": round(many, 2),
        "one_warm_median_ms": round(float(np.median(warm)), 1),
        "one_warm_most_ms": round(max(warm), 1),
    }


def _sample(objects: ObjectLibrary, rng: np.random.Generator, count: int) -> list[Any]:
    """Records with meshes, leaf first, then one of its records: rare leaves count as much as frequent ones."""
    leaves = load_index().leaves
    uids = []
    for leaf in rng.choice(leaves, count):
        rows = objects.rows_of(str(leaf))
        uids.append(objects.table["uid"][int(rng.choice(rows))].as_py())
    return objects.records(uids)


def _base(record: Any) -> str:
    return record.params.get("instance", {"base": record.uid})["base"]


def _recall(ranks: list[int], at: tuple[int, ...]) -> dict[str, float]:
    return {f"found_at_{k}": round(float(np.mean([r < k for r in ranks])), 3) for k in at}
