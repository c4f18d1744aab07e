"""Lying assets: records of the catalogue turned into the pose in which they rest, for shapes that do not stand.

A shovel, a kite and a unicycle of the catalogue are upright, and a ball stands on a corner of its hull. Their records,
meshes and hulls are part of frozen scenes, so the lying ones stand beside them: the record is derived from that of the
upright asset, `params` holds its turn.
"""

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from urbanverse_mjx.datatypes import AssetRecord

from ..meshes import laying
from ..records.index import build_mesh
from ..records.user_store import FILE_RECIPE
from .hulls import load_hulls
from .rest_poses import firmest_pose

#: End of the uids of these records.
MARK = "/lying"


def is_lying(uid: str) -> bool:
    """Whether a uid names a lying asset."""
    return uid.endswith(MARK)


def upright_uid(uid: str) -> str:
    """The uid of the catalogue's record that a lying one is derived from; others are returned unchanged."""
    return uid.removesuffix(MARK)


def lying(record: AssetRecord) -> AssetRecord | None:
    """The record of an asset in the pose that takes most to tip over; None if it has none within 100 degrees, or if the
    user imported the asset."""
    if record.recipe == FILE_RECIPE:
        return None
    hulls = load_hulls(record).hulls
    pose = firmest_pose(hulls)
    if pose is None:
        return None
    mesh = build_mesh(record)
    laid = laying.laid_down(pose.down, mesh.vertices, np.concatenate(hulls))
    x, y, z = (round(float(e), 4) for e in np.ptp(laying.turned(mesh.vertices, laid), axis=0))
    return dataclasses.replace(
        record,
        uid=record.uid + MARK,
        description=f"{record.description.rstrip('.')}, lying.",
        params={**record.params, laying.KEY: laid},
        extent_xyz=(x, y, z),
        length=max(x, y),
        width=min(x, y),
        height=z,
    )


def records_of(uids: Sequence[str], upright: Mapping[str, AssetRecord]) -> list[AssetRecord]:
    """The records of lying assets by uid.

    Args:
      upright: the records that they are derived from, by uid.
    """
    found = (lying(upright[upright_uid(uid)]) for uid in uids)
    return [record for record in found if record is not None]
