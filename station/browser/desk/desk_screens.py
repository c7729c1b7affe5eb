# SPDX-License-Identifier: MIT
"""The pages of the modal desk, in the order of the navigation."""

from jointbench.station.browser.app.screen_part import ScreenPage

DESK_PAGES = tuple(
    ScreenPage(f"/{name}", title, f"{script}.js", ("desk.css",))
    for name, title, script in (
        ("poles", "Poles", "poles"),
        ("frfs", "FRFs", "frfs"),
        ("shapes", "Shapes", "shapes"),
        ("joint", "Joint and gap", "joint"),
        ("report", "Report", "report"),
    )
)
