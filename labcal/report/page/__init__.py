"""One self-contained HTML page: its parts, its look, and the interactive 3-D view."""
