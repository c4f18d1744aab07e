"""Inputs and outputs of each published model, and known faults of its export.

The ONNX files are those of https://huggingface.co/UCLA-VAIL/Navigation-Model-Zoo-Public (revision 9c1f523e). The
contracts are from the catalogue of VAIL-UCLA/visnavkit (docs/models.md, visnavkit/benchmark), the models' own
repositories (robodhruv/visualnav-transformer at 76d3a15, ai4ce/CityWalker at ab0ef60, VAIL-UCLA/MIMIC's README), and
tests of third parties against the files. No file of the zoo was run here.
"""

import dataclasses

#: (mean, standard deviation) of red, green and blue by which images in [0, 1] are normalised (ImageNet).
IMAGENET = ((0.485, 0.456, 0.406), (0.229, 0.224, 0.225))


@dataclasses.dataclass(frozen=True)
class ZooContract:
    """Inputs, outputs and faults of a model.

    Attributes:
      title: of the model.
      files: names of its graphs; --weights names the first of them, or a folder with all of them.
      size: (height, width) of its images, which the simulator renders at that size.
      rate_hz: control steps per second.
      frames: number of images, the newest last.
      stride: control steps from one of these images to the next.
      imagenet: whether images are normalised before the graph; otherwise they are in [0, 1].
      goal: "image" (a camera image taken at the goal), "point" (its place), or "none" (it has no goal as input).
      inputs, outputs: shapes, n robots, with their meaning.
      drive: how an output becomes a velocity.
      faults: what is known to be wrong, unknown or different from the model's publication.
    """

    title: str
    files: tuple[str, ...]
    size: tuple[int, int]
    rate_hz: float
    frames: int
    stride: int
    imagenet: bool
    goal: str
    inputs: dict[str, str]
    outputs: dict[str, str]
    drive: str
    faults: tuple[str, ...]


_PD = (
    "The third waypoint, which deployment/src/navigate.py takes: speed x · max_speed, yaw rate atan2(y, x) · rate; a "
    "step of length 1 is the robot's largest speed."
)
_IMAGE_FAULTS = (
    "The zoo's wrapper passes a random image as the goal; here the camera is rendered at the goal.",
    "Trained on goals up to 20 steps away and used along a chain of images; here the only image is that of the goal, "
    "10 to 30 m away.",
    "Deployed with images 0.25 s apart; here they are 0.2 s apart, because banks hold what a robot can reach in a "
    "control step of at most 0.2 s.",
    "Trained with cameras of about 4:3; here the image has that shape with the vertical field of view of the robot's.",
)
_GNM = ZooContract(
    title="GNM, Shah et al., ICRA 2023, arXiv 2210.03370",
    files=("gnm_imagegoal.onnx",),
    size=(64, 85),
    rate_hz=5.0,
    frames=6,
    stride=1,
    imagenet=True,
    goal="image",
    inputs={
        "obs_img": "n, 18, 64, 85 float: six images along the channels, the oldest first",
        "goal_img": "n, 3, 64, 85 float: image at the goal",
    },
    outputs={
        "dist_pred": "n, 1: steps to the goal, unused",
        "action_pred": "n, 5, 4: waypoints (ahead, left, cos, sin of the heading), in steps",
    },
    drive=_PD,
    faults=_IMAGE_FAULTS,
)

CONTRACTS: dict[str, ZooContract] = {
    "gnm": _GNM,
    "vint": dataclasses.replace(
        _GNM, title="ViNT, Shah et al., CoRL 2023, arXiv 2306.14846", files=("vint_imagegoal.onnx",)
    ),
    "nomad": ZooContract(
        "NoMaD, Sridhar et al., ICRA 2024, arXiv 2310.07896",
        ("nomad_vision_encoder.onnx", "nomad_noise_pred.onnx"),
        (96, 96),
        5.0,
        4,
        1,
        True,
        "image",
        {
            "obs_img": "n, 12, 96, 96 float: four images along the channels, the oldest first",
            "goal_img": "n, 3, 96, 96 float: image at the goal",
            "goal_mask": "n int64: 0, the goal counts",
            "sample, timestep, global_cond": "n, 8, 2 float; int64; n, d float: of the second graph, ten times",
        },
        {"noise": "n, 8, 2: of the second graph; after ten steps of DDPM the waypoints' differences, in steps"},
        _PD + " One sample for each robot with noise of a fixed seed; deployment draws eight and takes the first.",
        (*_IMAGE_FAULTS, "The zoo's wrapper is goal-free (mask 1) and has no conversion to metres."),
    ),
    "citywalker": ZooContract(
        "CityWalker, Liu et al., CVPR 2025, arXiv 2411.17820",
        ("citywalker.onnx",),
        (350, 630),
        5.0,
        5,
        5,
        False,
        "point",
        {
            "obs": "n, 5, 3, 350, 630 float in [0, 1]: images 1 s apart; the graph normalises them",
            "cord": "n, 6, 2 float: (right, ahead) of the robot at those times and of the goal, in steps of 1 s",
        },
        {
            "wp_pred": "n, 5, 2: (right, ahead) after 1 to 5 s, in steps",
            "arrive_pred": "n, 1: logit of having arrived, unused",
        },
        "The arc to the first waypoint, driven in 1 s. A step is half the robot's largest speed times 1 s.",
        (
            "The zoo's wrapper ignores the goal, puts random numbers into the last row of `cord`, and may change the "
            "caller's array; here the row is the goal.",
            "Its units are the mean step of each recording, so how far a step is on a robot has to be chosen.",
            "Past positions are integrated from the odometry's velocities.",
        ),
    ),
    "s2e": ZooContract(
        "S2E, He et al., ICLR 2026, arXiv 2507.22028",
        ("s2e.onnx",),
        (256, 256),
        5.0,
        11,
        1,
        False,
        "point",
        {
            "obs_images": "n, 11, 3, 256, 256 float in [0, 1]",
            "goal": "n, 3 float: distance clipped to 0.1-200 m divided by 200, cos and sin of the bearing",
        },
        {"wp_pred": "n, 10, 3: (ahead, left, heading) in units of 0.25 m", "wp_pred_score": "n, unused"},
        "The arc to the fifth waypoint, driven in 1 s.",
        (
            "The weights are those of behaviour cloning, not those tuned by reinforcement learning in the paper.",
            "Comments of the zoo's wrapper contradict the goal's encoding and the factor 0.25 that it computes.",
            "The times of images and waypoints are not published; 5 Hz is assumed for both.",
        ),
    ),
    "mimic": ZooContract(
        "MIMIC, He et al., ICRA 2026, arXiv 2603.22527",
        ("mimic.onnx",),
        (288, 512),
        5.0,
        16,
        1,
        False,
        "none",
        {"obs": "1, 16, 3, 288, 512 float in [0, 1], one robot at a time"},
        {"output": "1, 15, 3: (ahead, left, heading) in m after 0.2, 0.4, 0.8, 1.2, 1.4, 1.6, 2.0, ... 5.0 s"},
        "The arc to the fourth waypoint, driven in its 1.2 s.",
        (
            "The published graph has no goal as input, unlike the paper's model: it follows pavements, and reaches "
            "goals by chance.",
            "The times of the waypoints are uneven, and the zoo's wrapper drops the last two.",
            "The zoo's wrapper imports urbansim, which it does not need.",
        ),
    ),
}
