"""Models of the real architectures of the transformers library with a few random numbers, saved like real ones."""

import pathlib
from typing import Any

import pytest

#: Classes of the street segmenter: those of Cityscapes that matter here.
CITYSCAPES = {0: "road", 1: "sidewalk", 2: "building", 3: "vegetation", 4: "terrain", 5: "sky", 6: "car"}
MAX_DEPTH = 80
_SIDE = 56


#: Marks tests that use these models.
needed = pytest.mark.torch("torchvision", "transformers")


def packages() -> Any:
    """The transformers library."""
    import torch  # pyright: ignore[reportMissingImports]
    import transformers  # pyright: ignore[reportMissingImports]

    torch.manual_seed(0)
    return transformers


def tokenizer(library: Any) -> Any:
    """CLIP's tokenizer with an entry for each byte instead of 49,408 entries."""
    printable = [*range(33, 127), *range(161, 173), *range(174, 256)]
    others = [b for b in range(256) if b not in printable]
    letters = [chr(b) for b in printable] + [chr(256 + k) for k in range(len(others))]
    entries = ["<|startoftext|>", "<|endoftext|>", *letters, *(f"{letter}</w>" for letter in letters)]
    # Real files begin with words: OWLv2 takes a query that begins with entry 0 for padding.
    vocab = {"<|unused|>": 0, **{entry: k + 1 for k, entry in enumerate(entries)}}
    return library.CLIPTokenizer(vocab=vocab, merges=[], model_max_length=64)


def _text(tokens: Any) -> dict[str, Any]:
    return {
        "vocab_size": len(tokens),
        "hidden_size": 32,
        "intermediate_size": 37,
        "num_hidden_layers": 2,
        "num_attention_heads": 4,
        "max_position_embeddings": 64,
        "bos_token_id": tokens.bos_token_id,
        "eos_token_id": tokens.eos_token_id,
        "pad_token_id": tokens.pad_token_id,
    }


def clip(folder: pathlib.Path) -> None:
    """CLIP's encoders of texts and images."""
    library = packages()
    tokens = tokenizer(library)
    vision = {"hidden_size": 16, "intermediate_size": 16, "num_hidden_layers": 1, "num_attention_heads": 2}
    config = library.CLIPConfig(
        text_config=_text(tokens), vision_config={**vision, "image_size": 32, "patch_size": 16}, projection_dim=24
    )
    library.CLIPModel(config).save_pretrained(folder)
    tokens.save_pretrained(folder)


def dinov2(folder: pathlib.Path) -> None:
    """DINOv2."""
    library = packages()
    config = library.Dinov2Config(hidden_size=16, num_hidden_layers=1, num_attention_heads=2, image_size=_SIDE)
    library.Dinov2Model(config).save_pretrained(folder)
    size = {"height": _SIDE, "width": _SIDE}
    library.BitImageProcessor(size={"shortest_edge": _SIDE}, crop_size=size).save_pretrained(folder)


def owlv2(folder: pathlib.Path) -> None:
    """OWLv2 with 4 x 4 patches."""
    library = packages()
    tokens = tokenizer(library)
    vision = {"hidden_size": 32, "intermediate_size": 37, "num_hidden_layers": 2, "num_attention_heads": 4}
    config = library.Owlv2Config(
        text_config={**_text(tokens), "max_position_embeddings": 64},
        vision_config={**vision, "image_size": 64, "patch_size": 16},
        projection_dim=32,
    )
    library.Owlv2ForObjectDetection(config).save_pretrained(folder)
    images = library.Owlv2ImageProcessor(size={"height": 64, "width": 64})
    library.Owlv2Processor(images, tokens).save_pretrained(folder)


def sam2(folder: pathlib.Path) -> None:
    """SAM 2 for images of 128 x 128 pixels."""
    library = packages()
    backbone = library.Sam2HieraDetConfig(
        hidden_size=12,
        num_attention_heads=1,
        image_size=[128, 128],
        window_positional_embedding_background_size=[8, 8],
        blocks_per_stage=[1, 1, 2, 1],
        embed_dim_per_stage=[12, 24, 48, 96],
        num_attention_heads_per_stage=[1, 2, 4, 8],
        window_size_per_stage=[8, 4, 4, 4],
        global_attention_blocks=[3],
    )
    vision = library.Sam2VisionConfig(
        backbone_config=backbone,
        backbone_channel_list=[96, 48, 24, 12],
        backbone_feature_sizes=[[32, 32], [16, 16], [8, 8]],
        fpn_hidden_size=32,
    )
    config = library.Sam2Config(
        vision_config=vision,
        prompt_encoder_config={"hidden_size": 32, "image_size": 128, "patch_size": 16, "mask_input_channels": 8},
        mask_decoder_config={
            "hidden_size": 32,
            "mlp_dim": 32,
            "num_hidden_layers": 1,
            "num_attention_heads": 4,
            "iou_head_hidden_dim": 32,
        },
    )
    library.Sam2Model(config).save_pretrained(folder)
    size = {"height": 128, "width": 128}
    library.Sam2Processor(library.Sam2ImageProcessor(size=size)).save_pretrained(folder)


def sam3(folder: pathlib.Path) -> None:
    """SAM 3 for images of 112 x 112 pixels."""
    library = packages()
    tokens = tokenizer(library)
    small = {"hidden_size": 32, "num_attention_heads": 4, "intermediate_size": 64, "dropout": 0.0}
    config = library.Sam3Config(
        vision_config={
            "backbone_config": {
                "model_type": "sam3_vit_model",
                "hidden_size": 32,
                "intermediate_size": 64,
                "num_hidden_layers": 2,
                "num_attention_heads": 4,
                "image_size": 112,
                "patch_size": 14,
                "window_size": 4,
                "global_attn_indexes": [1],
                "pretrain_image_size": 112,
            },
            "fpn_hidden_size": 32,
            "backbone_feature_sizes": [[32, 32], [16, 16], [8, 8]],
        },
        text_config={**_text(tokens), "projection_dim": 32},
        geometry_encoder_config={**small, "num_layers": 1},
        detr_encoder_config={**small, "num_layers": 1},
        detr_decoder_config={**small, "num_layers": 2, "num_queries": 5},
        mask_decoder_config={"hidden_size": 32, "num_upsampling_stages": 2, "num_attention_heads": 4},
    )
    library.Sam3Model(config).save_pretrained(folder)
    images = library.Sam3ImageProcessor(size={"height": 112, "width": 112})
    library.Sam3Processor(images, tokens).save_pretrained(folder)


def mask2former(folder: pathlib.Path) -> None:
    """Mask2Former with the classes of `CITYSCAPES`."""
    library = packages()
    backbone = library.SwinConfig(
        image_size=64,
        embed_dim=8,
        depths=[1, 1, 1, 1],
        num_heads=[1, 1, 2, 2],
        window_size=4,
        out_features=["stage1", "stage2", "stage3", "stage4"],
    )
    config = library.Mask2FormerConfig(
        backbone_config=backbone,
        hidden_dim=32,
        mask_feature_size=32,
        feature_size=32,
        encoder_feedforward_dim=16,
        dim_feedforward=16,
        encoder_layers=1,
        decoder_layers=2,
        num_attention_heads=2,
        num_queries=6,
        id2label=CITYSCAPES,
        label2id={name: k for k, name in CITYSCAPES.items()},
    )
    library.Mask2FormerForUniversalSegmentation(config).save_pretrained(folder)
    library.Mask2FormerImageProcessor(size={"height": 64, "width": 64}, ignore_index=255).save_pretrained(folder)


def depth(folder: pathlib.Path) -> None:
    """Depth Anything V2, metric, up to `MAX_DEPTH` m."""
    library = packages()
    backbone = library.Dinov2Config(
        hidden_size=16,
        num_hidden_layers=4,
        num_attention_heads=2,
        image_size=_SIDE,
        out_features=["stage1", "stage2", "stage3", "stage4"],
        reshape_hidden_states=False,
    )
    config = library.DepthAnythingConfig(
        backbone_config=backbone,
        patch_size=14,
        reassemble_hidden_size=16,
        neck_hidden_sizes=[8, 8, 16, 16],
        fusion_hidden_size=8,
        head_hidden_size=8,
        depth_estimation_type="metric",
        max_depth=MAX_DEPTH,
    )
    library.DepthAnythingForDepthEstimation(config).save_pretrained(folder)
    library.DPTImageProcessor(
        size={"height": _SIDE, "width": _SIDE}, ensure_multiple_of=14, keep_aspect_ratio=True
    ).save_pretrained(folder)


#: Folder below `--models` -> the function that writes it.
WRITERS = {
    "clip": clip,
    "dinov2": dinov2,
    "owlv2": owlv2,
    "sam2": sam2,
    "sam3": sam3,
    "mask2former": mask2former,
    "depth": depth,
}


def write(folder: pathlib.Path, *names: str) -> pathlib.Path:
    """Writes some of `WRITERS` below a folder, which `--models` then names."""
    for name in names:
        WRITERS[name](folder / name)
    return folder
