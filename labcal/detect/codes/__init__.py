"""Codes of prints in pictures: tags, the QR code between them, and which board is the one that is wanted.

``tag_pairs.py`` finds the tags, ``qr_cells.py`` reads the cells between them, ``reading.py`` makes
descriptions of the texts, and ``own_board.py`` hides other boards.
"""
