"""Images of assets: thumbnails, galleries and contact sheets."""
