"""Measures the asset index: contents, consistency, agreement with published objects, and speed.

    python -m benchmarks.assets --json

builds the catalogue into a temporary file, so its time is measured; renders are left out unless asked for
(`--renders 120`, needs an OpenGL that renders off screen).
"""

import collections
import json
import pathlib
import time
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
import tyro
from rich.console import Console

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.categories.priors import prior
from urbanverse_mjx.assets.categories.published import (
    QUANTITIES,
    errors,
    ground_truths,
    held_out_errors,
    published,
    set_aside,
)
from urbanverse_mjx.assets.collision.hulls import HullStore
from urbanverse_mjx.assets.collision.hulls import store_path as hulls_path
from urbanverse_mjx.assets.records.catalogue import disagreements, leaf_counts
from urbanverse_mjx.assets.records.store import build_store, forget, load_store, recorded_content
from urbanverse_mjx.assets.selection.matching import Matcher
from urbanverse_mjx.assets.selection.search import ObjectLibrary
from urbanverse_mjx.work_folder import work_folder

from .lib import asset_steps
from .lib.report import machine

#: One value for every filter, so that each is timed.
FILTERS: dict[str, Any] = {
    "categories": ["furniture", "bench", "vehicle"],
    **{f"{name}_range": (0.2, 2.0) for name in ("height", "length", "width", "max_dimension")},
    "mass_range": (1.0, 50.0),
    "required_force_range": (0.0, 300.0),
    **{f"{name}_range": (0.2, 0.6) for name in ("surface_roughness", "reflectivity", "friction_coefficient")},
    "index_of_refraction_range": (1.3, 1.6),
    "youngs_modulus_range": (1000.0, None),
    "bounciness_range": (0.1, 0.4),
    "recommended_clearance_range": (0.2, 1.0),
    **dict.fromkeys(("receptacle", "movable", "walkable", "enterable", "support_surface"), True),
    "dominant_materials": ["wood", "steel"],
    "dominant_colors": ["red", "blue"],
    "affordances": ["sittable"],
    "interactive_parts": ["lid", "lever"],
    "surface_hardness": "hard",
    "surface_finish": ["glossy", "smooth"],
    "asset_composition_type": "single",
}
RANGE_STEP = 1e-3  # relative tolerance at the ends of a range


def counts(table: pa.Table) -> dict[str, Any]:
    """Counts records, and lists the leaves whose number of records differs from the authors'."""
    found = collections.Counter(table["category"].to_pylist())
    index = load_index()
    return {
        "level_1": len(set(table["class_name_l1"].to_pylist())),
        "level_2": len(set(table["class_name_l2"].to_pylist())),
        "level_3": len(found),
        "records": table.num_rows,
        "records_with_mesh": table.num_rows - table["recipe"].null_count,
        "base_shapes": len(index.records),
        "leaves_with_base_shapes": len(index.leaves),
        "leaves_with_other_count_than_ontology": sum(found[leaf] != n for leaf, n in leaf_counts().items()),
    }


def agreement(table: pa.Table) -> dict[str, Any]:
    """Returns the share of records with consistent fields, and of those with meshes within their leaf's ranges."""
    inside = {}
    shown = np.array([name is not None for name in table["recipe"].to_pylist()])
    rows = [prior(leaf) for leaf in table["category"].to_pylist()]
    for name in QUANTITIES:
        values = table[name].to_numpy()
        low, high = (np.array([getattr(row, name)[k] for row in rows]) for k in (0, 2))
        within = (values >= low * (1 - RANGE_STEP)) & (values <= high * (1 + RANGE_STEP))
        inside[name] = round(float(within[shown].mean()), 4) if shown.any() else None
    agreeing = 1.0 - len(disagreements(table)) / table.num_rows
    return {"fields_agree": round(agreeing, 6), "with_mesh_within_prior_range": inside}


def hulls() -> dict[str, Any]:
    """Returns statistics of the shipped collision hulls."""
    sets = list(HullStore.load(hulls_path()).hulls.values())
    number, corners = [len(s) for s in sets], [len(h) for s in sets for h in s]
    return {
        "meshes": len(sets),
        "hulls": len(corners),
        "per_mesh_median": float(np.median(number)),
        "per_mesh_most": max(number),
        "corners_most": max(corners),
        "bytes": hulls_path().stat().st_size,
    }


def against_published(table: pa.Table) -> dict[str, Any]:
    """Returns mean absolute relative errors of the leaves' median records and of the priors' medians against published
    figures."""
    leaves, wanted = np.array(table["category"].to_pylist()), ground_truths(published())
    columns = {q: table[q].to_numpy() for q in QUANTITIES}
    records = {leaf: {q: float(np.median(x[leaves == leaf])) for q, x in columns.items()} for leaf in wanted}
    priors = {leaf: {q: getattr(prior(leaf), q)[1] for q in QUANTITIES} for leaf in wanted}
    result: dict[str, Any] = {
        "rows": len(published()),
        "leaves": len(wanted),
        "figures_set_aside": sum(len(row.figures) for row in set_aside()),
    }
    for kind, medians in (("records", records), ("priors", priors)):
        for quantity, found in errors(published(), medians).items():
            result[f"{quantity}_of_{kind}"] = round(float(np.mean(list(found.values()))), 4)
    result["leaves_by_quantity"] = {q: len(found) for q, found in errors(published(), priors).items()}
    return result


def held_out_masses() -> dict[str, Any]:
    """Returns errors of the masses of objects that no prior was fitted to, given their true boxes."""
    by_leaf = collections.defaultdict(list)
    found = held_out_errors()
    for (leaf, _), error in found.items():
        by_leaf[leaf].append(abs(error))
    off = np.array(list(found.values()))
    return {
        "objects": len(off),
        "leaves": len(by_leaf),
        "mean_absolute_error": round(float(np.abs(off).mean()), 4),
        "mean_absolute_error_of_leaves": round(float(np.mean([np.mean(x) for x in by_leaf.values()])), 4),
        "off_by_more_than_2x": int(((off > 1.0) | (off < -0.5)).sum()),
        "worst": {f"{leaf}, {item}": round(e, 2) for (leaf, item), e in sorted(found.items(), key=_size)[-3:]},
    }


def _size(item: tuple[tuple[str, str], float]) -> float:
    return abs(item[1])


def filter_latencies(objects: ObjectLibrary, repeats: int = 5) -> dict[str, Any]:
    """Returns the time (ms) of each filter: the first call, which decodes its column, and the median of later ones."""
    first, later = {}, {}
    for name, value in FILTERS.items():
        spent = []
        for _ in range(repeats + 1):
            start = time.perf_counter()
            objects.get_uids_conditioned(**{name: value})
            spent.append(1000 * (time.perf_counter() - start))
        first[name], later[name] = spent[0], float(np.median(spent[1:]))
    slowest = max(later, key=lambda name: later[name])
    return {
        "filters": len(FILTERS),
        "first_most_ms": round(max(first.values()), 1),
        "later_most_ms": round(later[slowest], 1),
        "slowest": slowest,
    }


def measure(renders: int, matches: int) -> dict[str, Any]:
    """All figures."""
    with work_folder("urbanverse-assets-") as folder:
        start = time.perf_counter()
        path = build_store(pathlib.Path(folder) / "catalogue.parquet", show_progress=False)
        built = time.perf_counter() - start
        size = path.stat().st_size
        start = time.perf_counter()
        table = load_store(path)
        objects = ObjectLibrary(table)
        opened = time.perf_counter() - start
        forget()
    matcher = Matcher(objects)
    result = {
        "machine": machine(),
        "content": recorded_content(table),
        "counts": counts(table),
        "agreement": agreement(table),
        "hulls": hulls(),
        "published": against_published(table),
        "held_out_masses": held_out_masses(),
        "build_s": round(built, 1),
        "open_s": round(opened, 2),
        "store_bytes": size,
        "filter": filter_latencies(objects),
        "match": asset_steps.latencies(objects, matcher, matches),
        "semantic": asset_steps.semantic(),
        "geometric": asset_steps.geometric(objects, matcher, matches),
    }
    if renders:
        result["appearance"] = asset_steps.appearance(objects, matcher, renders)
    return result


def main(as_json: Annotated[bool, tyro.conf.arg(name="json")] = False, renders: int = 0, matches: int = 300) -> None:
    """Measures the asset index.

    Args:
      as_json: print one line of JSON.
      renders: images to look up again; 0 leaves the appearance step out (it needs OpenGL).
      matches: matches to time.
    """
    result = measure(renders, matches)
    if as_json:
        print(json.dumps(result))
        return
    for name, value in result.items():
        Console().print(f"[bold]{name}[/bold]: {json.dumps(value)}", soft_wrap=True, highlight=False)


if __name__ == "__main__":
    tyro.cli(main)
