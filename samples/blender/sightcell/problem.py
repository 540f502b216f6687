"""What goes wrong with the bake or its files."""


class Problem(Exception):
    """One line for the user: what is wrong, and what to do."""
