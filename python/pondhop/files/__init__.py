"""What plans are written as and read from: ``plan.json``, ``plan.geojson`` and the routes of research farms."""
