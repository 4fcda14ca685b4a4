"""The page of ``labcal bench distortion``.

Every section is a function in a file of its own, from :class:`~.findings.Findings` to a section of a page, or
None where there is nothing to show; :mod:`.sections` lists them in the order in which they stand.
"""
