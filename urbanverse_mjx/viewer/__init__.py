"""Viewer of streets, robots and policies in a web page.

In:   a `SceneBank`, a navigation environment and a policy.
Out:  `Session` (states, no page), meshes as binary glTF, `Page` (viser), recordings as HTML; `Teleop` (driving by hand)
      and `Front`, the page around viser's that takes keys and gamepads.
When: `urbanverse view`, `urbanverse play --html`.
"""
