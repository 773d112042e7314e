"""Reports as one HTML file that needs nothing else (needs the extra `report`).

`--html FILE` of the commands compare, run, stress and calibrate ends here.
"""

from mujoco_impact.report.page import Page, Section, check_report, write_page

__all__ = ["Page", "Section", "check_report", "write_page"]
