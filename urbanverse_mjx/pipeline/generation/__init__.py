"""Generates compiled digital cousins from a video or a scene graph in resumable stages."""
