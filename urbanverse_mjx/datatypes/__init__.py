"""The datatypes that the stages exchange: frozen, validated, each with a file form."""

from .asset import AgentAppearance, AssetMesh, AssetRecord, HullSet
from .bank_shards import BankShards
from .bank_shards_writer import BankShardsWriter
from .evaluation import HIT_GROUND, OUTCOMES, RESULTS, BenchmarkReport, EpisodeResult, outcome_of
from .ground import GROUND_KINDS, KIND_INDEX, PAINT_KINDS, TRAVERSABLE_KINDS, traversable
from .hashing import content_hash
from .label_prior import LabelPrior
from .placed_bank import PlacedBank
from .recording import Camera, Detection, Frame, Recording
from .recording_writer import RecordingWriter
from .robot import Arm, Parcel, Response, RobotSpec
from .scene_bank import SPLITS, SceneBank
from .scene_graph import GraphObject, GroundRegion, SceneGraph, Source
from .scene_layout import PlacedGround, PlacedObject, SceneLayout
from .simulation import AgentMotion, AgentShapes, Bodies, CameraMount, Contacts, Renderer, SimState, Simulator
from .validation import ValidationError

__all__ = [
    "GROUND_KINDS",
    "HIT_GROUND",
    "KIND_INDEX",
    "OUTCOMES",
    "PAINT_KINDS",
    "RESULTS",
    "SPLITS",
    "TRAVERSABLE_KINDS",
    "AgentAppearance",
    "AgentMotion",
    "AgentShapes",
    "Arm",
    "AssetMesh",
    "AssetRecord",
    "BankShards",
    "BankShardsWriter",
    "BenchmarkReport",
    "Bodies",
    "Camera",
    "CameraMount",
    "Contacts",
    "Detection",
    "EpisodeResult",
    "Frame",
    "GraphObject",
    "GroundRegion",
    "HullSet",
    "LabelPrior",
    "Parcel",
    "PlacedBank",
    "PlacedGround",
    "PlacedObject",
    "Recording",
    "RecordingWriter",
    "Renderer",
    "Response",
    "RobotSpec",
    "SceneBank",
    "SceneGraph",
    "SceneLayout",
    "SimState",
    "Simulator",
    "Source",
    "ValidationError",
    "content_hash",
    "outcome_of",
    "traversable",
]
