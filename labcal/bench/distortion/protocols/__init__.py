"""Protocols of others: measurements with published figures, beside which ours stand."""
