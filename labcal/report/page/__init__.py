"""One self-contained HTML page: its parts, its look, and the interactive 3-D view.

A page is a :class:`~labcal.report.page.document.Page` of sections, and a section a list of parts::

    chart = Chart("errors", svg, "What is to be seen.", table_download("errors.csv", header, columns))
    table = PageTable("cells", "A caption.", [Column("method", Side.LEFT), Column("error, mm")], rows)
    page = Page("Title", "Heading", "Lead.", [Section("Figures", [Beside((chart, table))])], provenance)
    PageOutput("page.html").write(page)

Parts are ``Prose`` and ``Terms`` (sentences), ``PageTable``, ``Chart`` (an SVG of
:func:`labcal.report.inline_svg.inline_svg`, in the inks of that module, so that it follows the theme),
``Photograph`` (a picture with dots), ``SpaceView`` (the 3-D view), ``Statement`` (a verdict), ``Files``
(buttons that save), ``Beside`` (parts beside each other) and ``Written`` (a template of its own). A new kind
of part is a class with ``html()``, and ``assets`` where it carries data. Whatever a part is given is text:
templates escape it. Names are ids, each once in a page. Sections of the rows and claims of the paper show how
templates of one's own fit in (:mod:`labcal.report.reproduction_page`).
"""
