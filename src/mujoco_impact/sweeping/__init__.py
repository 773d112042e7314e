"""Many runs of a scene, and what each of them came to, in a table that grows on disk.

From the specification to the picture: `specification` reads what was asked for,
`parameters` knows what can be varied, `cases` makes grid, list and random draws,
`scenes` builds the scene of a case, `quantities` knows what can be recorded,
`run_case` runs one, `table` has columns and rows, `rows_file` keeps them, `origin`
tells which sweep they are of, `sweep` is the whole path, `cluster` brings workers of
other machines, `lines` and `plot` draw the rows.
"""
