"""The rows that the paper reports, and their reproduction."""
