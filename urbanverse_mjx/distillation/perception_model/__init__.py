"""The built-in perception model: a small network that finds street objects, surfaces and depth in one image.

It is trained on rendered streets only (`python -m urbanverse_mjx.distillation.train_perception`).
"""
