"""The experiments of Dondo and Noborio, beside what is printed of them."""
