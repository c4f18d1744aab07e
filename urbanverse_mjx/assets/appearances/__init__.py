"""Generates, describes and ranks ground materials and skies."""
