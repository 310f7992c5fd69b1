"""A controller proved with its plant: stable, inside, reached."""
