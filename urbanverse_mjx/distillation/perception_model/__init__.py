"""The perception model: a small network of ours that finds street objects, surfaces and depth in one image.

It was trained in this repository on rendered streets alone (`python -m urbanverse_mjx.distillation.train_perception`).
"""
