"""Questions about streets with exact answers: views, templates, balance, file formats, scores and answerers."""
