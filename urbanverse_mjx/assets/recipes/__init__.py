"""Parametric recipes, in folders by the top category of the ontology; `shared` holds what several folders use.

Every module here is imported by `assets.meshes.recipe`. A recipe's identity is its `name`, so files may move.
"""
