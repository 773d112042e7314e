"""Domains of dm_control and gymnasium with all contacts ours, beside the stock ones.

`falls` lets robots move at random and then lie, `tours` plays every environment, and
`write_page` writes docs/domains.md of both.
"""
