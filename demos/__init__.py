"""Demos: each module without a leading underscore is one, `python -m demos --list` lists them."""
