"""Mesh files that the import tests make: good ones from the shipped assets, and one broken in every way."""

import io
import json
import os
import pathlib
import struct
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from trimesh.exchange import gltf
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.exporting.obj import mtl_text, obj_text, png_bytes
from urbanverse_mjx.assets.meshes.glb import TO_GLTF, glb_bytes
from urbanverse_mjx.datatypes import AssetMesh, AssetRecord

INDEX = load_index()
LICENCE = "CC-BY-4.0"
#: leaf -> a plausible file name for it.
GOOD_GLB = {
    "traffic cone": "orange_traffic_cone.glb",
    "bench": "ParkBench.glb",
    "fire hydrant": "fire-hydrant-02.glb",
    "bollard": "old bollard.glb",
    "vending machine": "vendingMachine_v3.glb",
    "street light": "street light.glb",
    "stop sign": "StopSign01.glb",
    "picnic table": "wooden picnic table.glb",
    "jersey barrier": "jersey_barrier.glb",
    "telephone booth": "telephone booth.glb",
    "rock": "a\nrock.glb",
    "manhole cover": "manhole cover.glb",
}


def mesh_of(leaf: str) -> tuple[AssetRecord, AssetMesh]:
    record = INDEX.by_leaf(leaf)[0]
    return record, build_mesh(record)


def scaled(mesh: AssetMesh, factor: float) -> AssetMesh:
    return AssetMesh(mesh.vertices * np.float32(factor), mesh.faces, mesh.uv, mesh.texture)


def write_good(folder: pathlib.Path) -> dict[str, AssetRecord]:
    """20 good files; file name -> the record whose box and leaf the import must find again."""
    wanted = {}
    for leaf, name in GOOD_GLB.items():
        wanted[name.replace("\n", "\\n")], mesh = mesh_of(leaf)
        (folder / name).write_bytes(glb_bytes(mesh, None, LICENCE))
    for leaf, unit in (("sedan", 100.0), ("bus shelter", 1000.0), ("dumpster", 1 / 0.0254), ("taxi", 5.0)):
        name = f"{leaf} x{unit:.0f}.glb"
        wanted[name], mesh = mesh_of(leaf)
        (folder / name).write_bytes(glb_bytes(scaled(mesh, unit), None, LICENCE))
    for leaf in ("mailbox", "parking meter"):
        wanted[f"{leaf}.obj"], mesh = mesh_of(leaf)
        (folder / f"{leaf}.obj").write_text(obj_text(mesh, f"{leaf}.mtl", "z up"))
        (folder / f"{leaf}.mtl").write_text(mtl_text(mesh, f"{leaf}.png"))
        (folder / f"{leaf}.png").write_bytes(png_bytes(mesh.texture))
        (folder / f"{leaf}.json").write_text(json.dumps({"license_info": {"license": "by"}}))
    wanted["trash bin.gltf"], mesh = mesh_of("trash bin")
    (folder / "trash bin.gltf").write_text(json.dumps(split_gltf(mesh, folder, "rack")))
    wanted["plant pot.glb"], mesh = mesh_of("plant pot")
    (folder / "plant pot.glb").write_bytes(vertex_coloured(mesh))
    return wanted


def split_gltf(mesh: AssetMesh, folder: pathlib.Path, stem: str) -> dict[str, Any]:
    """The tree of a glTF file whose buffer lies beside it."""
    body = glb_bytes(mesh, None, LICENCE)
    length = struct.unpack("<I", body[12:16])[0]
    tree, binary = json.loads(body[20 : 20 + length]), body[28 + length :]
    (folder / f"{stem}.bin").write_bytes(binary)
    tree["buffers"] = [{"uri": f"{stem}.bin", "byteLength": len(binary)}]
    return tree


def vertex_coloured(mesh: AssetMesh) -> bytes:
    """The asset with colours at its vertices and no image."""
    height, width = mesh.texture.shape[:2]
    u, v = (mesh.uv * [width - 1, height - 1]).round().astype(int).T
    colors = np.column_stack([mesh.texture[height - 1 - v, u], np.full(len(u), 255)])
    solid = trimesh.Trimesh(mesh.vertices @ TO_GLTF.T, mesh.faces, vertex_colors=colors, process=False)
    return with_copyright(trimesh.Scene({"pot": solid}))


def with_copyright(scene: trimesh.Scene, **asset: Any) -> bytes:
    def describe(tree: dict[str, Any]) -> None:
        tree["asset"] |= {"copyright": LICENCE, **asset}

    return gltf.export_glb(scene, tree_postprocessor=describe)


def checkered(solid: trimesh.Trimesh) -> trimesh.Trimesh:
    """A z-up mesh with an image on it, in glTF's frame."""
    board = np.kron(np.indices((8, 8)).sum(0) % 2, np.ones((8, 8)))[..., None] * [180, 90, 40] + 40
    texture = Image.fromarray(board.astype(np.uint8))
    visual = TextureVisuals(uv=solid.vertices[:, :2] * 0.1, material=PBRMaterial(baseColorTexture=texture))
    return trimesh.Trimesh(solid.vertices @ TO_GLTF.T, solid.faces, visual=visual, process=False)


def textured(*solids: trimesh.Trimesh) -> bytes:
    return with_copyright(trimesh.Scene({f"part{k}": checkered(s) for k, s in enumerate(solids)}))


def patched(body: bytes, change: Any) -> bytes:
    """A GLB whose JSON was changed."""
    length = struct.unpack("<I", body[12:16])[0]
    tree = json.loads(body[20 : 20 + length])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = body[20 + length :]
    return (
        struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
        + struct.pack("<I", len(text))
        + b"JSON"
        + text
        + rest
    )


def _noise() -> trimesh.Trimesh:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.4)
    rough = 1 + 0.35 * np.random.default_rng(0).normal(size=(len(ball.vertices), 1))
    return trimesh.Trimesh(ball.vertices * rough, ball.faces, process=False)


def _shreds() -> trimesh.Trimesh:
    rng = np.random.default_rng(1)
    corners = rng.uniform(-0.5, 0.5, (600, 1, 3)) + rng.normal(size=(600, 3, 3)) * 0.03
    return trimesh.Trimesh(corners.reshape(-1, 3), np.arange(1800).reshape(-1, 3), process=False)


def _valley() -> trimesh.Trimesh:
    x, y = np.meshgrid(np.linspace(-100, 100, 40), np.linspace(-100, 100, 40))
    z = 8 * np.sin(x / 30) * np.cos(y / 25)
    k = np.arange(1600).reshape(40, 40)
    a, b, c, d = k[:-1, :-1].ravel(), k[:-1, 1:].ravel(), k[1:, 1:].ravel(), k[1:, :-1].ravel()
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return trimesh.Trimesh(np.column_stack([x.ravel(), y.ravel(), z.ravel()]), faces, process=False)


def _solid(leaf: str, offset: tuple[float, float, float] = (0, 0, 0)) -> trimesh.Trimesh:
    mesh = mesh_of(leaf)[1]
    return trimesh.Trimesh(mesh.vertices + np.array(offset), mesh.faces, process=False)


def _plain(solid: trimesh.Trimesh, **asset: Any) -> bytes:
    bare = trimesh.Trimesh(solid.vertices @ TO_GLTF.T, solid.faces, process=False)
    return with_copyright(trimesh.Scene({"body": bare}), **asset)


def _half(solid: trimesh.Trimesh) -> trimesh.Trimesh:
    front = solid.triangles_center[:, 0] > 0
    return trimesh.Trimesh(solid.vertices, solid.faces[front], process=False)


def write_corrupt(folder: pathlib.Path) -> dict[str, str]:
    """One file and more of each of the paper's nine corruptions; file name -> its name."""
    box, cone = trimesh.creation.box, _solid("traffic cone")
    slab = trimesh.creation.box((4.0, 4.0, 0.05), trimesh.transformations.translation_matrix((0, 0, -0.025)))
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.4)
    lens = trimesh.creation.cylinder(radius=0.4, height=0.8, sections=200)
    files = {
        "noisy fire hydrant.glb": ("bad mesh", textured(_noise())),
        "splat bench.glb": ("bad mesh", textured(_shreds())),
        "half dumpster.glb": ("bad mesh", textured(_half(ball))),
        "grey bench.glb": ("no texture", _plain(_solid("bench"))),
        "vending machine card.glb": ("paper-like", textured(box((0.005, 0.9, 1.8)))),
        "traffic cone on plate.glb": ("with base", textured(cone, slab)),
        "valley.glb": ("terrain map", textured(_valley())),
        "模型-x7.glb": ("inconsistent name", textured(cone)),
        "qz81_final.glb": ("inconsistent name", textured(cone)),
        "bollard.glb": ("CAD-like", _plain(lens)),
        "fire hydrant.glb": ("CAD-like", _plain(_solid("fire hydrant"), generator="SolidWorks 2024")),
        "two traffic cones.glb": ("non-single object", textured(cone, _solid("traffic cone", (3.0, 0, 0)))),
        "flat car.glb": ("non-uniform scale", textured(box((4.0, 9.0, 0.4)))),
    }
    for name, (_, body) in files.items():
        (folder / name).write_bytes(body)
    return {name: reason for name, (reason, _) in files.items()}


def _many_parts(tree: dict[str, Any]) -> None:
    tree["meshes"][0]["primitives"] *= 10_001


def write_hostile(folder: pathlib.Path) -> dict[str, str]:
    """Files that a reader must not trust; file name -> the reason of their refusal."""
    mesh = mesh_of("traffic cone")[1]
    good = glb_bytes(mesh, None, LICENCE)
    nan = trimesh.Trimesh(
        np.where(np.arange(len(mesh.vertices))[:, None] == 3, np.nan, mesh.vertices), mesh.faces, process=False
    )
    climbing = split_gltf(mesh, folder, "bench") | {"images": [{"uri": "..%2f../secret.png"}]}
    absolute = split_gltf(mesh, folder, "bench")
    absolute["buffers"][0]["uri"] = "file:///secret.bin"
    bomb = split_gltf(mesh, folder, "bench") | {"images": [{"uri": "bomb.png"}]}
    Image.new("1", (20_000, 20_000)).save(folder / "bomb.png")  # 48 kB of file, 400 million pixels
    files: dict[str, tuple[str, bytes]] = {
        "cut bench.glb": ("truncated", good[: len(good) // 2]),
        "headless bench.glb": ("truncated", good[:10]),
        "empty bench.glb": ("empty", b""),
        "text bench.glb": ("malformed", b"this is no mesh, whatever its name says"),
        "nan bench.glb": ("not finite", _quietly(nan)),
        "chained bench.glb": ("too many nodes", patched(good, _chain)),
        "null bench.glb": ("malformed", patched(good, lambda t: t.update(nodes=None, scenes=None))),
        "viewless bench.glb": ("absurd numbers", patched(good, lambda t: t.update(accessors=[]))),
        "bomb bench.gltf": ("no texture", json.dumps(bomb).encode()),
        "cyclic bench.glb": ("cyclic nodes", patched(good, _cyclic)),
        "million bench.glb": ("too many nodes", patched(good, lambda t: t.update(nodes=[{}] * 1_000_000))),
        "parts bench.glb": ("too large", patched(good, _many_parts)),
        "absurd bench.glb": ("absurd numbers", patched(good, lambda t: t["accessors"][0].update(count=2**31))),
        "beyond bench.glb": ("absurd numbers", patched(good, lambda t: t["accessors"][0].update(count=10**6))),
        "packed bench.glb": (
            "unsupported",
            patched(good, lambda t: t.update(extensionsRequired=["EXT_other_compression"])),
        ),
        "climbing bench.gltf": ("path trick", json.dumps(climbing).encode()),
        "absolute bench.gltf": ("path trick", json.dumps(absolute).encode()),
        "deep bench.gltf": ("malformed", b"[" * 200_000),
        "binary bench.obj": ("malformed", b"v 0 0 0\n\0\0\0\nf 1 1 1\n"),
        "climbing bench.obj": ("path trick", b"mtllib ../../secret.mtl\n" + _triangles()),
        "wild bench.obj": ("malformed", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9999999\n"),
        "unlicensed bench.glb": ("no licence", glb_bytes(mesh)),
        "reserved bench.glb": ("no licence", glb_bytes(mesh, None, "(c) somebody, all rights reserved")),
        "wrongly told bench.glb": ("bad annotation", good),
    }
    for name, (_, body) in files.items():
        (folder / name).write_bytes(body)
    (folder / "wrongly told bench.json").write_text('{"category": "bench", "mass": -3}')
    with (folder / "huge bench.glb").open("wb") as file:
        file.truncate(2**30)
    os.mkfifo(folder / "pipe bench.glb")
    return {name: reason for name, (reason, _) in files.items()} | {
        "huge bench.glb": "too large",
        "pipe bench.glb": "not a file",
    }


def _triangles() -> bytes:
    return b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def _chain(tree: dict[str, Any]) -> None:
    tree["nodes"] = [{"children": [k + 1]} for k in range(5000)] + [{}]


def _cyclic(tree: dict[str, Any]) -> None:
    tree["nodes"] = [{"children": [1]}, {"children": [2]}, {"children": [0]}]


def _quietly(solid: trimesh.Trimesh) -> bytes:
    buffer = io.BytesIO()
    with np.errstate(invalid="ignore"):
        buffer.write(with_copyright(trimesh.Scene({"nan": solid})))
    return buffer.getvalue()
