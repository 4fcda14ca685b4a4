"""How large the rendered laboratory's own error is, and what it costs: ``labcal bench render``."""
