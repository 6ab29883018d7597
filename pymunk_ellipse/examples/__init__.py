"""Scenes, an inspector and a game to copy from: `python -m pymunk_ellipse.examples` lists and runs them.

Each file also runs by itself, from any folder.
"""
