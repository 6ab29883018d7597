"""Contact geometry of ellipses as pure mathematics: numbers in, numbers out, no pymunk."""
