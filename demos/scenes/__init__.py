"""The gallery's scenes: each module without a leading underscore is one, to copy from."""
