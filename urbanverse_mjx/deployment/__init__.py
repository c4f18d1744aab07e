"""Runs a policy's ONNX file on a robot: the loop of `urbanverse deploy`, its bridge, its log, and the robot's side.

Imports NumPy, onnxruntime, pyzmq and Pillow, and neither JAX nor MuJoCo.
"""
