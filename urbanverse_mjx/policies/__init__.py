"""Policies in ONNX files, run by onnxruntime on the CPU. Imports neither JAX nor MuJoCo, so it also runs on a robot."""
