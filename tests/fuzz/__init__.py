"""A fuzzer of all that labcal reads: seeds, mutators, the verbs that read them, and a judge of its own.

``PYTHONPATH=tests python -m fuzz 10000 --seed 1`` tells what it finds; the tests run
a few of the same kind.
"""
